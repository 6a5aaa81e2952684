/* Every function in normal use: the calls agree with each other and write nothing beside their outputs.
 *
 *     normal MATERIAL.srbf
 */
#include "check.h"

/* Of the midpoint rule. */
enum { ROWS = MANY(200) };

static srbf_vectors in(const float *first, size_t step, size_t stride) {
    srbf_vectors v = {first, first + step, first + 2 * step, stride};
    return v;
}

static srbf_vectors_out out(float *first, size_t step, size_t stride) {
    srbf_vectors_out v = {first, first + step, first + 2 * step, stride};
    return v;
}

static const float WO[3] = {0.6f, 0.0f, 0.8f};

static int is_near(float a, float b) {
    float difference = fabsf(a - b);
    return difference <= 2e-5f * fmaxf(fabsf(a), fabsf(b)) || difference <= 1e-7f;
}

static int are_near(const float a[3], const float b[3]) {
    return is_near(a[0], b[0]) && is_near(a[1], b[1]) && is_near(a[2], b[2]);
}

static float luminance(const float rgb[3]) {
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

static srbf_mixture *new_mixture(size_t size) {
    void *storage = aligned_alloc(SRBF_MIXTURE_ALIGNMENT, size);
    srbf_mixture *mixture = NULL;
    CHECK(storage != NULL);
    CHECK_OK(srbf_mixture_init(storage, size, &mixture));
    CHECK((void *)mixture == storage);
    return mixture;
}

/* Three ways to a material, which say the same. */
static void test_materials(const char *path) {
    size_t size;
    unsigned char *bytes = read_file(path, &size);
    _Alignas(SRBF_MATERIAL_ALIGNMENT) unsigned char storage[SRBF_MATERIAL_SIZE];
    srbf_material *material[3];
    CHECK_OK(srbf_material_borrow(bytes, size, storage, sizeof storage, &material[0]));
    CHECK_OK(srbf_material_from_bytes(bytes, size, &material[1]));
    CHECK_OK(srbf_material_load(path, &material[2]));

    for (int m = 0; m < 3; m++) {
        srbf_material_info info;
        CHECK_OK(srbf_material_query(material[m], &info));
        CHECK(info.views == 8 && info.lobes == 12 && info.squeezed_lobes == 5 && info.mirrored_lobes == 1);
        CHECK(info.byte_count == size && memcmp(info.bytes, bytes, size) == 0);
        CHECK((info.bytes == bytes) == (m == 0));
        CHECK(info.provenance_length == 13 && memcmp(info.provenance, "made by tests", 13) == 0);
        for (size_t v = 0; v < info.views; v++) {
            srbf_view view;
            CHECK_OK(srbf_material_view(material[m], v, &view));
            CHECK(is_near(view.theta, 0.2f * (float)v) && view.log2_squeeze <= 0);
            for (size_t k = 0; k < info.lobes - info.mirrored_lobes; k++) {
                srbf_plane_lobe lobe;
                CHECK_OK(srbf_material_view_lobe(material[m], v, k, &lobe));
                CHECK((lobe.off_plane == 0) == (v == 0 || k < 10));
                CHECK(fabsf(lobe.angle) < 3.2f && lobe.log2_sharpness > 0 && lobe.log2_luminance < 10);
                CHECK(lobe.color_differences[0] == -0.1f && lobe.color_differences[1] == -0.3f);
            }
        }
        float albedo[3];
        CHECK_OK(srbf_material_albedo(material[m], WO, albedo));
        CHECK(albedo[0] > 0 && albedo[0] < 1 && albedo[1] > 0 && albedo[2] > 0);
    }
    /* Bytes of any alignment. */
    unsigned char *shifted = (unsigned char *)malloc(size + 1);
    CHECK(shifted != NULL);
    memcpy(shifted + 1, bytes, size);
    CHECK_OK(srbf_material_borrow(shifted + 1, size, storage, sizeof storage, &material[0]));
    float albedo[3], again[3];
    CHECK_OK(srbf_material_albedo(material[0], WO, albedo));
    CHECK_OK(srbf_material_albedo(material[1], WO, again));
    CHECK(memcmp(albedo, again, sizeof albedo) == 0);

    /* A borrowed material is released to no effect but that it is none any more. */
    CHECK_OK(srbf_material_free(material[0]));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_material_free(material[0]));
    CHECK_OK(srbf_material_free(material[1]));
    CHECK_OK(srbf_material_free(material[2]));
    CHECK_OK(srbf_material_free(NULL));
    free(shifted);
    free(bytes);
}

