// Answers by the BxDF for pbrt-v4: from standard input, a number of bytes, the bytes of a .srbf file, a number n, and n times four wavelengths,
// wo, wi and three uniform numbers; to standard output, n times f at the wavelengths, the density, the drawn direction, its f and density.
#include "../../pbrt/srbf_bxdf.h"
#include <cstdio>
#include <vector>

using namespace pbrt;

static bool read(void *to, size_t bytes) { return fread(to, 1, bytes, stdin) == bytes; }

int main() {
    uint32_t bytes, count;
    if (!read(&bytes, 4)) { return 2; }
    std::vector<uint32_t> words((bytes + 3) / 4);
    if (!read(words.data(), bytes) || srbf_device::srbf_check(words.data(), words.size()) != 0 || !read(&count, 4)) { return 2; }
    for (float in[13]; count-- > 0 && read(in, sizeof in);) {
        const SrbfBxDF bxdf(words.data(), SampledWavelengths(in));
        const Vector3f wo(in[4], in[5], in[6]), wi(in[7], in[8], in[9]);
        const SampledSpectrum f = bxdf.f(wo, wi, TransportMode::Radiance);
        const pstd::optional<BSDFSample> drawn = bxdf.Sample_f(wo, in[10], Point2f(in[11], in[12]), TransportMode::Radiance);
        const bool is_none = !bxdf.Sample_f(wo, in[10], Point2f(in[11], in[12]), TransportMode::Radiance, BxDFReflTransFlags::Transmission);
        if (!is_none || bxdf.Flags() != (BxDFFlags::Reflection | BxDFFlags::Glossy)) { return 3; }
        float out[13] = {f[0], f[1], f[2], f[3], bxdf.PDF(wo, wi, TransportMode::Radiance)};
        if (drawn) {
            const float numbers[8] = {drawn->wi.x, drawn->wi.y, drawn->wi.z, drawn->f[0], drawn->f[1], drawn->f[2], drawn->f[3], drawn->pdf};
            for (int i = 0; i < 8; i++) { out[5 + i] = numbers[i]; }
        }
        fwrite(out, sizeof out, 1, stdout);
    }
    return fflush(stdout) == 0 ? 0 : 4;
}
