// A BxDF for pbrt-v4, by include/srbf_device.hpp alone: values at the four wavelengths of a path, on processors and GPUs.
//
// 1. Copy this file and srbf_device.hpp to src/pbrt/.
// 2. Declare SrbfBxDF in src/pbrt/base/bxdf.h, and add it to the types of BxDF there. Include this file at the end of src/pbrt/bxdfs.h.
// 3. Make a material as MeasuredMaterial is one, whose GetBxDF returns SrbfBxDF(words, lambda). It reads the words of a .srbf file,
//    checks them by srbf_device::srbf_check, and keeps them in memory of pbrt's allocator.
//
// It reflects alone, on both sides of a surface. Density and draws are the same at all wavelengths.
#ifndef SRBF_BXDF_H
#define SRBF_BXDF_H

#include <pbrt/base/bxdf.h>
#include <srbf_device.hpp>

namespace pbrt {

// The material at one hit: its words, and what takes colours to the wavelengths of the path.
class SrbfBxDF {
  public:
    SrbfBxDF() = default;
    PBRT_CPU_GPU
    SrbfBxDF(const uint32_t *words, const SampledWavelengths &lambda) : words(words) {
        const srbf_device::SrbfMaterial material = srbf_device::srbf_material(words);
        for (int i = 0; i < NSpectrumSamples; ++i) {
            columns[i] = srbf_device::srbf_primary(material, lambda[i]);
        }
    }

    PBRT_CPU_GPU
    BxDFFlags Flags() const { return BxDFFlags::Reflection | BxDFFlags::Glossy; }

    // f without the cosine, 1/sr.
    PBRT_CPU_GPU
    SampledSpectrum f(Vector3f wo, Vector3f wi, TransportMode) const {
        if (wo.z * wi.z <= 0) { return SampledSpectrum(0.f); }
        const srbf_device::SrbfMaterial material = srbf_device::srbf_material(words);
        const srbf_device::SrbfView view = srbf_device::srbf_prepare(material, Above(wo, wo));
        return AtWavelengths(srbf_device::srbf_evaluate(material, view, Above(wi, wo)).value * (1 / std::abs(wi.z)));
    }

    PBRT_CPU_GPU
    pstd::optional<BSDFSample> Sample_f(Vector3f wo, Float uc, Point2f u, TransportMode,
                                        BxDFReflTransFlags sampleFlags = BxDFReflTransFlags::All) const {
        if (!(sampleFlags & BxDFReflTransFlags::Reflection) || wo.z == 0) { return {}; }
        const srbf_device::SrbfMaterial material = srbf_device::srbf_material(words);
        const srbf_device::SrbfView view = srbf_device::srbf_prepare(material, Above(wo, wo));
        const srbf_device::SrbfSample drawn =
            srbf_device::srbf_sample(material, view, srbf_device::vec3(uc, u[0], u[1]));
        if (!(drawn.pdf > 0) || !(drawn.wi.z > 0)) { return {}; }
        // The weight is f cos / pdf.
        const SampledSpectrum f = AtWavelengths(drawn.weight * (drawn.pdf / drawn.wi.z));
        const Float side = wo.z < 0 ? -1.f : 1.f;
        return BSDFSample(f, Vector3f(drawn.wi.x, drawn.wi.y, side * drawn.wi.z), drawn.pdf,
                          BxDFFlags::Reflection | BxDFFlags::Glossy);
    }

    PBRT_CPU_GPU
    Float PDF(Vector3f wo, Vector3f wi, TransportMode,
              BxDFReflTransFlags sampleFlags = BxDFReflTransFlags::All) const {
        if (!(sampleFlags & BxDFReflTransFlags::Reflection) || wo.z * wi.z <= 0) { return 0; }
        const srbf_device::SrbfMaterial material = srbf_device::srbf_material(words);
        const srbf_device::SrbfView view = srbf_device::srbf_prepare(material, Above(wo, wo));
        return srbf_device::srbf_evaluate(material, view, Above(wi, wo)).pdf;
    }

    PBRT_CPU_GPU
    void Regularize() {}

    PBRT_CPU_GPU
    static constexpr const char *Name() { return "SrbfBxDF"; }

    std::string ToString() const { return "[ SrbfBxDF ]"; }

  private:
    // A direction on the side of wo, as one above the surface.
    PBRT_CPU_GPU
    static srbf_device::vec3 Above(Vector3f w, Vector3f wo) {
        return srbf_device::vec3(w.x, w.y, wo.z < 0 ? -w.z : w.z);
    }

    // Values at the wavelengths, none below 0.
    PBRT_CPU_GPU
    SampledSpectrum AtWavelengths(srbf_device::vec3 rgb) const {
        SampledSpectrum s(0.f);
        for (int i = 0; i < NSpectrumSamples; ++i) {
            s[i] = srbf_device::srbf_max(srbf_device::srbf_dot(columns[i], rgb), 0.f);
        }
        return s;
    }

    const uint32_t *words = nullptr;
    srbf_device::vec3 columns[NSpectrumSamples];
};

}  // namespace pbrt

#endif