/* One direction at a time: value, f, density and samples fit each other, in storage of every size. */
static void test_single(const srbf_material *material) {
    const size_t sizes[3] = {SRBF_MIXTURE_SIZE_16, SRBF_MIXTURE_SIZE_32, SRBF_MIXTURE_SIZE_64};
    const size_t capacities[3] = {16, 32, 64};
    CHECK(srbf_mixture_size(0) == sizes[0] && srbf_mixture_size(16) == sizes[0]);
    CHECK(srbf_mixture_size(17) == sizes[1] && srbf_mixture_size(33) == sizes[2]);
    CHECK(srbf_mixture_size(64) == sizes[2] && srbf_mixture_size(65) == 0);
    for (int s = 0; s < 3; s++) {
        srbf_mixture *mixture = new_mixture(sizes[s]);
        srbf_mixture_info info;
        CHECK_OK(srbf_mixture_query(mixture, &info));
        CHECK(info.lobes == 0 && info.capacity == capacities[s] && info.power == 0);
        CHECK_OK(srbf_material_prepare(material, WO, mixture));
        CHECK_OK(srbf_mixture_query(mixture, &info));
        CHECK(info.lobes == 12 && info.squeezed_lobes == 5 && info.domain == SRBF_DOMAIN_HEMISPHERE);
        CHECK(info.simd_level == srbf_simd_level() && info.squeeze < 1);
        srbf_mixture_info left;
        /* Of twelve lobes, one at least has less than a ninth of the power. */
        CHECK_OK(srbf_material_prepare_leaving_out(material, WO, 0.09f, 1e-3f, mixture));
        CHECK_OK(srbf_mixture_query(mixture, &left));
        CHECK(left.lobes < info.lobes && left.power < info.power);
        CHECK(info.power - left.power <= 0.0901f * (float)(info.lobes - left.lobes) * info.power);
        CHECK_OK(srbf_material_prepare_leaving_out(material, WO, 0, 1e-7f, mixture));
        CHECK_OK(srbf_mixture_query(mixture, &left));
        CHECK(left.lobes == info.lobes && left.power == info.power);
        float albedo[3];
        CHECK_OK(srbf_material_albedo(material, WO, albedo));
        CHECK(are_near(info.albedo, albedo) && is_near(info.power, luminance(albedo)));

        uint64_t state = 7;
        for (int i = 0; i < MANY(2000); i++) {
            float wi[3], *value = guarded(3), *pdf = guarded(1), *both = guarded(4);
            direction(&state, wi);
            CHECK_OK(srbf_mixture_evaluate(mixture, wi, value));
            CHECK_OK(srbf_mixture_pdf(mixture, wi, pdf));
            CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, wi, both, both + 3));
            CHECK(are_near(value, both));
            CHECK(is_near(*pdf, both[3]));
            CHECK(is_near(*pdf * info.power, luminance(value)));
            wi[2] = -wi[2];
            CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, wi, both, both + 3));
            CHECK(both[0] == 0 && both[3] == 0);
            release(value, 3), release(pdf, 1), release(both, 4);

            float u[3] = {uniform(&state), uniform(&state), uniform(&state)};
            float *memory = guarded(sizeof(srbf_sample) / sizeof(float));
            srbf_sample *sample = (srbf_sample *)(void *)memory;
            CHECK_OK(srbf_mixture_sample(mixture, u, sample));
            CHECK(sample->pdf > 0 && sample->direction[2] >= 0);
            CHECK(is_near(luminance(sample->weight), info.power));
            float at[3], density;
            CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, sample->direction, at, &density));
            CHECK(fabsf(density - sample->pdf) <= 1e-3f * density);
            /* A batch of one, without the weight. */
            float *drawn = guarded(3), *drawn_pdf = guarded(1);
            CHECK_OK(srbf_mixture_ask(mixture, 0, 1, ASK(.u = in(u, 1, 12), .samples.direction = out(drawn, 1, 12), .samples.pdf = {drawn_pdf, 4})));
            CHECK(fabsf(drawn[0] - sample->direction[0]) < 1e-5f && fabsf(drawn[2] - sample->direction[2]) < 1e-5f);
            CHECK(fabsf(*drawn_pdf - sample->pdf) <= 1e-3f * density);
            release(drawn, 3), release(drawn_pdf, 1);
            release(memory, sizeof(srbf_sample) / sizeof(float));
        }

        /* The density integrates to 1 over the hemisphere: midpoint rule. */
        double sum = 0;
        for (int i = 0; i < ROWS; i++) {
            for (int j = 0; j < 800; j++) {
                float z = ((float)i + 0.5f) / ROWS, phi = ((float)j + 0.5f) / 800 * 6.2831853f;
                float r = sqrtf(1 - z * z), wi[3] = {r * cosf(phi), r * sinf(phi), z}, pdf;
                CHECK_OK(srbf_mixture_pdf(mixture, wi, &pdf));
                sum += (double)pdf;
            }
        }
        CHECK_MEAN(fabs(sum * 6.283185307 / (ROWS * 800) - 1) < 1e-3);

        /* Towards a viewer below the horizon nothing is reflected: no lobes, and no sample. */
        const float below[3] = {0.6f, 0, -0.8f}, u[3] = {0.5f, 0.5f, 0.5f};
        CHECK_OK(srbf_material_prepare(material, below, mixture));
        srbf_sample sample;
        CHECK_OK(srbf_mixture_sample(mixture, u, &sample));
        CHECK(sample.pdf == 0 && sample.weight[0] == 0 && sample.direction[2] == 1);
        float none[4];
        CHECK_OK(srbf_mixture_ask(mixture, 0, 1, ASK(.u = in(u, 1, 12), .samples.direction = out(none, 1, 12), .samples.pdf = {none + 3, 4})));
        CHECK(none[2] == 1 && none[3] == 0);
        CHECK_OK(srbf_material_albedo(material, below, albedo));
        CHECK(albedo[0] == 0 && albedo[1] == 0 && albedo[2] == 0);
        free(mixture);
    }
}

