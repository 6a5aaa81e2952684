/* Blends through the header: refused, asked one hit at a time and many together, of materials and of mixtures, one chosen at random.
 *
 *     blend MATERIAL.srbf OTHER.srbf
 */
#include "check.h"

enum { N = 150, PARTS = 3 };

static const float UP[3] = {0, 0, 1}, TILTED[3] = {0.6f, 0, 0.8f}, U[3] = {0.3f, 0.6f, 0.9f};

static void test_refused(const srbf_material *material) {
    srbf_blend_part parts[SRBF_MAX_BLEND + 1], chosen;
    for (int k = 0; k <= SRBF_MAX_BLEND; k++) {
        parts[k] = (srbf_blend_part){.material = material, .weight = 0.1f, .tint = {1, 1, 1}};
    }
    float value[3], pdf, left;
    srbf_sample sample;
    CHECK_OK(srbf_blend_evaluate_and_pdf(parts, SRBF_MAX_BLEND, UP, UP, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_blend_evaluate_and_pdf(parts, SRBF_MAX_BLEND + 1, UP, UP, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_blend_evaluate_and_pdf(parts, 0, UP, UP, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_blend_sample(parts, (size_t)-1, UP, U, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_sample(NULL, 1, UP, U, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_sample(parts, 1, UP, U, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_albedo(parts, 1, NULL, value));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_choose(parts, 1, 0.5f, NULL, &left));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_blend_choose(parts, 1, 1.0f, &chosen, &left));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_blend_sample(parts, 2, U, U, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_ask(parts, 2, 0, 1, NULL));
    CHECK_OK(srbf_blend_ask(NULL, 0, 0, 0, NULL));
    const float odd[] = {NAN, -1, 1001, INFINITY, 0};
    for (int i = 0; i < 5; i++) {
        parts[0].weight = odd[i];
        CHECK_STATUS(SRBF_STATUS_WEIGHT, srbf_blend_sample(parts, 1, UP, U, &sample));
        parts[0].weight = 1;
        parts[0].tint[1] = odd[i];
        CHECK_STATUS(odd[i] == 0 ? SRBF_STATUS_OK : SRBF_STATUS_WEIGHT, srbf_blend_sample(parts, 1, UP, U, &sample));
        parts[0].tint[1] = 1;
        parts[0].coat = odd[i];
        CHECK_STATUS(odd[i] == 0 ? SRBF_STATUS_OK : SRBF_STATUS_WEIGHT, srbf_blend_sample(parts, 1, UP, U, &sample));
        parts[0].coat = 0;
    }
    parts[1].material = NULL;
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_blend_sample(parts, 2, UP, U, &sample));
    CHECK(fabsf(srbf_fresnel(1.5f, 1) - 0.04f) < 1e-6f && srbf_fresnel(1.5f, 0) > 0.999f);
}

static float drawn_value(const srbf_blend_part *parts, size_t count, const float *wo, const srbf_sample *sample, float *pdf) {
    float value[3];
    CHECK_OK(srbf_blend_evaluate_and_pdf(parts, count, wo, sample->direction, value, pdf));
    return value[1];
}

static void test_values(const srbf_material *material, const srbf_material *other) {
    static srbf_blend_part parts[N][PARTS];
    static float wo[N][3], wi[N][3], u[N][3], value[N][3], pdf[N];
    static srbf_sample drawn[N];
    uint64_t state = 9;
    for (int i = 0; i < N; i++) {
        direction(&state, wo[i]), direction(&state, wi[i]);
        for (int k = 0; k < 3; k++) {
            u[i][k] = uniform(&state);
        }
        for (int k = 0; k < PARTS; k++) {
            parts[i][k] = (srbf_blend_part){.material = k % 2 ? other : material, .weight = uniform(&state), .tint = {1, 0.5f, uniform(&state)}};
        }
        /* Some of fewer parts, some below a coat. */
        parts[i][2].weight = i % 3 ? 0 : 0.5f;
        parts[i][1].weight *= i % 5 ? 1 : 0;
        parts[i][0].coat = i % 7 ? 0 : 1.5f;
    }
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors numbers = {u[0], u[0] + 1, u[0] + 2, 12};
    const srbf_vectors_out values = {value[0], value[0] + 1, value[0] + 2, 12};
    float *first = drawn[0].direction, *weight = drawn[0].weight;
    const srbf_samples_out samples = {{first, first + 1, first + 2, sizeof drawn[0]},
                                      {&drawn[0].pdf, sizeof drawn[0]},
                                      {weight, weight + 1, weight + 2, sizeof drawn[0]}};
    const srbf_numbers_out densities = {pdf, 4};
    for (int is_same = 0; is_same < 2; is_same++) {
        const size_t stride = is_same ? 0 : sizeof parts[0];
        CHECK_OK(srbf_blend_ask(parts[0], PARTS, stride, N,
                                ASK(.wo = o, .u = numbers, .samples = samples, .wi = d, .value = values, .pdf = densities)));
        for (int i = 0; i < N; i++) {
            const srbf_blend_part *own = parts[is_same ? 0 : i];
            float single[3], density, there;
            srbf_sample sample;
            CHECK_OK(srbf_blend_sample_and_evaluate(own, PARTS, wo[i], u[i], &sample, wi[i], single, &density));
            CHECK(fabsf(density - pdf[i]) <= 1e-3f * fmaxf(density, 1e-3f));
            for (int k = 0; k < 3; k++) {
                CHECK(fabsf(single[k] - value[i][k]) <= 1e-3f * fmaxf(fabsf(single[k]), 1e-3f));
            }
            const float green = drawn_value(own, PARTS, wo[i], &drawn[i], &there);
            CHECK(fabsf(there / drawn[i].pdf - 1) < 5e-3f);
            CHECK(fabsf(drawn[i].weight[1] * drawn[i].pdf - green) <= 5e-3f * fabsf(green));
            srbf_sample alone;
            CHECK_OK(srbf_blend_sample(own, PARTS, wo[i], u[i], &alone));
            CHECK(alone.pdf == sample.pdf && alone.direction[0] == sample.direction[0]);
            /* One at random: the same chosen for the same number, alone. */
            srbf_blend_part chosen;
            float left;
            CHECK_OK(srbf_blend_choose(own, PARTS, u[i][0], &chosen, &left));
            CHECK(left >= 0 && left < 1 && (chosen.material == material || chosen.material == other));
            CHECK_OK(srbf_blend_evaluate_and_pdf(&chosen, 1, wo[i], wi[i], single, &density));
        }
    }
    /* A stride that is none, and outputs upon the parts or an object. */
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_blend_ask(parts[0], PARTS, sizeof parts[0] - 8, N, ASK(.wo = o, .wi = d, .pdf = densities)));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_blend_ask(parts[0], PARTS, sizeof parts[0] + 1, N, ASK(.wo = o, .wi = d, .pdf = densities)));
    const srbf_numbers_out upon = {&parts[1][0].weight, 4};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_blend_ask(parts[0], PARTS, sizeof parts[0], N, ASK(.wo = o, .wi = d, .pdf = upon)));
    const srbf_numbers_out upon_object = {(float *)(void *)(uintptr_t)material, 4};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_blend_ask(parts[0], PARTS, sizeof parts[0], N, ASK(.wo = o, .wi = d, .pdf = upon_object)));
    /* One of them refused: nothing is written. */
    parts[N - 1][0].weight = NAN;
    memset(pdf, 0, sizeof pdf);
    CHECK_STATUS(SRBF_STATUS_WEIGHT, srbf_blend_ask(parts[0], PARTS, sizeof parts[0], N, ASK(.wo = o, .wi = d, .pdf = densities)));
    CHECK(pdf[0] == 0);
}

