// Evaluates and draws by the text alone. From standard input, again and again until it ends: a number of bytes, the bytes of a .srbf file, a
// number n, and nine rows of n f32 as evaluator/examples/reference.rs has them. To standard output: the answer of `srbf_check`, and, if that
// is 0, the rows of that program the power of the mixture, and the primary at 300 + 700 u nm, u the first uniform number. Of a sheet the power
// is that of both halves, and the primary that of the half of the light.
#include "text"
#include <stdio.h>
#include <vector>
#ifdef __METAL__
typedef float3 vec3;
static int srbf_check(const uint32_t *, size_t) { return 0; }
static int srbf_check_sheet(const uint32_t *, size_t) { return 0; }
#else
using namespace srbf_device;
#endif

struct Answer {
    SrbfValue f;
    SrbfSample s;
    vec3 albedo, primary;
    float power;
};

static Answer of_material(const uint32_t *words, vec3 wo, vec3 wi, vec3 u) {
    SrbfMaterial m = srbf_material(words);
    SrbfView v = srbf_prepare(m, wo);
    return {srbf_evaluate(m, v, wi), srbf_sample(m, v, u), srbf_albedo(m, v), srbf_primary(m, 300 + 700 * u.x), v.power};
}

static Answer of_sheet(const uint32_t *words, vec3 wo, vec3 wi, vec3 u) {
    SrbfSheet s = srbf_sheet(words);
    SrbfSheetView v = srbf_sheet_prepare(s, wo);
    auto power = [](const SrbfHalf &h) { return h.view.wo.z < 0 ? 0 : h.view.power; };
    const SrbfHalf half = srbf_sheet_half(s, wo, (wo.z < 0) != (wi.z < 0));
    return {srbf_sheet_evaluate(v, wi), srbf_sheet_sample(v, u), srbf_half_albedo(half), srbf_primary(half.material, 300 + 700 * u.x),
            power(v.reflected) + power(v.transmitted)};
}

// The reflection and the transmission of the front, as a blend of two materials.
static Answer of_blend(const uint32_t *words, vec3 wo, vec3 wi, vec3 u) {
    const SrbfSheet s = srbf_sheet(words);
    const SrbfMaterial first = srbf_material(words + s.front_reflection), second = srbf_material(words + s.front_transmission);
    const SrbfBlend b = srbf_blend(first, vec3(0.7f, 0.7f, 0.7f), second, vec3(0.3f, 0.24f, 0.18f), wo);
    const float coat = srbf_coat(1.5f, wo, wi);
    return {srbf_blend_evaluate(b, wi), srbf_blend_sample(b, u), srbf_blend_albedo(b), vec3(coat, srbf_fresnel(1.33f, wi.z), 0),
            srbf_blend_power(b.first_view, b.first_colour) + srbf_blend_power(b.second_view, b.second_colour)};
}

static bool read(void *to, size_t bytes) { return fread(to, 1, bytes, stdin) == bytes; }

// An argument: sheets are blends.
int main(int argc, char **) {
    for (uint32_t bytes, count; read(&bytes, 4);) {
        // As large as the file: a sanitizer sees every read behind it.
        std::vector<uint32_t> words((bytes + 3) / 4);
        if (!read(words.data(), bytes) || !read(&count, 4)) { return 2; }
        const size_t n = count;
        std::vector<float> in(9 * n), out(18 * n);
        if (!read(in.data(), 4 * in.size())) { return 2; }
        const bool is_sheet = words.size() > 3 && words[3] == 2;
        const int wrong = is_sheet ? srbf_check_sheet(words.data(), words.size()) : srbf_check(words.data(), words.size());
        fwrite(&wrong, 4, 1, stdout);
        if (wrong == 0) {
            for (size_t i = 0; i < n; i++) {
                auto vector = [&](size_t row) { return vec3(in[row * n + i], in[(row + 1) * n + i], in[(row + 2) * n + i]); };
                const auto [f, s, albedo, primary, power] = (is_sheet ? argc > 1 ? of_blend : of_sheet : of_material)(words.data(), vector(0), vector(3), vector(6));
                const float numbers[18] = {f.value.x,  f.value.y,  f.value.z,  f.pdf,    s.wi.x,   s.wi.y,   s.wi.z, s.pdf,
                                           s.weight.x, s.weight.y, s.weight.z, albedo.x, albedo.y, albedo.z, power,  primary.x, primary.y, primary.z};
                for (size_t row = 0; row < 18; row++) { out[row * n + i] = numbers[row]; }
            }
            fwrite(out.data(), 4, out.size(), stdout);
        }
        if (fflush(stdout) != 0) { return 4; }
    }
    return 0;
}
