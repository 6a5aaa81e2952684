// Evaluates and draws by the text alone. From standard input, again and again until it ends: a number of bytes, the bytes of a .srbf file, a
// number n, and nine rows of n f32 as evaluator/examples/reference.rs has them. To standard output: the answer of `srbf_check`, and, if that
// is 0, the rows of that program the power of the mixture, and the primary at 300 + 700 u nm, u the first uniform number.
#include "text"
#include <stdio.h>
#include <vector>
#ifdef __METAL__
typedef float3 vec3;
static int srbf_check(const uint32_t *, size_t) { return 0; }
#else
using namespace srbf_device;
#endif

static bool read(void *to, size_t bytes) { return fread(to, 1, bytes, stdin) == bytes; }

int main() {
    for (uint32_t bytes, count; read(&bytes, 4);) {
        // As large as the file: a sanitizer sees every read behind it.
        std::vector<uint32_t> words((bytes + 3) / 4);
        if (!read(words.data(), bytes) || !read(&count, 4)) { return 2; }
        const size_t n = count;
        std::vector<float> in(9 * n), out(18 * n);
        if (!read(in.data(), 4 * in.size())) { return 2; }
        const int wrong = srbf_check(words.data(), words.size());
        fwrite(&wrong, 4, 1, stdout);
        if (wrong == 0) {
            SrbfMaterial m = srbf_material(words.data());
            for (size_t i = 0; i < n; i++) {
                auto vector = [&](size_t row) { return vec3(in[row * n + i], in[(row + 1) * n + i], in[(row + 2) * n + i]); };
                SrbfView v = srbf_prepare(m, vector(0));
                SrbfValue f = srbf_evaluate(m, v, vector(3));
                SrbfSample s = srbf_sample(m, v, vector(6));
                vec3 albedo = srbf_albedo(m, v), primary = srbf_primary(m, 300 + 700 * in[6 * n + i]);
                const float numbers[18] = {f.value.x,  f.value.y,  f.value.z,  f.pdf,    s.wi.x,   s.wi.y,   s.wi.z, s.pdf,
                                           s.weight.x, s.weight.y, s.weight.z, albedo.x, albedo.y, albedo.z, v.power, primary.x, primary.y, primary.z};
                for (size_t row = 0; row < 18; row++) { out[row * n + i] = numbers[row]; }
            }
            fwrite(out.data(), 4, out.size(), stdout);
        }
        if (fflush(stdout) != 0) { return 4; }
    }
    return 0;
}
