// A material or a sheet as a BSDF of Mitsuba's scalar variants, which calls no Python. `python -m srbf_brdf.scalar` compiles it.

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
        m_is_sheet = m_words.size() > 3 && m_words[3] == 2;
        const auto check = m_is_sheet ? srbf_device::srbf_check_sheet : srbf_device::srbf_check;
        if (!file || check(m_words.data(), m_words.size()) != 0)
            Throw("srbf: %s: a material or a sheet is expected", name);
        if (m_is_sheet)
            m_sheet = srbf_device::srbf_sheet(m_words.data());
        else
            m_material = srbf_device::srbf_material(m_words.data());
        m_tint = props.get_texture<Texture>("tint", 1.f);
        m_clamp = props.get<bool>("clamp", true) || is_spectral_v<Spectrum>;
        uint32_t sides = m_is_sheet ? BSDFFlags::FrontSide | BSDFFlags::BackSide : +BSDFFlags::FrontSide;
        if (is_anisotropic())
            sides = sides | BSDFFlags::Anisotropic;
        m_components.push_back(sides | BSDFFlags::GlossyReflection);
        if (m_is_sheet)
            m_components.push_back(sides | BSDFFlags::GlossyTransmission);
        m_flags = 0;
        for (const uint32_t flags : m_components)
            m_flags = m_flags | flags;
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
        if (!is_seen(si, active) || (!m_is_sheet && wo.z() <= 0))
            return { 0.f, 0.f };
        const SrbfHalf half = seen(si, (si.wi.z() < 0) != (wo.z() < 0));
        const srbf_device::SrbfValue found = srbf_device::srbf_half_evaluate(half, vec3(wo.x(), wo.y(), wo.z()));
        return { spectrum(si, half, found.value), found.pdf };
    }

    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext &, const SurfaceInteraction3f &si, Float sample1, const Point2f &sample2,
                                             Mask active) const override {
        BSDFSample3f drawn = dr::zeros<BSDFSample3f>();
        if (!is_seen(si, active))
            return { drawn, 0.f };
        // The half that is drawn from alone: the number that chooses it is the text's own.
        const float share = m_is_sheet ? srbf_device::srbf_reflected_share(m_sheet, towards(si)) : 1.f;
        const bool is_through = sample1 >= share;
        srbf_device::SrbfSheetView pair;
        SrbfHalf &half = is_through ? pair.transmitted : pair.reflected;
        half = seen(si, is_through);
        pair.reflected.share = share;
        const srbf_device::SrbfSample found = srbf_device::srbf_sheet_sample(pair, vec3(sample1, sample2.x(), sample2.y()));
        drawn.wo = Vector3f(found.wi.x, found.wi.y, found.wi.z);
        drawn.pdf = found.pdf;
        drawn.eta = 1.f;
        drawn.sampled_type = is_through ? +BSDFFlags::GlossyTransmission : +BSDFFlags::GlossyReflection;
        drawn.sampled_component = is_through;
        return { drawn, spectrum(si, half, found.weight) };
    }

    Spectrum eval_diffuse_reflectance(const SurfaceInteraction3f &si, Mask active) const override {
        Spectrum albedo(0.f);
        for (const bool is_through : { false, true }) {
            if (!is_seen(si, active) || (is_through && !m_is_sheet))
                continue;
            const SrbfHalf half = seen(si, is_through);
            albedo += spectrum(si, half, srbf_device::srbf_half_albedo(half));
        }
        return albedo;
    }

    std::string to_string() const override { return tfm::format("Srbf[%s, compiled]", m_is_sheet ? "sheet" : "material"); }

    MI_DECLARE_CLASS(SrbfScalar)

private:
    using SrbfHalf = srbf_device::SrbfHalf;

    static vec3 towards(const SurfaceInteraction3f &si) { return vec3(si.wi.x(), si.wi.y(), si.wi.z()); }

    bool is_seen(const SurfaceInteraction3f &si, Mask active) const { return active && (m_is_sheet || si.wi.z() > 0); }

    bool is_anisotropic() const {
        if (!m_is_sheet)
            return m_material.azimuths > 0;
        for (const int at : { m_sheet.front_reflection, m_sheet.front_transmission, m_sheet.back_reflection, m_sheet.back_transmission }) {
            if (at > 0 && srbf_device::srbf_material(m_words.data() + at).azimuths > 0)
                return true;
        }
        return false;
    }

    // Reflection or transmission. A material is the reflection of a sheet that has no other quarter.
    SrbfHalf seen(const SurfaceInteraction3f &si, bool is_through) const {
        if (m_is_sheet)
            return srbf_device::srbf_sheet_half(m_sheet, towards(si), is_through);
        return { m_material, srbf_device::srbf_prepare(m_material, towards(si)), 1.f, false };
    }

    // A colour, or its values at the wavelengths of a path.
    Spectrum spectrum(const SurfaceInteraction3f &si, const SrbfHalf &half, vec3 rgb) const {
        UnpolarizedSpectrum value(0.f);
        if constexpr (is_spectral_v<Spectrum>) {
            for (size_t w = 0; w < value.size(); ++w)
                value[w] = srbf_device::srbf_dot(srbf_device::srbf_primary(half.material, si.wavelengths[w]), rgb);
        } else {
            value = UnpolarizedSpectrum(rgb.x, rgb.y, rgb.z);
        }
        if (m_clamp)
            value = dr::maximum(value, 0.f);
        return depolarizer<Spectrum>(value * m_tint->eval(si, true));
    }

    std::vector<uint32_t> m_words;
    bool m_is_sheet;
    srbf_device::SrbfMaterial m_material;
    srbf_device::SrbfSheet m_sheet;
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
