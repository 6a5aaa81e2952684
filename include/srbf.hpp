/*
 * srbf for C++17: RAII over srbf.h, which says what each call does. Header only, no exceptions, no allocation of its own.
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef SRBF_HPP
#define SRBF_HPP

#include "srbf.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace srbf {

template <class T>
class Span;

/// Requirements of the constructors of Span.
namespace detail {
template <class U>
std::true_type is_span(const Span<U> *);
std::false_type is_span(const void *);

/// Elements of U are elements of T, at most less const: neither of another type nor of a derived one, of another size.
template <class U, class T>
constexpr bool is_same_element = std::is_convertible_v<U (*)[], T (*)[]>;

/// The element type of the data() of a container. None for a Span, which has a stride to keep.
template <class Container, class = decltype(std::declval<Container &>().size())>
using Element =
    std::enable_if_t<!decltype(is_span(static_cast<std::remove_reference_t<Container> *>(nullptr)))::value,
                     std::remove_pointer_t<decltype(std::declval<Container &>().data())>>;
} // namespace detail

/// A view of n elements, `stride` bytes apart, in memory of the caller: std::span with a stride, for C++17.
template <class T>
class Span {
public:
    constexpr Span() = default;
    constexpr Span(T *data, std::size_t size, std::size_t stride = sizeof(T))
        : data_(data), size_(size), stride_(stride) {}
    /// From a span of elements that are less const; the stride stays.
    template <class U, class = std::enable_if_t<detail::is_same_element<U, T>>>
    constexpr Span(const Span<U> &other) : Span(other.data(), other.size(), other.stride()) {}
    /// From anything contiguous: std::vector, std::array, std::span.
    template <class Container, class = std::enable_if_t<detail::is_same_element<detail::Element<Container>, T>>>
    constexpr Span(Container &container) : Span(container.data(), container.size()) {}
    /// From a temporary too, if it is only a view, as std::span is, or only read. The viewed memory must outlive the span.
    template <class Container, class = std::enable_if_t<detail::is_same_element<detail::Element<const Container>, T>>>
    constexpr Span(const Container &container) : Span(container.data(), container.size()) {}
    constexpr T *data() const { return data_; }
    constexpr std::size_t size() const { return size_; }
    constexpr std::size_t stride() const { return stride_; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0, stride_ = sizeof(T);
};

/// Three floats: a direction or a colour in linear sRGB.
using Vec3 = std::array<float, 3>;

/// The status of a call; true is failure, as with std::error_code. Some are made here, by SRBF_STATUS_SIZE for example, without a
/// call: `text` gives the meaning of a status wherever it comes from.
class [[nodiscard]] Status {
public:
    constexpr Status(srbf_status status = SRBF_STATUS_OK) : status_(status) {}
    constexpr explicit operator bool() const { return status_ != SRBF_STATUS_OK; }
    constexpr srbf_status code() const { return status_; }
    const char *text() const { return srbf_status_text(status_); }

private:
    srbf_status status_;
};

/// The request for each of n hits: outputs that are named are wanted. All spans have n elements, or asking is refused by
/// SRBF_STATUS_SIZE.
class Request {
public:
    Request() { request_.size = sizeof request_; }

    /// Outgoing directions, of a material.
    Request &wo(Span<const Vec3> wo) { return put(request_.wo, wo); }
    /// Incident directions, of which `value` and `pdf` are.
    Request &wi(Span<const Vec3> wi) { return put(request_.wi, wi); }
    /// Three uniform numbers a hit, for the draws.
    Request &u(Span<const Vec3> u) { return put(request_.u, u); }
    Request &value(Span<Vec3> value) { return put(request_.value, value); }
    Request &pdf(Span<float> pdf) {
        request_.pdf = {pdf.data(), pdf.stride()};
        return count(pdf.size(), pdf.data());
    }
    /// Draws with densities and weights.
    Request &samples(Span<srbf_sample> samples) {
        srbf_sample *first = samples.data();
        const std::size_t stride = samples.stride();
        if (first != nullptr) {
            float *d = first->direction, *w = first->weight;
            request_.samples = {{d, d + 1, d + 2, stride}, {&first->pdf, stride}, {w, w + 1, w + 2, stride}};
        }
        return count(samples.size(), first);
    }
    /// Draws with densities alone.
    Request &directions(Span<Vec3> wi, Span<float> pdf) {
        put(request_.samples.direction, wi);
        request_.samples.pdf = {pdf.data(), pdf.stride()};
        return count(pdf.size(), pdf.data());
    }
    /// The material of each hit, for `ask_each`.
    Request &materials(Span<const srbf_material *const> materials) {
        request_.materials = {materials.data(), materials.stride()};
        return count(materials.size(), materials.data());
    }

    /// Number of hits, and the request.
    std::size_t size() const { return size_; }
    const srbf_request *get() const { return &request_; }
    /// SRBF_STATUS_SIZE for spans of different length, SRBF_STATUS_NULL for one of nothing that has a length.
    Status status() const { return status_; }

private:
    template <class Vectors, class T>
    Request &put(Vectors &to, Span<T> span) {
        using Float = std::conditional_t<std::is_const_v<T>, const float, float>;
        Float *first = reinterpret_cast<Float *>(span.data());
        if (first != nullptr) to = {first, first + 1, first + 2, span.stride()};
        return count(span.size(), first);
    }
    Request &count(std::size_t size, const void *data) {
        if (is_counted_ && size != size_) status_ = SRBF_STATUS_SIZE;
        else if (!status_ && size > 0 && data == nullptr) status_ = SRBF_STATUS_NULL;
        is_counted_ = true, size_ = size;
        return *this;
    }
    srbf_request request_ = {};
    std::size_t size_ = 0;
    bool is_counted_ = false;
    Status status_;
};

/// Asks for hits of which each has a material of its own.
inline Status ask_each(const Request &request) {
    return request.status() ? request.status() : Status(srbf_material_ask(nullptr, request.size(), request.get()));
}

/// The mixture of lobes for one outgoing direction, with storage for as many lobes as a material may have (16, 32, 64).
///
/// Move-only, so that no copy is made unseen; `clone` copies.
template <std::size_t Lobes = 16>
class Mixture {
    static_assert(Lobes == 16 || Lobes == 32 || Lobes == 64, "a mixture has room for 16, 32 or 64 lobes");

public:
    Mixture() {
        srbf_mixture *made = nullptr;
        // Size and alignment are those that the header names: this cannot fail.
        (void)srbf_mixture_init(storage_.data(), storage_.size(), &made);
    }
    Mixture(Mixture &&) = default;
    Mixture &operator=(Mixture &&) = default;
    Mixture clone() const { return Mixture(*this); }

    srbf_mixture *get() { return reinterpret_cast<srbf_mixture *>(storage_.data()); }
    const srbf_mixture *get() const { return reinterpret_cast<const srbf_mixture *>(storage_.data()); }

    /// Makes it a mixture of round lobes, beside a diffuse term if there is one.
    Status from_lobes(std::uint32_t domain, Span<const srbf_lobe> lobes, const Vec3 *diffuse = nullptr) {
        const float *albedo = diffuse != nullptr ? diffuse->data() : nullptr;
        return srbf_mixture_from_lobes(domain, 1, 0, lobes.size(), lobes.data(), albedo, get());
    }
    Status query(srbf_mixture_info &info) const { return srbf_mixture_query(get(), &info); }

    Status evaluate(const Vec3 &wi, Vec3 &value) const {
        return srbf_mixture_evaluate(get(), wi.data(), value.data());
    }
    Status pdf(const Vec3 &wi, float &pdf) const { return srbf_mixture_pdf(get(), wi.data(), &pdf); }
    Status evaluate_and_pdf(const Vec3 &wi, Vec3 &value, float &pdf) const {
        return srbf_mixture_evaluate_and_pdf(get(), wi.data(), value.data(), &pdf);
    }
    Status sample(const Vec3 &u, srbf_sample &sample) const {
        return srbf_mixture_sample(get(), u.data(), &sample);
    }
    /// What next-event estimation needs: a sample, and value and density towards another direction.
    Status sample_and_evaluate(const Vec3 &u, srbf_sample &sample, const Vec3 &wi, Vec3 &value, float &pdf) const {
        return srbf_mixture_sample_and_evaluate(get(), u.data(), &sample, wi.data(), value.data(), &pdf);
    }

    /// n hits of this mixture.
    Status ask(const Request &request) const {
        return request.status() ? request.status() : Status(srbf_mixture_ask(get(), 0, request.size(), request.get()));
    }

private:
    Mixture(const Mixture &) = default;
    alignas(SRBF_MIXTURE_ALIGNMENT) std::array<unsigned char,
                                               Lobes == 16   ? SRBF_MIXTURE_SIZE_16
                                               : Lobes == 32 ? SRBF_MIXTURE_SIZE_32
                                                             : SRBF_MIXTURE_SIZE_64>
        storage_;
};

/// A material made ready for speed, in storage of the caller: `srbf_expanded_size` bytes, aligned to SRBF_EXPANDED_ALIGNMENT, which
/// must outlive it, as must the material. A view, to be copied; an empty one answers every call with SRBF_STATUS_NULL.
class Expanded {
public:
    /// Prepares a material at this number of angles; SRBF_EXPANDED_DEFAULT_ROWS is a good number.
    Status make(const srbf_material *material, std::size_t rows, void *storage, std::size_t size) {
        srbf_expanded *made = nullptr;
        const Status status = srbf_expanded_make(material, rows, storage, size, &made);
        if (!status) expanded_ = made;
        return status;
    }

    /// n hits, each with an outgoing direction of its own.
    Status ask(const Request &request) const {
        return request.status() ? request.status() : Status(srbf_expanded_ask(expanded_, request.size(), request.get()));
    }

    const srbf_expanded *get() const { return expanded_; }
    explicit operator bool() const { return expanded_ != nullptr; }

    template <std::size_t Lobes>
    Status prepare(const Vec3 &wo, Mixture<Lobes> &mixture) const {
        return srbf_expanded_prepare(expanded_, wo.data(), mixture.get());
    }

private:
    srbf_expanded *expanded_ = nullptr;
};

/// Blends of several materials at one hit, of parts in memory of the caller: see srbf_blend_part.
namespace blend {
/// A part, untinted. The material must outlive it.
template <class Material>
srbf_blend_part part(const Material &material, float weight) {
    srbf_blend_part made{};
    made.material = material.get();
    made.weight = weight;
    for (float &channel : made.tint) channel = 1;
    return made;
}
/// Whether parts are one behind the other.
inline Status check(Span<const srbf_blend_part> parts) {
    return parts.stride() == sizeof(srbf_blend_part) ? SRBF_STATUS_OK : SRBF_STATUS_STRIDE;
}
inline Status albedo(Span<const srbf_blend_part> parts, const Vec3 &wo, Vec3 &albedo) {
    const Status status = check(parts);
    return status ? status : Status(srbf_blend_albedo(parts.data(), parts.size(), wo.data(), albedo.data()));
}
inline Status evaluate_and_pdf(Span<const srbf_blend_part> parts, const Vec3 &wo, const Vec3 &wi, Vec3 &value, float &pdf) {
    const Status status = check(parts);
    if (status) return status;
    return srbf_blend_evaluate_and_pdf(parts.data(), parts.size(), wo.data(), wi.data(), value.data(), &pdf);
}
inline Status sample(Span<const srbf_blend_part> parts, const Vec3 &wo, const Vec3 &u, srbf_sample &sample) {
    const Status status = check(parts);
    return status ? status : Status(srbf_blend_sample(parts.data(), parts.size(), wo.data(), u.data(), &sample));
}
inline Status sample_and_evaluate(Span<const srbf_blend_part> parts, const Vec3 &wo, const Vec3 &u, srbf_sample &sample, const Vec3 &wi,
                                  Vec3 &value, float &pdf) {
    const Status status = check(parts);
    if (status) return status;
    return srbf_blend_sample_and_evaluate(parts.data(), parts.size(), wo.data(), u.data(), &sample, wi.data(), value.data(), &pdf);
}
/// One part at random, and the rest of the number.
inline Status choose(Span<const srbf_blend_part> parts, float u, srbf_blend_part &part, float &left) {
    const Status status = check(parts);
    return status ? status : Status(srbf_blend_choose(parts.data(), parts.size(), u, &part, &left));
}
/// n hits of one blend, each with an outgoing direction of its own; `ask_each` of a blend each, `count` parts of each hit after the other's.
inline Status ask(Span<const srbf_blend_part> parts, const Request &request) {
    const Status status = request.status() ? request.status() : check(parts);
    return status ? status : Status(srbf_blend_ask(parts.data(), parts.size(), 0, request.size(), request.get()));
}
inline Status ask_each(Span<const srbf_blend_part> parts, std::size_t count, const Request &request) {
    if (request.status()) return request.status();
    if (check(parts)) return check(parts);
    if (count == 0 || parts.size() / count != request.size() || parts.size() % count != 0) return SRBF_STATUS_SIZE;
    return srbf_blend_ask(parts.data(), count, count * sizeof(srbf_blend_part), request.size(), request.get());
}
} // namespace blend

/// Light from a map, and light and material sampled together, in storage of the caller: `srbf_environment_size` bytes, aligned to
/// SRBF_ENVIRONMENT_ALIGNMENT, which must outlive it. A view, to be copied; an empty one answers every call with SRBF_STATUS_NULL.
class Environment {
public:
    /// Makes the table of a map in the storage. `radiance` has the top row first.
    Status make(std::size_t width, std::size_t height, const float *radiance, float turn, void *storage, std::size_t size) {
        srbf_environment *made = nullptr;
        const Status status = srbf_environment_make(width, height, radiance, turn, storage, size, &made);
        if (!status) environment_ = made;
        return status;
    }
    /// Takes a table that was stored; the storage has SRBF_ENVIRONMENT_HEAD_SIZE bytes.
    Status read(const void *table, std::size_t table_size, float turn, void *storage, std::size_t size) {
        srbf_environment *made = nullptr;
        const Status status = srbf_environment_read(table, table_size, turn, storage, size, &made);
        if (!status) environment_ = made;
        return status;
    }
    const srbf_environment *get() const { return environment_; }
    explicit operator bool() const { return environment_ != nullptr; }

    Status query(srbf_environment_info &info) const { return srbf_environment_query(environment_, &info); }
    /// Radiance and density; nullptr for an output that is not wanted.
    Status evaluate(const Vec3 &direction, Vec3 *radiance, float *pdf) const {
        return srbf_environment_evaluate(environment_, direction.data(), radiance != nullptr ? radiance->data() : nullptr, pdf);
    }
    Status sample(const Vec3 &u, srbf_light_sample &sample) const { return srbf_environment_sample(environment_, u.data(), &sample); }
    /// Draws for this light and a mixture together. `u`: the first uniform number of each candidate, then the second, then the third.
    template <std::size_t Lobes>
    Status sample_product(const Mixture<Lobes> &mixture, const std::array<Vec3, 3> &frame, const srbf_product_sampling &sampling,
                          Span<const float> u, float choice, srbf_product_sample &sample) const {
        if (u.size() != std::size_t{3} * sampling.candidates || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_mixture_sample_product(mixture.get(), environment_, frame[0].data(), &sampling, u.data(), choice, &sample);
    }

    /// Draws sixteen samples of the light. `u`: the first uniform number of each sample, then the second, then the third.
    Status draw_block(Span<const float> u, srbf_light_block &block) const {
        if (u.size() != std::size_t{3} * SRBF_LIGHT_BLOCK || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_light_block_draw(environment_, u.data(), &block);
    }
    /// Draws the path's ray and a shadow ray for this light and a mixture, by even sums. `u`: the first uniform number of each direction of the
    /// lobes, then the second, then the third.
    template <std::size_t Lobes>
    Status reflect(const Mixture<Lobes> &mixture, const srbf_light_block &block, const std::array<Vec3, 3> &frame, const Vec3 &flat,
                   Span<const float> u, float choice, srbf_reflection &reflection) const {
        if (u.size() % 3 != 0 || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_mixture_reflect(mixture.get(), environment_, &block, frame[0].data(), flat.data(), u.size() / 3, u.data(), choice,
                                    &reflection);
    }

private:
    srbf_environment *environment_ = nullptr;
};

/// Light of any kind, sampled together with a material: a view of an object of the caller, which must outlive it, with the two verbs
///
///     void sample(std::size_t count, const float (*u)[SRBF_LIGHT_BLOCK], srbf_light_rows &rows) const;
///     void evaluate(std::size_t count, srbf_light_rows &rows) const;
///
/// that `srbf_light_source` describes; `u` three rows of uniform numbers. An exception of theirs makes the call give SRBF_STATUS_LIGHT.
class LightSource {
public:
    template <class Light>
    explicit LightSource(const Light &light) : source_{const_cast<Light *>(&light), sample_of<Light>, evaluate_of<Light>} {}

    const srbf_light_source *get() const { return &source_; }

    /// Draws for this light and a mixture together: `sample.factor` times the radiance that is found along `sample.direction` reaches the viewer.
    template <std::size_t Lobes>
    Status sample_product(const Mixture<Lobes> &mixture, const std::array<Vec3, 3> &frame, const srbf_product_sampling &sampling,
                          Span<const float> u, float choice, srbf_product_sample &sample) const {
        if (u.size() != std::size_t{3} * sampling.candidates || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_mixture_sample_product_from(mixture.get(), get(), frame[0].data(), &sampling, u.data(), choice, &sample);
    }
    /// As of an `Environment`; its light is an estimate.
    Status draw_block(Span<const float> u, srbf_light_block &block) const {
        if (u.size() != std::size_t{3} * SRBF_LIGHT_BLOCK || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_light_block_draw_from(get(), u.data(), &block);
    }
    /// As of an `Environment`; `srbf_reflection_light_from` gives the light.
    template <std::size_t Lobes>
    Status reflect(const Mixture<Lobes> &mixture, const srbf_light_block &block, const std::array<Vec3, 3> &frame, const Vec3 &flat,
                   Span<const float> u, float choice, srbf_reflection &reflection) const {
        if (u.size() % 3 != 0 || u.stride() != sizeof(float)) return SRBF_STATUS_SIZE;
        return srbf_mixture_reflect_from(mixture.get(), get(), &block, frame[0].data(), flat.data(), u.size() / 3, u.data(), choice,
                                         &reflection);
    }

private:
    /// Runs a verb, which must not leave by an exception.
    template <class Verb>
    static srbf_status contained(Verb verb) noexcept {
#if defined(__cpp_exceptions)
        try {
            verb();
        } catch (...) {
            return SRBF_STATUS_LIGHT;
        }
#else
        verb();
#endif
        return SRBF_STATUS_OK;
    }
    template <class Light>
    static srbf_status sample_of(void *user, std::size_t count, const float *u, srbf_light_rows *rows) noexcept {
        const auto numbers = reinterpret_cast<const float(*)[SRBF_LIGHT_BLOCK]>(u);
        return contained([&] { static_cast<const Light *>(user)->sample(count, numbers, *rows); });
    }
    template <class Light>
    static srbf_status evaluate_of(void *user, std::size_t count, srbf_light_rows *rows) noexcept {
        return contained([&] { static_cast<const Light *>(user)->evaluate(count, *rows); });
    }

    srbf_light_source source_;
};

/// The columns of a material at N wavelengths, three numbers each, which take its colours to values there.
template <std::size_t N>
struct Primaries {
    std::array<float, 3 * N> columns{};

    /// The values of a colour; none is below 0.
    Status of(const Vec3 &rgb, std::array<float, N> &values) const {
        return srbf_primaries_of(columns.data(), N, rgb.data(), values.data());
    }
};

#if defined(SRBF_HOSTED)
/// A sheet, which reflects light and lets some through, and which it owns. Move-only; an empty one answers every call with
/// SRBF_STATUS_NULL.
class Sheet {
public:
    Sheet() = default;
    ~Sheet() { (void)srbf_sheet_free(sheet_); }
    Sheet(Sheet &&other) noexcept : sheet_(std::exchange(other.sheet_, nullptr)) {}
    Sheet &operator=(Sheet &&other) noexcept {
        std::swap(sheet_, other.sheet_);
        return *this;
    }

    /// Reads a `.srbf` file; releases the sheet that it held before. On failure it keeps that sheet.
    Status load(const char *path) {
        Sheet made;
        const Status status = srbf_sheet_load(path, &made.sheet_);
        if (!status) *this = std::move(made);
        return status;
    }

    const srbf_sheet *get() const { return sheet_; }
    explicit operator bool() const { return sheet_ != nullptr; }

    Status query(srbf_sheet_info &info) const { return srbf_sheet_query(sheet_, &info); }
    Status albedos(const Vec3 &wo, Vec3 &reflected, Vec3 &transmitted) const {
        return srbf_sheet_albedos(sheet_, wo.data(), reflected.data(), transmitted.data());
    }
    Status evaluate_and_pdf(const Vec3 &wo, const Vec3 &wi, Vec3 &value, float &pdf) const {
        return srbf_sheet_evaluate_and_pdf(sheet_, wo.data(), wi.data(), value.data(), &pdf);
    }
    Status sample(const Vec3 &wo, const Vec3 &u, srbf_sample &sample) const {
        return srbf_sheet_sample(sheet_, wo.data(), u.data(), &sample);
    }
    /// n hits, each with an outgoing direction of its own.
    Status ask(const Request &request) const {
        return request.status() ? request.status() : Status(srbf_sheet_ask(sheet_, request.size(), request.get()));
    }

private:
    srbf_sheet *sheet_ = nullptr;
};

/// A material, which it owns. Move-only; an empty one answers every call with SRBF_STATUS_NULL.
class Material {
public:
    Material() = default;
    ~Material() { (void)srbf_material_free(material_); }
    Material(Material &&other) noexcept : material_(std::exchange(other.material_, nullptr)) {}
    Material &operator=(Material &&other) noexcept {
        std::swap(material_, other.material_);
        return *this;
    }

    /// Reads a `.srbf` file; releases the material that it held before. On failure it keeps that material.
    Status load(const char *path) {
        Material made;
        const Status status = srbf_material_load(path, &made.material_);
        if (!status) *this = std::move(made);
        return status;
    }
    /// Copies `.srbf` bytes.
    Status from_bytes(Span<const unsigned char> bytes) {
        Material made;
        const Status status = srbf_material_from_bytes(bytes.data(), bytes.size(), &made.material_);
        if (!status) *this = std::move(made);
        return status;
    }

    const srbf_material *get() const { return material_; }
    explicit operator bool() const { return material_ != nullptr; }

    Status query(srbf_material_info &info) const { return srbf_material_query(material_, &info); }
    Status albedo(const Vec3 &wo, Vec3 &albedo) const {
        return srbf_material_albedo(material_, wo.data(), albedo.data());
    }
    /// What values are multiplied by for a pair of directions; 1 without factors.
    Status factor(const Vec3 &wo, const Vec3 &wi, Vec3 &factor) const {
        return srbf_material_factor(material_, wo.data(), wi.data(), factor.data());
    }
    /// Which spectra its colours have.
    Status spectrum(srbf_spectrum &spectrum) const { return srbf_material_spectrum(material_, &spectrum); }
    /// The columns at some wavelengths in nm, once for a path.
    template <std::size_t N>
    Status primaries(const std::array<float, N> &wavelengths, Primaries<N> &primaries) const {
        return srbf_material_primaries(material_, wavelengths.data(), N, primaries.columns.data());
    }
    /// One hit, without a mixture.
    Status evaluate(const Vec3 &wo, const Vec3 &wi, Vec3 &value) const {
        return srbf_material_evaluate(material_, wo.data(), wi.data(), value.data());
    }
    Status pdf(const Vec3 &wo, const Vec3 &wi, float &pdf) const {
        return srbf_material_pdf(material_, wo.data(), wi.data(), &pdf);
    }
    Status evaluate_and_pdf(const Vec3 &wo, const Vec3 &wi, Vec3 &value, float &pdf) const {
        return srbf_material_evaluate_and_pdf(material_, wo.data(), wi.data(), value.data(), &pdf);
    }
    Status sample(const Vec3 &wo, const Vec3 &u, srbf_sample &sample) const {
        return srbf_material_sample(material_, wo.data(), u.data(), &sample);
    }
    Status sample_and_evaluate(const Vec3 &wo, const Vec3 &u, srbf_sample &sample, const Vec3 &wi, Vec3 &value,
                               float &pdf) const {
        return srbf_material_sample_and_evaluate(material_, wo.data(), u.data(), &sample, wi.data(), value.data(), &pdf);
    }
    /// n hits of this material, each with an outgoing direction of its own.
    Status ask(const Request &request) const {
        if (material_ == nullptr) return SRBF_STATUS_NULL;
        return request.status() ? request.status() : Status(srbf_material_ask(material_, request.size(), request.get()));
    }
    /// The material must outlive the mixture if it has factors.
    template <std::size_t Lobes>
    Status prepare(const Vec3 &wo, Mixture<Lobes> &mixture) const {
        return srbf_material_prepare(material_, wo.data(), mixture.get());
    }
    template <std::size_t Lobes>
    Status prepare_leaving_out(const Vec3 &wo, float lobes, float folds, Mixture<Lobes> &mixture) const {
        return srbf_material_prepare_leaving_out(material_, wo.data(), lobes, folds, mixture.get());
    }

private:
    srbf_material *material_ = nullptr;
};

/// The message of the last call of srbf.h that failed on this thread; a call that this wrapper refuses by itself leaves none.
inline const char *last_message() { return srbf_last_message(); }
#endif

} // namespace srbf

#endif
