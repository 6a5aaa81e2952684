// Evaluates and draws by the text alone: `values MATERIAL.srbf < in > out`, rows of f32 as evaluator/examples/reference.rs has them, and the power of
// the mixture as one more row.
#include "text"
#include <stdio.h>
#include <vector>
#ifdef __METAL__
typedef float3 vec3;
#else
using namespace srbf_device;
#endif

static std::vector<uint32_t> words_of(FILE *file) {
    std::vector<uint32_t> words;
    uint32_t word = 0;
    while (fread(&word, 1, 4, file) > 0) {
        words.push_back(word);
        word = 0;
    }
    return words;
}

int main(int, char **arguments) {
    FILE *file = fopen(arguments[1], "rb");
    if (!file) { return 2; }
    std::vector<uint32_t> words = words_of(file);
    fclose(file);
#ifndef __METAL__
    if (srbf_check(words.data(), words.size()) != 0) { return 3; }
#endif
    std::vector<uint32_t> given = words_of(stdin);
    const float *in = (const float *)given.data();
    const size_t n = given.size() / 9;
    std::vector<float> out(15 * n);
    SrbfMaterial m = srbf_material(words.data());
    for (size_t i = 0; i < n; i++) {
        auto vector = [&](size_t row) { return vec3(in[row * n + i], in[(row + 1) * n + i], in[(row + 2) * n + i]); };
        SrbfView v = srbf_prepare(m, vector(0));
        SrbfValue f = srbf_evaluate(m, v, vector(3));
        SrbfSample s = srbf_sample(m, v, vector(6));
        vec3 albedo = srbf_albedo(m, v);
        const float numbers[15] = {f.value.x, f.value.y,  f.value.z,  f.pdf,      s.wi.x,   s.wi.y,   s.wi.z, s.pdf,
                                   s.weight.x, s.weight.y, s.weight.z, albedo.x, albedo.y, albedo.z, v.power};
        for (size_t row = 0; row < 15; row++) { out[row * n + i] = numbers[row]; }
    }
    return fwrite(out.data(), 4, out.size(), stdout) == out.size() ? 0 : 4;
}