/* A blend of one is its material, to the bit; one of its mixture is that. */
static void test_one(const srbf_material *material) {
    float value[3], wanted[3], pdf, density, albedo[3];
    srbf_sample sample, other;
    const srbf_blend_part part = {.material = material, .weight = 1, .tint = {1, 1, 1}};
    CHECK_OK(srbf_blend_evaluate_and_pdf(&part, 1, TILTED, UP, value, &pdf));
    CHECK_OK(srbf_material_evaluate_and_pdf(material, TILTED, UP, wanted, &density));
    CHECK(memcmp(value, wanted, sizeof value) == 0 && pdf == density);
    CHECK_OK(srbf_blend_sample(&part, 1, TILTED, U, &sample));
    CHECK_OK(srbf_material_sample(material, TILTED, U, &other));
    CHECK(memcmp(&sample, &other, sizeof sample) == 0);
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char room[SRBF_MIXTURE_SIZE_64];
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(room, sizeof room, &mixture));
    CHECK_OK(srbf_material_prepare(material, TILTED, mixture));
    const srbf_blend_part mixed = {.mixture = mixture, .weight = 1, .tint = {1, 1, 1}};
    CHECK_OK(srbf_blend_evaluate_and_pdf(&mixed, 1, TILTED, UP, value, &pdf));
    CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, UP, wanted, &density));
    CHECK(memcmp(value, wanted, sizeof value) == 0 && pdf == density);
    CHECK_OK(srbf_blend_albedo(&mixed, 1, TILTED, albedo));
    srbf_mixture_info info;
    CHECK_OK(srbf_mixture_query(mixture, &info));
    CHECK(memcmp(albedo, info.albedo, sizeof albedo) == 0);
}

int main(int argc, char **argv) {
    srbf_material *material, *other;
    CHECK(argc == 3);
    CHECK_OK(srbf_material_load(argv[1], &material));
    CHECK_OK(srbf_material_load(argv[2], &other));
    test_refused(material);
    test_one(material);
    test_values(material, other);
    CHECK_OK(srbf_material_free(material));
    CHECK_OK(srbf_material_free(other));
    puts("blend: passed");
    return 0;
}