/* A renderer's ray: everything of one direction in one structure. */
typedef struct ray {
    float u[3], wi[3], pdf, value[3], weight[3], other;
} ray;

/* Batches of every count up to beyond two blocks, as structure of arrays and as array of structures. */
static void test_batches(const srbf_material *material) {
    srbf_mixture *mixture = new_mixture(SRBF_MIXTURE_SIZE_16);
    CHECK_OK(srbf_material_prepare(material, WO, mixture));
    uint64_t state = 11;
    for (size_t n = 0; n <= 150; n = n < 70 ? n + 1 : n + 29) {
        size_t size = n > 0 ? n : 1;
        float *wi = guarded(3 * size), *u = guarded(3 * size), *value = guarded(3 * size);
        float *pdf = guarded(size), *drawn = guarded(7 * size);
        ray *rays = (ray *)calloc(size, sizeof(ray));
        CHECK(rays != NULL);
        for (size_t i = 0; i < n; i++) {
            direction(&state, rays[i].wi);
            rays[i].other = 42;
            for (size_t c = 0; c < 3; c++) {
                wi[c * n + i] = rays[i].wi[c];
                rays[i].u[c] = u[c * n + i] = uniform(&state);
            }
        }
        const size_t dense = sizeof(float), wide = sizeof(ray);
        srbf_vectors wi_in = in(wi, n, dense), u_in = in(u, n, dense);
        srbf_vectors_out value_out = out(value, n, dense);
        srbf_numbers_out pdf_out = {pdf, dense};
        srbf_samples_out samples_out = {out(drawn, n, dense), {drawn + 3 * n, dense}, out(drawn + 4 * n, n, dense)};
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.wi = wi_in, .value = value_out)));
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.wi = wi_in, .pdf = pdf_out)));
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.u = u_in, .samples = samples_out)));

        srbf_vectors ray_wi = in(rays->wi, 1, wide), ray_u = in(rays->u, 1, wide);
        srbf_vectors_out ray_value = out(rays->value, 1, wide);
        srbf_numbers_out ray_pdf = {&rays->pdf, wide};
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.wi = ray_wi, .value = ray_value)));
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.wi = ray_wi, .pdf = ray_pdf)));
        for (size_t i = 0; i < n; i++) {
            float one[3], density;
            CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, rays[i].wi, one, &density));
            float many[3] = {value[i], value[n + i], value[2 * n + i]};
            CHECK(are_near(one, many) && is_near(density, pdf[i]));
            /* Another block length may change the last bit, not more. */
            CHECK(are_near(many, rays[i].value) && is_near(rays[i].pdf, pdf[i]) && rays[i].other == 42);
        }
        /* The same directions and densities without the weights. */
        float *alone = guarded(4 * size);
        srbf_vectors_out alone_out = out(alone, n, dense);
        srbf_numbers_out alone_pdf = {alone + 3 * n, dense};
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.u = u_in, .samples.direction = alone_out, .samples.pdf = alone_pdf)));
        for (size_t i = 0; i < n; i++) {
            for (size_t c = 0; c < 3; c++) CHECK(fabsf(alone[c * n + i] - drawn[c * n + i]) < 1e-6f);
            CHECK(is_near(alone[3 * n + i], drawn[3 * n + i]));
        }
        srbf_samples_out ray_samples = {out(rays->wi, 1, wide), ray_pdf, out(rays->weight, 1, wide)};
        CHECK_OK(srbf_mixture_ask(mixture, 0, n, ASK(.u = ray_u, .samples = ray_samples)));
        for (size_t i = 0; i < n; i++) {
            srbf_sample one;
            CHECK_OK(srbf_mixture_sample(mixture, rays[i].u, &one));
            for (size_t c = 0; c < 3; c++) {
                CHECK(fabsf(drawn[c * n + i] - one.direction[c]) < 1e-5f);
                CHECK(fabsf(rays[i].wi[c] - one.direction[c]) < 1e-5f);
                CHECK(fabsf(drawn[(4 + c) * n + i] - one.weight[c]) <= 1e-3f * one.weight[c]);
                CHECK(fabsf(rays[i].weight[c] - one.weight[c]) <= 1e-3f * one.weight[c]);
            }
            CHECK(fabsf(drawn[3 * n + i] - one.pdf) <= 1e-3f * one.pdf);
            CHECK(rays[i].other == 42);
        }
        if (n == 0) {
            CHECK(is_untouched(value, 0) && is_untouched(pdf, 0) && is_untouched(drawn, 0) && is_untouched(alone, 0));
        }
        release(wi, 3 * size), release(u, 3 * size), release(value, 3 * size);
        release(pdf, size), release(drawn, 7 * size), release(alone, 4 * size), free(rays);
    }
    free(mixture);
}

