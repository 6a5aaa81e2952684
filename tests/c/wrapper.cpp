/* The C++ wrapper: moves, spans, statuses; and structures that C and C++ lay out alike.
 *
 *     wrapper MATERIAL.srbf SHEET.srbf
 */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <srbf.hpp>
#include <type_traits>
#include <vector>
#if __has_include(<span>)
#include <span>
#endif

#define CHECK(condition)                                                                                          \
    do {                                                                                                          \
        if (!(condition)) {                                                                                       \
            std::fprintf(stderr, "%s:%d: failed: %s (%s)\n", __FILE__, __LINE__, #condition, srbf::last_message()); \
            std::exit(1);                                                                                         \
        }                                                                                                         \
    } while (0)

static_assert(!std::is_copy_constructible_v<srbf::Material> && std::is_nothrow_move_constructible_v<srbf::Material>);
static_assert(!std::is_copy_constructible_v<srbf::Mixture<16>> && std::is_move_constructible_v<srbf::Mixture<16>>);
static_assert(sizeof(srbf_sample) == 28 && std::is_standard_layout_v<srbf_sample> && sizeof(srbf_vectors) == 4 * sizeof(void *));

/* A span of a type that is no element, or of another size, is none. */
struct Base {
    srbf::Vec3 v;
};
struct Derived : Base {
    int id;
};
struct Named : srbf::Span<float> {
    using srbf::Span<float>::Span;
};
template <class T, class From>
constexpr bool makes = std::is_constructible_v<srbf::Span<T>, From> && std::is_convertible_v<From, srbf::Span<T>>;
template <class T, class From>
constexpr bool makes_none = !std::is_constructible_v<srbf::Span<T>, From>;
static_assert(makes<float, std::vector<float> &> && makes<const float, std::vector<float> &>);
static_assert(makes<const float, const std::vector<float> &> && makes<const float, std::vector<float>>);
static_assert(makes<float, std::array<float, 3> &> && makes<const float, const std::array<const float, 3>>);
static_assert(makes<float, srbf::Span<float> &> && makes<const float, srbf::Span<float> &>);
static_assert(makes<const float, srbf::Span<float>> && makes<const float, const srbf::Span<const float> &>);
static_assert(makes<float, Named &> && makes<const float, Named>);
static_assert(makes_none<float, const std::vector<float> &> && makes_none<float, std::vector<float>>);
static_assert(makes_none<float, std::vector<double> &> && makes_none<const float, std::vector<int> &>);
static_assert(makes_none<Base, std::vector<Derived> &> && makes_none<const Base, srbf::Span<Derived> &>);
static_assert(makes_none<float, srbf::Span<const float> &> && makes_none<float, int &> && makes_none<float, float *&>);
#if defined(__cpp_lib_span)
static_assert(makes<float, std::span<float>> && makes<float, const std::span<float> &>);
static_assert(makes<const float, std::span<float> &> && makes<const float, std::span<const float>>);
static_assert(makes<float, std::span<float, 3>> && makes_none<float, std::span<const float>>);
#endif

/* The record that a renderer keeps of a hit: the density is one member of many. */
struct Hit {
    float pdf;
    int id;
    float throughput[3];
};

/* Spans keep their stride however they are copied: nothing is written beside the member. */
static void strides(const srbf::Mixture<16> &mixture) {
    std::vector<srbf::Vec3> wi(8, srbf::Vec3{-0.6f, 0, 0.8f});
    std::array<Hit, 8> hits;
    hits.fill({-1, 1000, {7, 7, 7}});
    srbf::Span<float> pdf(&hits[0].pdf, hits.size(), sizeof(Hit)), copy(pdf);
    srbf::Span<const float> read = pdf;
    const Named named(&hits[0].pdf, hits.size(), sizeof(Hit));
    srbf::Span<float> of_named = named;
    CHECK(copy.stride() == sizeof(Hit) && read.stride() == sizeof(Hit) && of_named.stride() == sizeof(Hit));
    CHECK(read.data() == &hits[0].pdf && read.size() == 8 && of_named.size() == 8);
    CHECK(!mixture.ask(srbf::Request().wi(wi).pdf(pdf)) && !mixture.ask(srbf::Request().wi(wi).pdf(copy)));
    for (const Hit &hit : hits) {
        CHECK(hit.pdf > 0 && hit.id == 1000 && hit.throughput[0] == 7 && hit.throughput[2] == 7);
    }
#if defined(__cpp_lib_span)
    std::vector<float> dense(8);
    CHECK(!mixture.ask(srbf::Request().wi(std::span<const srbf::Vec3>(wi)).pdf(std::span<float>(dense))) && dense[7] == hits[7].pdf);
#endif
}

/* Nothing to do, and nowhere to do it. */
static void nothing(const srbf::Mixture<16> &mixture) {
    std::vector<srbf::Vec3> none;
    srbf::Span<srbf_sample> nowhere;
    CHECK(!mixture.ask(srbf::Request().wi(none).value(none).u(none).samples(nowhere)) && !mixture.ask(srbf::Request()));
    CHECK(mixture.ask(srbf::Request().wi({nullptr, 3}).value({nullptr, 3})).code() == SRBF_STATUS_NULL);
    CHECK(mixture.ask(srbf::Request().u({nullptr, 3}).samples({nullptr, 3})).code() == SRBF_STATUS_NULL);
    srbf::Status status = mixture.ask(srbf::Request().wi({nullptr, 3}).pdf({}));
    CHECK(status.code() == SRBF_STATUS_SIZE && status.text() == srbf::Status(SRBF_STATUS_SIZE).text());
}

static void use(const char *path) {
    srbf::Material material;
    srbf_material_info info;
    CHECK(!material && material.query(info).code() == SRBF_STATUS_NULL);
    CHECK(!material.load(path));
    CHECK(material.load("/no/such/file").code() == SRBF_STATUS_FILE && material);
    CHECK(!material.query(info) && info.lobes == 12);
    srbf::Material other;
    CHECK(!other.from_bytes({info.bytes, info.byte_count}));
    other = std::move(material);
    srbf::Material moved(std::move(other));
    CHECK(!other && moved);

    srbf::Mixture<16> mixture;
    const srbf::Vec3 wo = {0.6f, 0, 0.8f}, u = {0.25f, 0.5f, 0.75f};
    CHECK(!moved.prepare(wo, mixture));
    srbf::Mixture<16> clone = mixture.clone(), taken = std::move(mixture);
    srbf_sample sample;
    CHECK(!taken.sample(u, sample) && sample.pdf > 0);
    srbf::Vec3 wi = {sample.direction[0], sample.direction[1], sample.direction[2]}, value, albedo;
    float pdf;
    CHECK(!clone.evaluate_and_pdf(wi, value, pdf) && std::fabs(pdf - sample.pdf) <= 1e-3f * pdf);
    CHECK(!clone.evaluate(wi, value) && !clone.pdf(wi, pdf) && !moved.albedo(wo, albedo) && albedo[0] > 0);

    std::vector<srbf::Vec3> us(100, u), directions(100), values(100);
    std::vector<float> pdfs(100);
    std::vector<srbf_sample> samples(100);
    CHECK(!taken.ask(srbf::Request().u({us.data(), us.size()}).samples(samples)));
    for (std::size_t i = 0; i < 100; i++) {
        directions[i] = {samples[i].direction[0], samples[i].direction[1], samples[i].direction[2]};
    }
    CHECK(!taken.ask(srbf::Request().wi({directions.data(), 100}).value(values).pdf(pdfs)));
    CHECK(std::fabs(pdfs[99] - sample.pdf) <= 1e-3f * pdf && values[99][1] > 0);
    CHECK(taken.ask(srbf::Request().wi({directions.data(), 99}).pdf(pdfs)).code() == SRBF_STATUS_SIZE);

    std::vector<float> drawn(100);
    CHECK(!taken.ask(srbf::Request().u({us.data(), us.size()}).directions(values, drawn)));
    CHECK(std::fabs(values[99][0] - directions[99][0]) < 1e-6f && std::fabs(drawn[99] - sample.pdf) <= 1e-3f * pdf);
    CHECK(taken.ask(srbf::Request().u({us.data(), 99}).directions(values, drawn)).code() == SRBF_STATUS_SIZE);

    strides(taken);
    nothing(taken);

    srbf::Mixture<64> large;
    const std::array<srbf_lobe, 1> lobes = {{{{0, 0, 1}, 10, {1, 1, 1}}}};
    const srbf::Vec3 grey = {0.5f, 0.5f, 0.5f};
    srbf_mixture_info mixture_info;
    CHECK(!large.from_lobes(SRBF_DOMAIN_HEMISPHERE, lobes, &grey) && !large.query(mixture_info));
    CHECK(mixture_info.capacity == 64 && mixture_info.lobes == 1 && mixture_info.diffuse[0] == 0.5f);
}

/// A sky of one radiance, drawn evenly over the sphere; it may throw.
struct Sky {
    bool throws;

    void sample(std::size_t count, const float (*u)[SRBF_LIGHT_BLOCK], srbf_light_rows &rows) const {
        for (std::size_t i = 0; i < count; i++) {
            const float z = 1 - 2 * u[0][i], radius = std::sqrt(1 - z * z), turn = 6.2831853f * u[1][i];
            rows.direction[0][i] = radius * std::cos(turn);
            rows.direction[1][i] = radius * std::sin(turn);
            rows.direction[2][i] = z;
        }
        evaluate(count, rows);
    }
    void evaluate(std::size_t count, srbf_light_rows &rows) const {
        if (throws) throw 1;
        for (std::size_t i = 0; i < count; i++) {
            for (auto &row : rows.radiance) row[i] = 2;
            rows.pdf[i] = 0.0795775f;
        }
    }
};

static void any_light(const srbf::Mixture<16> &matte, const std::array<srbf::Vec3, 3> &frame) {
    const srbf_product_sampling sampling = {8, 0.5f, 4};
    std::array<float, 48> u = {};
    for (std::size_t i = 0; i < u.size(); i++) u[i] = static_cast<float>(i * 29 % 48) / 48;
    const srbf::Span<const float> few = {u.data(), 24};
    srbf_product_sample drawn;
    srbf_light_block block;
    srbf_reflection reflection;
    const Sky sky = {false}, broken = {true};
    const srbf::LightSource light(sky), other(broken);
    CHECK(!light.sample_product(matte, frame, sampling, few, 0.5f, drawn));
    CHECK(drawn.factor[0] > 0 && std::fabs(drawn.factor[0] * 2 / drawn.weight[0] - 1) < 1e-5f);
    CHECK(!light.draw_block(u, block) && block.pdf[0] > 0 && light.draw_block(few, block).code() == SRBF_STATUS_SIZE);
    CHECK(!light.reflect(matte, block, frame, frame[2], few, 0.5f, reflection) && reflection.ray_factor > 0);
    CHECK(light.reflect(matte, block, frame, frame[2], {u.data(), 5}, 0.5f, reflection).code() == SRBF_STATUS_SIZE);
    CHECK(light.sample_product(matte, frame, sampling, u, 0.5f, drawn).code() == SRBF_STATUS_SIZE);
    CHECK(other.sample_product(matte, frame, sampling, few, 0.5f, drawn).code() == SRBF_STATUS_LIGHT);
}

static void light() {
    std::size_t size = 0;
    CHECK(srbf_environment_size(2, 2, &size) == SRBF_STATUS_OK);
    std::vector<unsigned char> memory(size + SRBF_ENVIRONMENT_ALIGNMENT);
    void *place = memory.data();
    std::size_t room = memory.size();
    CHECK(std::align(SRBF_ENVIRONMENT_ALIGNMENT, size, place, room) != nullptr);
    const std::array<float, 12> map = {2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1};
    srbf::Environment environment;
    srbf_environment_info info = {};
    CHECK(!environment && environment.query(info).code() == SRBF_STATUS_NULL);
    CHECK(!environment.make(2, 2, map.data(), 0, place, size) && environment && !environment.query(info) && info.power > 0);
    srbf::Vec3 radiance = {};
    float pdf = 0, density = 0;
    CHECK(!environment.evaluate({0, 0, 1}, &radiance, &pdf) && !environment.evaluate({0, 0, 1}, nullptr, &density) && pdf == density);
    CHECK(!environment.evaluate({0, 0, 1}, &radiance, nullptr) && std::fabs(radiance[1] - 2) < 1e-4f);
    srbf_light_sample drawn;
    CHECK(!environment.sample({0.5f, 0.5f, 0.5f}, drawn) && drawn.pdf > 0);
    srbf::Environment again;
    alignas(SRBF_ENVIRONMENT_ALIGNMENT) std::array<unsigned char, SRBF_ENVIRONMENT_HEAD_SIZE> head;
    CHECK(!again.read(info.table, info.table_size, 0, head.data(), head.size()) && again);

    srbf::Mixture<16> matte;
    const srbf::Vec3 half = {0.5f, 0.5f, 0.5f};
    CHECK(!matte.from_lobes(SRBF_DOMAIN_HEMISPHERE, {}, &half));
    const std::array<srbf::Vec3, 3> frame = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    srbf_light_block block;
    srbf_reflection reflection;
    std::array<float, 48> sixteen = {};
    CHECK(!again.draw_block(sixteen, block) && block.pdf[0] > 0);
    CHECK(again.draw_block({sixteen.data(), 47}, block).code() == SRBF_STATUS_SIZE);
    const srbf_product_sampling sampling = {2, 0.5f, 4};
    const std::array<float, 6> u = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
    srbf_product_sample product;
    CHECK(!again.sample_product(matte, frame, sampling, u, 0.5f, product) && product.weight[0] > 0);
    CHECK(!again.reflect(matte, block, frame, frame[2], u, 0.5f, reflection) && reflection.ray.pdf > 0);
    CHECK(again.reflect(matte, block, frame, frame[2], {u.data(), 5}, 0.5f, reflection).code() == SRBF_STATUS_SIZE);
    CHECK(again.sample_product(matte, frame, sampling, {u.data(), 5}, 0.5f, product).code() == SRBF_STATUS_SIZE);
    any_light(matte, frame);
}

/// Pairs of directions, of the material and of its expanded form: the same within the error of the rows.
static void pairs(const char *path) {
    constexpr std::size_t n = 21;
    srbf::Material material;
    CHECK(!material.load(path));
    std::size_t size = 0;
    CHECK(srbf_expanded_size(material.get(), SRBF_EXPANDED_DEFAULT_ROWS, &size) == SRBF_STATUS_OK);
    std::vector<unsigned char> memory(size + SRBF_EXPANDED_ALIGNMENT);
    void *place = memory.data();
    std::size_t room = memory.size();
    CHECK(std::align(SRBF_EXPANDED_ALIGNMENT, size, place, room) != nullptr);
    srbf::Expanded expanded;
    srbf::Mixture<16> mixture;
    CHECK(!expanded && expanded.prepare({0, 0, 1}, mixture).code() == SRBF_STATUS_NULL);
    CHECK(expanded.make(material.get(), 1, place, size).code() == SRBF_STATUS_ARGUMENT && !expanded);
    CHECK(!expanded.make(material.get(), SRBF_EXPANDED_DEFAULT_ROWS, place, size) && expanded);

    std::vector<srbf::Vec3> wo(n), u(n), wi(n, srbf::Vec3{0.36f, 0.48f, 0.8f}), exact(n), near(n), towards(n), drawn(n);
    std::vector<float> exact_pdf(n), near_pdf(n), pdf(n);
    std::vector<srbf_sample> samples(n), again(n);
    for (std::size_t k = 0; k < n; k++) {
        const float angle = 1.5f * static_cast<float>(k) / n;
        wo[k] = {-std::sin(angle), 0, std::cos(angle)};
        u[k] = {0.3f, 0.6f, 0.9f};
    }
    using srbf::Request;
    CHECK(!material.ask(Request().wo(wo).wi(wi).value(exact).pdf(exact_pdf)));
    CHECK(!expanded.ask(Request().wo(wo).wi(wi).value(near).pdf(near_pdf)));
    for (std::size_t k = 0; k < n; k++) {
        CHECK(exact[k][0] > 0 && std::fabs(near[k][0] - exact[k][0]) <= 2e-3f * exact[k][0]);
        CHECK(exact_pdf[k] > 0 && std::fabs(near_pdf[k] - exact_pdf[k]) <= 2e-3f * exact_pdf[k]);
    }
    CHECK(!expanded.ask(Request().wo(wo).wi(wi).value(towards)) && towards == near);
    CHECK(!expanded.ask(Request().wo(wo).wi(wi).pdf(pdf)) && std::fabs(pdf[n - 1] - near_pdf[n - 1]) <= 1e-5f * pdf[n - 1]);
    CHECK(!expanded.ask(Request().wo(wo).u(u).samples(samples)) && samples[n - 1].pdf > 0);
    CHECK(!expanded.ask(Request().wo(wo).u(u).directions(drawn, pdf)) && drawn[n - 1][2] == samples[n - 1].direction[2]);
    CHECK(!expanded.ask(Request().wo(wo).u(u).samples(again).wi(wi).value(towards).pdf(pdf)));
    CHECK(again[3].direction[0] == samples[3].direction[0] && std::fabs(pdf[3] - near_pdf[3]) <= 1e-5f * pdf[3]);
    CHECK(!material.ask(Request().wo(wo).wi(wi).value(towards)) && towards == exact);
    CHECK(!material.ask(Request().wo(wo).u(u).samples(again)) && !material.ask(Request().wo(wo).u(u).directions(drawn, pdf)));
    CHECK(drawn[5][0] == again[5].direction[0] && !material.ask(Request().wo(wo).wi(drawn).pdf(near_pdf)) && near_pdf[5] > 0);
    CHECK(!material.ask(Request().wo(wo).u(u).samples(samples).wi(wi).value(towards).pdf(pdf)) && samples[5].pdf > 0);
    /* Hit by hit, and with a material of each. */
    srbf_sample one;
    srbf::Vec3 value, alone;
    float density, same;
    CHECK(!material.sample_and_evaluate(wo[5], u[5], one, wi[5], value, density));
    CHECK(std::fabs(value[0] - towards[5][0]) <= 1e-5f * value[0] && std::fabs(density - pdf[5]) <= 1e-5f * density);
    CHECK(!material.sample(wo[5], u[5], samples[0]) && samples[0].pdf == one.pdf);
    CHECK(!material.evaluate_and_pdf(wo[5], wi[5], alone, same) && alone == value && same == density);
    CHECK(!material.evaluate(wo[5], wi[5], alone) && alone == value && !material.pdf(wo[5], wi[5], same) && same == density);
    const std::vector<const srbf_material *> each(n, material.get());
    CHECK(!srbf::ask_each(Request().materials(each).wo(wo).wi(wi).pdf(near_pdf)) && near_pdf == pdf);
    CHECK(!expanded.prepare(wo[7], mixture) && !mixture.pdf(wi[7], pdf[0]));
    CHECK(std::fabs(pdf[0] - exact_pdf[7]) <= 2e-3f * pdf[0]);

    srbf_spectrum spectrum;
    srbf::Primaries<4> primaries;
    std::array<float, 4> values, halves;
    CHECK(!material.spectrum(spectrum) && spectrum.first <= spectrum.last);
    CHECK(!material.primaries(std::array<float, 4>{420, 500, 580, 660}, primaries) && !primaries.of({2, 2, 2}, values));
    CHECK(!primaries.of({1, 1, 1}, halves));
    // A material without a map of its own has primaries that are 1 together.
    for (size_t i = 0; i < 4; i++) CHECK(2 * halves[i] == values[i] && (spectrum.wavelengths || std::fabs(values[i] - 2) < 1e-5f));

    const srbf::Span<srbf::Vec3> short_of_one(exact.data(), n - 1);
    CHECK(expanded.ask(Request().wo(wo).wi(wi).value(short_of_one)).code() == SRBF_STATUS_SIZE);
    CHECK(material.ask(Request().wo(wo).u(u).samples({samples.data(), n - 1})).code() == SRBF_STATUS_SIZE);
    CHECK(material.ask(Request().wo(wo).wi(wi).pdf({nullptr, n})).code() == SRBF_STATUS_NULL);
    CHECK(srbf::Material().ask(Request().wo(wo).wi(wi).pdf(pdf)).code() == SRBF_STATUS_NULL);
}

static void sheets(const char *material, const char *path) {
    srbf::Sheet sheet;
    srbf::Vec3 value{}, other{};
    float pdf = 0;
    srbf_sample sample;
    const srbf::Vec3 wo{0.6f, 0, -0.8f}, u{0.9f, 0.3f, 0.6f};
    CHECK(sheet.sample(wo, u, sample).code() == SRBF_STATUS_NULL);
    CHECK(sheet.load(material).code() == SRBF_STATUS_FIELD && !sheet);
    CHECK(!sheet.load(path) && sheet);
    srbf::Sheet moved(std::move(sheet));
    srbf_sheet_info info;
    CHECK(!moved.query(info) && info.lobes > 0);
    CHECK(!moved.sample(wo, u, sample) && sample.pdf > 0);
    CHECK(!moved.evaluate_and_pdf(wo, {sample.direction[0], sample.direction[1], sample.direction[2]}, value, pdf) && pdf > 0);
    CHECK(!moved.albedos(wo, value, other) && other[1] > 0);
    std::array<srbf::Vec3, 4> views{wo, wo, wo, wo}, numbers{u, u, u, u};
    std::array<srbf_sample, 4> samples{};
    CHECK(!moved.ask(srbf::Request().wo(views).u(numbers).samples(samples)));
    CHECK(std::fabs(samples[3].pdf / sample.pdf - 1) < 1e-3f);
}

static void blends(const char *path) {
    srbf::Material material, other;
    CHECK(!material.load(path) && !other.load(path));
    std::array<srbf_blend_part, 4> parts{srbf::blend::part(material, 0.7f), srbf::blend::part(other, 0.3f), srbf::blend::part(material, 0.1f),
                                         srbf::blend::part(other, 0.2f)};
    const srbf::Vec3 wo{0.6f, 0, 0.8f}, wi{0, 0, 1}, u{0.9f, 0.3f, 0.6f};
    srbf::Vec3 value{}, alone{}, albedo{};
    float pdf = 0, density = 0, left = 0;
    srbf_sample sample{}, same{};
    /* Of one material twice, so that the sum is known. */
    const srbf::Span<const srbf_blend_part> two(parts.data(), 2);
    CHECK(!srbf::blend::evaluate_and_pdf(two, wo, wi, value, pdf) && !material.evaluate_and_pdf(wo, wi, alone, density));
    CHECK(std::fabs(value[1] - alone[1]) <= 1e-4f * alone[1] && std::fabs(pdf - density) <= 1e-4f * density);
    CHECK(!srbf::blend::sample(two, wo, u, sample) && !srbf::blend::sample_and_evaluate(two, wo, u, same, wi, value, pdf));
    CHECK(sample.pdf == same.pdf && !srbf::blend::albedo(two, wo, albedo) && albedo[0] > 0);
    srbf_blend_part chosen;
    CHECK(!srbf::blend::choose(two, 0.9f, chosen, left) && chosen.material == other.get() && left > 0.6f && left < 0.7f);
    const std::array<srbf::Vec3, 2> views{wo, wo}, lights{wi, wi};
    std::array<float, 2> densities{};
    CHECK(!srbf::blend::ask(two, srbf::Request().wo(views).wi(lights).pdf(densities)) && std::fabs(densities[1] - pdf) <= 1e-4f * pdf);
    CHECK(!srbf::blend::ask_each(parts, 2, srbf::Request().wo(views).wi(lights).pdf(densities)) && densities[1] > 0);
    CHECK(srbf::blend::ask_each(parts, 3, srbf::Request().wo(views).wi(lights).pdf(densities)).code() == SRBF_STATUS_SIZE);
    CHECK(srbf::blend::sample({}, wo, u, sample).code() == SRBF_STATUS_ARGUMENT);
}

int main(int count, char **arguments) {
    CHECK(count == 3);
    use(arguments[1]);
    pairs(arguments[1]);
    light();
    sheets(arguments[1], arguments[2]);
    blends(arguments[1]);
    std::printf("wrapper: passed\n");
    return 0;
}
