// A material as a BSDF of Mitsuba's scalar variants, which calls no Python. `python -m srbf_brdf.scalar` compiles it.

#include "srbf_device.hpp"

#include <cstring>
#include <fstream>
#include <iterator>
#include <mitsuba/core/properties.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/texture.h>
#include <vector>

namespace mitsuba {

using srbf_device::vec3;

template <typename Float, typename Spectrum>
class SrbfScalar final : public BSDF<Float, Spectrum> {
public:
    MI_IMPORT_BASE(BSDF, m_flags, m_components)
    MI_IMPORT_TYPES(Texture)

    SrbfScalar(const Properties &props) : Base(props) {
        const std::string name(props.get<std::string_view>("filename"));
        std::ifstream file(name, std::ios::binary);
        const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
        // One more word, as the last one may be there in part.
        m_words.resize(bytes.size() / 4 + 1);
        std::memcpy(m_words.data(), bytes.data(), bytes.size());
        if (!file || srbf_device::srbf_check(m_words.data(), m_words.size()) != 0)
            Throw("srbf: %s: a material is expected", name);
        m_material = srbf_device::srbf_material(m_words.data());
        m_tint = props.get_texture<Texture>("tint", 1.f);
        m_clamp = props.get<bool>("clamp", true) || is_spectral_v<Spectrum>;
        m_flags = BSDFFlags::GlossyReflection | BSDFFlags::FrontSide;
        if (m_material.azimuths > 0)
            m_flags = m_flags | BSDFFlags::Anisotropic;
        m_components.push_back(m_flags);
    }

    void traverse(TraversalCallback *callback) override {
        callback->put("tint", m_tint, ParamFlags::Differentiable);
    }

    Spectrum eval(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override {
        return eval_pdf(ctx, si, wo, active).first;
    }

    Float pdf(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override {
        return eval_pdf(ctx, si, wo, active).second;
    }

    std::pair<Spectrum, Float> eval_pdf(const BSDFContext &, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override {
        if (!active || si.wi.z() <= 0 || wo.z() <= 0)
            return { 0.f, 0.f };
        const srbf_device::SrbfValue found = srbf_device::srbf_evaluate(m_material, view(si), vec3(wo.x(), wo.y(), wo.z()));
        return { spectrum(si, found.value), found.pdf };
    }

    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext &, const SurfaceInteraction3f &si, Float sample1, const Point2f &sample2,
                                             Mask active) const override {
        BSDFSample3f drawn = dr::zeros<BSDFSample3f>();
        if (!active || si.wi.z() <= 0)
            return { drawn, 0.f };
        const vec3 u(sample1, sample2.x(), sample2.y());
        const srbf_device::SrbfSample found = srbf_device::srbf_sample(m_material, view(si), u);
        drawn.wo = Vector3f(found.wi.x, found.wi.y, found.wi.z);
        drawn.pdf = found.pdf;
        drawn.eta = 1.f;
        drawn.sampled_type = +BSDFFlags::GlossyReflection;
        return { drawn, spectrum(si, found.weight) };
    }

    Spectrum eval_diffuse_reflectance(const SurfaceInteraction3f &si, Mask active) const override {
        if (!active || si.wi.z() <= 0)
            return 0.f;
        const srbf_device::SrbfView seen = view(si);
        vec3 albedo = seen.albedo;
        if (m_material.half_nodes > 0) {
            const auto change = [&](int i) { return srbf_device::srbf_between(m_material, seen, m_material.differences, 3, i); };
            albedo = albedo + vec3(change(0), change(1), change(2)) * seen.power;
        }
        return spectrum(si, albedo);
    }

    std::string to_string() const override { return tfm::format("Srbf[%i lobes, compiled]", m_material.lobes + m_material.mirrored); }

    MI_DECLARE_CLASS(SrbfScalar)

private:
    srbf_device::SrbfView view(const SurfaceInteraction3f &si) const {
        return srbf_device::srbf_prepare(m_material, vec3(si.wi.x(), si.wi.y(), si.wi.z()));
    }

    // A colour, or its values at the wavelengths of a path.
    Spectrum spectrum(const SurfaceInteraction3f &si, vec3 rgb) const {
        UnpolarizedSpectrum value(0.f);
        if constexpr (is_spectral_v<Spectrum>) {
            for (size_t w = 0; w < value.size(); ++w)
                value[w] = srbf_device::srbf_dot(srbf_device::srbf_primary(m_material, si.wavelengths[w]), rgb);
        } else {
            value = UnpolarizedSpectrum(rgb.x, rgb.y, rgb.z);
        }
        if (m_clamp)
            value = dr::maximum(value, 0.f);
        return depolarizer<Spectrum>(value * m_tint->eval(si, true));
    }

    std::vector<uint32_t> m_words;
    srbf_device::SrbfMaterial m_material;
    ref<Texture> m_tint;
    bool m_clamp;

    MI_TRAVERSE_CB(Base, m_tint)
};

} // namespace mitsuba

template <typename Spectrum>
static void add(std::string_view name, const char *variant, mitsuba::PluginRegisterFn fn) {
    using Material = mitsuba::SrbfScalar<float, Spectrum>;
    fn(name, variant, Material::Type, [](void *, const mitsuba::Properties &props) -> mitsuba::ref<mitsuba::Object> { return new Material(props); });
}

// The scalar variants of Mitsuba's package. Dr.Jit traces the others from Python.
extern "C" MI_EXPORT void init_plugin(std::string_view name, mitsuba::PluginRegisterFn fn) {
    using Spectral = mitsuba::Spectrum<float, 4>;
    add<mitsuba::Color<float, 3>>(name, "scalar_rgb", fn);
    add<Spectral>(name, "scalar_spectral", fn);
    add<mitsuba::MuellerMatrix<Spectral>>(name, "scalar_spectral_polarized", fn);
}