/* Pairs, each with its own mixture, made in one call: the same as one at a time. */
static void test_pairs(const srbf_material *material) {
    enum { N = 130 };
    const size_t stride = SRBF_MIXTURE_SIZE_16 + 64;
    unsigned char *storage = (unsigned char *)aligned_alloc(64, N * stride);
    srbf_mixture *mixture = new_mixture(SRBF_MIXTURE_SIZE_16);
    ray rays[N] = {0};
    float wo[N][3];
    uint64_t state = 13;
    CHECK(storage != NULL);
    memset(storage, 0xcd, N * stride);
    for (int i = 0; i < N; i++) {
        direction(&state, wo[i]);
        direction(&state, rays[i].wi);
        for (int c = 0; c < 3; c++) {
            rays[i].u[c] = uniform(&state);
        }
    }
    srbf_vectors wo_in = in(wo[0], 1, sizeof wo[0]), wi = in(rays->wi, 1, sizeof(ray)), u = in(rays->u, 1, sizeof(ray));
    srbf_vectors_out value = out(rays->value, 1, sizeof(ray));
    srbf_numbers_out pdf = {&rays->pdf, sizeof(ray)};
    const srbf_mixture *mixtures = (const srbf_mixture *)(const void *)storage;
    CHECK_OK(srbf_material_prepare_into(material, N, &wo_in, storage, stride));
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.wi = wi, .value = value)));
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.wi = wi, .pdf = pdf)));
    for (int i = 0; i < N; i++) {
        float one[3], density;
        CHECK_OK(srbf_material_prepare(material, wo[i], mixture));
        CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, rays[i].wi, one, &density));
        CHECK(are_near(one, rays[i].value) && is_near(density, rays[i].pdf));
        for (size_t b = SRBF_MIXTURE_SIZE_16; b < stride; b++) {
            CHECK(storage[(size_t)i * stride + b] == 0xcd);
        }
    }
    for (int i = 0; i < N; i++) {
        rays[i].other = rays[i].pdf, rays[i].pdf = rays[i].value[1] = -1;
    }
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo_in, .wi = wi, .value = value, .pdf = pdf)));
    for (int i = 0; i < N; i++) {
        CHECK(is_near(rays[i].pdf, rays[i].other) && rays[i].value[1] >= 0);
        rays[i].pdf = -1;
    }
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo_in, .wi = wi, .pdf = pdf)));
    for (int i = 0; i < N; i++) {
        CHECK(is_near(rays[i].pdf, rays[i].other));
        rays[i].pdf = -1;
    }
    srbf_samples_out samples = {out(rays->wi, 1, sizeof(ray)), pdf, out(rays->weight, 1, sizeof(ray))};
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo_in, .u = u, .samples.direction = samples.direction, .samples.pdf = pdf)));
    for (int i = 0; i < N; i++) {
        memcpy(rays[i].value, rays[i].wi, sizeof rays[i].wi);
        rays[i].other = rays[i].pdf;
    }
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo_in, .u = u, .samples = samples)));
    for (int i = 0; i < N; i++) {
        CHECK(are_near(rays[i].value, rays[i].wi) && is_near(rays[i].pdf, rays[i].other));
    }
    for (int i = 0; i < N; i++) {
        rays[i].other = rays[i].pdf, rays[i].pdf = -1;
    }
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.u = u, .samples = samples)));
    for (int i = 0; i < N; i++) {
        srbf_sample one;
        CHECK_OK(srbf_material_prepare(material, wo[i], mixture));
        CHECK_OK(srbf_mixture_sample(mixture, rays[i].u, &one));
        CHECK(fabsf(one.direction[0] - rays[i].wi[0]) < 1e-5f && fabsf(one.direction[2] - rays[i].wi[2]) < 1e-5f);
        CHECK(fabsf(one.pdf - rays[i].pdf) <= 1e-3f * one.pdf && is_near(rays[i].pdf, rays[i].other));
        CHECK(fabsf(one.weight[1] - rays[i].weight[1]) <= 1e-3f * one.weight[1]);
    }
    free(mixture);
    free(storage);
}

