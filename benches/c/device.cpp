// Hits by `srbf_device.hpp`, one after the other, as in a renderer that does not link the library.
#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
// A name of its own for each way of compiling: a linker takes functions of one name for one.
#define srbf_device JOIN(srbf_device_text, SUFFIX)
#include "../../include/srbf_device.hpp"
using namespace srbf_device;
#undef srbf_device

// Hits as arrays of x, y and z, or of three numbers.
struct Hits {
    const uint32_t *words;
    const float *wo[3], *wi[3], *u[3];
    size_t count;
};

static vec3 at(const float *const v[3], size_t i) { return vec3(v[0][i], v[1][i], v[2][i]); }

// Draws with density and weight (bit 0 of `verbs`), and evaluates value and density (bit 1), for hits each with its own `wo`; or all of the
// mixture for the first one (bit 2). Returns a sum of all results.
extern "C" float JOIN(srbf_device, SUFFIX)(const Hits *hits, int verbs) {
    SrbfMaterial material = srbf_material(hits->words);
    SrbfView view = srbf_prepare(material, at(hits->wo, 0));
    float sum = 0.0f;
    for (size_t i = 0; i < hits->count; i++) {
        if ((verbs & 4) == 0) { view = srbf_prepare(material, at(hits->wo, i)); }
        if (verbs & 1) {
            SrbfSample s = srbf_sample(material, view, at(hits->u, i));
            sum += s.wi.x + s.pdf + s.weight.x + s.weight.y + s.weight.z;
        }
        if (verbs & 2) {
            SrbfValue v = srbf_evaluate(material, view, at(hits->wi, i));
            sum += v.pdf + v.value.x + v.value.y + v.value.z;
        }
    }
    return sum;
}