/* A lobe by its formula. */
static void lobe_value(const srbf_lobe *lobe, const float d[3], float value[3]) {
    const double cosine = (double)d[0] * (double)lobe->axis[0] + (double)d[1] * (double)lobe->axis[1] + (double)d[2] * (double)lobe->axis[2];
    for (int c = 0; c < 3; c++) value[c] = lobe->amplitude[c] * (float)exp((double)lobe->sharpness * (cosine - 1));
}

static void lobe_integral(const srbf_lobe *lobe, float integral[3]) {
    const double s = (double)lobe->sharpness, whole = s > 0 ? 6.283185307 * (1 - exp(-2 * s)) / s : 12.56637061;
    for (int c = 0; c < 3; c++) integral[c] = lobe->amplitude[c] * (float)whole;
}

/* Lobes and mixtures without a material. */
static void test_lobes(void) {
    const srbf_lobe lobes[3] = {
        {{0, 0, 1}, 2, {0.2f, 0.3f, 0.4f}},
        {{0.6f, 0, 0.8f}, 100, {1, 2, 0.5f}},
        {{0, 0.8f, 0.6f}, 0, {0.01f, 0.02f, 0.03f}},
    };
    float total[3] = {0, 0, 0};
    uint64_t state = 17;
    srbf_mixture *ones[3];
    for (int k = 0; k < 3; k++) {
        /* A lobe alone is a mixture of one, over the whole sphere. */
        const srbf_lobe *one = &lobes[k];
        float *value = guarded(3), integral[3], *pdf = guarded(1), expected[3];
        srbf_mixture_info whole;
        ones[k] = new_mixture(SRBF_MIXTURE_SIZE_16);
        CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_SPHERE, 1, 0, 1, one, NULL, ones[k]));
        CHECK_OK(srbf_mixture_evaluate(ones[k], one->axis, value));
        CHECK(are_near(value, one->amplitude));
        CHECK_OK(srbf_mixture_query(ones[k], &whole));
        lobe_integral(one, integral);
        CHECK(are_near(integral, whole.albedo));
        for (int c = 0; c < 3; c++) {
            total[c] += integral[c];
        }
        for (int i = 0; i < 1000; i++) {
            const float u[3] = {uniform(&state), uniform(&state), uniform(&state)};
            srbf_sample sample;
            CHECK_OK(srbf_mixture_sample(ones[k], u, &sample));
            const float *d = sample.direction;
            CHECK(fabsf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-5f);
            CHECK_OK(srbf_mixture_evaluate_and_pdf(ones[k], d, value, pdf));
            lobe_value(one, d, expected);
            CHECK(fabsf(expected[1] - value[1]) <= 1e-3f * value[1]);
            CHECK(is_near(*pdf * integral[1], value[1]));
        }
        release(value, 3), release(pdf, 1);
    }

    srbf_mixture *mixture = new_mixture(SRBF_MIXTURE_SIZE_32);
    srbf_mixture_info info;
    srbf_lobe lobe;
    for (uint32_t domain = SRBF_DOMAIN_SPHERE; domain <= SRBF_DOMAIN_HEMISPHERE; domain++) {
        CHECK_OK(srbf_mixture_from_lobes(domain, 1, 0, 3, lobes, NULL, mixture));
        CHECK_OK(srbf_mixture_query(mixture, &info));
        CHECK(info.domain == domain && info.lobes == 3 && info.squeezed_lobes == 0 && info.squeeze == 1);
        CHECK(are_near(info.albedo, total));
        const float d[3] = {0.36f, -0.48f, -0.8f};
        float sum[3] = {0, 0, 0}, value[3];
        for (int k = 0; k < 3; k++) {
            lobe_value(&lobes[k], d, value);
            for (int c = 0; c < 3; c++) {
                sum[c] += domain == SRBF_DOMAIN_SPHERE ? value[c] : 0;
            }
            CHECK_OK(srbf_mixture_lobe(mixture, (size_t)k, &lobe));
            CHECK(memcmp(&lobe, &lobes[k], sizeof lobe) == 0);
        }
        CHECK_OK(srbf_mixture_evaluate(mixture, d, value));
        CHECK(are_near(sum, value));
    }
    /* Products: at a direction, and integrated, against each other and against quadrature. */
    srbf_lobe products[36];
    const float d[3] = {0.48f, 0.36f, 0.8f};
    float x[3], y[3], z[3], sum[3] = {0, 0, 0}, integral[3];
    size_t n = 0;
    CHECK_OK(srbf_mixture_product(ones[0], ones[1], 1, &lobe, &n));
    lobe_value(&lobes[0], d, x), lobe_value(&lobes[1], d, y), lobe_value(&lobe, d, z);
    for (int c = 0; c < 3; c++) {
        CHECK(n == 1 && fabsf(x[c] * y[c] - z[c]) <= 1e-4f * z[c]);
    }
    CHECK_OK(srbf_mixture_inner_product(ones[0], ones[1], x));
    lobe_integral(&lobe, y);
    CHECK(are_near(x, y));
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_SPHERE, 1, 0, 3, lobes, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_mixture_product(mixture, mixture, 0, NULL, &n));
    CHECK(n == 9);
    CHECK_OK(srbf_mixture_product(mixture, mixture, 36, products, &n));
    CHECK_OK(srbf_mixture_inner_product(mixture, mixture, integral));
    for (size_t k = 0; k < n; k++) {
        lobe_integral(&products[k], x);
        for (int c = 0; c < 3; c++) {
            sum[c] += x[c];
        }
    }
    CHECK(are_near(sum, integral));
    for (uint32_t domain = SRBF_DOMAIN_SPHERE; domain <= SRBF_DOMAIN_HEMISPHERE; domain++) {
        double quadrature = 0;
        const int low = domain == SRBF_DOMAIN_SPHERE ? -ROWS : 0;
        CHECK_OK(srbf_mixture_from_lobes(domain, 1, 0, 3, lobes, NULL, mixture));
        CHECK_OK(srbf_mixture_inner_product(mixture, ones[1], integral));
        for (int i = low; i < ROWS; i++) {
            for (int j = 0; j < 800; j++) {
                float h = ((float)i + 0.5f) / ROWS, phi = ((float)j + 0.5f) / 800 * 6.2831853f;
                float r = sqrtf(1 - h * h), at[3] = {r * cosf(phi), r * sinf(phi), h};
                CHECK_OK(srbf_mixture_evaluate(mixture, at, x));
                lobe_value(&lobes[1], at, y);
                quadrature += (double)(x[1] * y[1]);
            }
        }
        CHECK_MEAN(fabs(quadrature * 6.283185307 / (ROWS * 800) / (double)integral[1] - 1) < 1e-3);
    }
    /* Squeezed lobes keep their integral. */
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 0.5f, 2, 3, lobes, NULL, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &info));
    CHECK(info.squeeze == 0.5f && info.squeezed_lobes == 2 && are_near(info.albedo, total));
    /* A diffuse term beside them, and alone: the cosine. */
    const float grey[3] = {0.5f, 0.25f, 0.125f};
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 3, lobes, grey, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &info));
    CHECK(are_near(info.diffuse, grey) && is_near(info.albedo[1], total[1] + 0.25f));
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 0, NULL, grey, mixture));
    CHECK_OK(srbf_mixture_evaluate(mixture, d, x));
    CHECK(is_near(x[0], 0.5f * d[2] / 3.14159265f));
    /* No lobes: an empty mixture. */
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_SPHERE, 1, 0, 0, NULL, NULL, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &info));
    CHECK(info.lobes == 0 && info.power == 0);
    for (int k = 0; k < 3; k++) free(ones[k]);
    free(mixture);
}

/* Every level that the processor has gives the same values. */
static void test_levels(const srbf_material *material) {
    srbf_mixture *mixture = new_mixture(SRBF_MIXTURE_SIZE_16);
    uint32_t best = srbf_simd_level();
    float expected[3] = {0, 0, 0}, value[3];
    const float wi[3] = {-0.48f, 0.36f, 0.8f};
    CHECK(best >= SRBF_SIMD_SCALAR && best <= SRBF_SIMD_AVX512);
    for (uint32_t level = SRBF_SIMD_SCALAR; level <= SRBF_SIMD_AVX512; level++) {
        srbf_status status = srbf_simd_set_level(level);
        CHECK(level <= best ? status == SRBF_STATUS_OK : status == SRBF_STATUS_SIMD_LEVEL);
        if (status != SRBF_STATUS_OK) {
            continue;
        }
        CHECK(srbf_simd_level() == level);
        CHECK_OK(srbf_material_prepare(material, WO, mixture));
        CHECK_OK(srbf_mixture_evaluate(mixture, wi, value));
        if (level == SRBF_SIMD_SCALAR) {
            memcpy(expected, value, sizeof value);
        }
        CHECK(are_near(expected, value));
    }
    CHECK_OK(srbf_simd_set_level(SRBF_SIMD_AUTOMATIC));
    CHECK(srbf_simd_level() == best);
    CHECK_STATUS(SRBF_STATUS_SIMD_LEVEL, srbf_simd_set_level(99));
    free(mixture);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    CHECK(srbf_version() == SRBF_VERSION);
    CHECK(strcmp(srbf_status_text(SRBF_STATUS_OK), "success") == 0 && strlen(srbf_status_text(-1)) > 0);
    CHECK(strcmp(srbf_last_message(), "") == 0);
    test_materials(arguments[1]);
    srbf_material *material;
    CHECK_OK(srbf_material_load(arguments[1], &material));
    test_single(material);
    test_batches(material);
    test_pairs(material);
    test_levels(material);
    CHECK_OK(srbf_material_free(material));
    test_lobes();
    printf("normal use: passed\n");
    return 0;
}
