/* A material with factors through the header: queried, and evaluated and sampled in every way, against the same lobes without.
 *
 *     factors MATERIAL.srbf
 *
 * The factors of node (i, j, k) of 5 by 4 by 2 are 0.25 (1 + i), 1 and 0.25 (1 + j), the last twice as much for k = 1 but where i
 * or j is 0, but for the rounding of their roots to 1/255 of the largest.
 */
#include "check.h"

enum { N = 37, HALVES = 5, DIFFERENCES = 4, AZIMUTHS = 2 };

static int is_near(float a, float b) { return fabsf(a - b) <= 4e-5f * fmaxf(fabsf(a), fabsf(b)) + 1e-7f; }

static void test_queries(const srbf_material *material) {
    srbf_material_info info;
    float factor[3];
    CHECK_OK(srbf_material_query(material, &info));
    const size_t half = info.factor_nodes[0], difference = info.factor_nodes[1], azimuth = info.factor_nodes[2];
    CHECK(half == HALVES && difference == DIFFERENCES && azimuth == AZIMUTHS && info.largest_factor == 2);
    CHECK(info.has_signed_factors == 1);
    for (size_t n = 0; n < half * difference * azimuth; n++) {
        const size_t i = n / azimuth / difference, j = n / azimuth % difference, k = n % azimuth;
        CHECK_OK(srbf_material_factor_node(material, i, j, k, factor));
        CHECK(fabsf(factor[0] - 0.25f * (float)(1 + i)) < 0.008f && fabsf(factor[1] - 1) < 0.006f);
        CHECK(fabsf(factor[2] - 0.25f * (float)(1 + j) * (i * j * k > 0 ? 2 : 1)) < 0.008f);
    }
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_factor_node(material, HALVES, 0, 0, factor));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_factor_node(material, 0, SIZE_MAX, 0, factor));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_factor_node(material, 0, 0, AZIMUTHS, factor));
    for (size_t v = 0; v < 2; v++) {
        CHECK_OK(srbf_material_view_albedo_difference(material, v, factor));
        CHECK(factor[0] == -0.25f && factor[1] == 0.5f && factor[2] == (v == 0 ? -0.125f : 0.25f));
    }
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_albedo_difference(material, 2, factor));
    /* At the normal both angles are 0; between opposite directions at the horizon the difference is the largest. */
    const float up[3] = {0, 0, 1}, along[3] = {1, 0, 0}, back[3] = {-1, 0, 0}, none[3] = {0, 0, 0};
    CHECK_OK(srbf_material_factor(material, up, up, factor));
    CHECK(fabsf(factor[0] - 0.25f) < 0.006f && fabsf(factor[2] - 0.25f) < 0.006f);
    CHECK_OK(srbf_material_factor(material, along, back, factor));
    CHECK(fabsf(factor[0] - 0.25f) < 0.006f && fabsf(factor[2] - 1) < 0.006f);
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_factor(material, none, up, factor));
}

static void test_values(const srbf_material *material) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_16];
    float wo[N][3], wi[N][3], *value = guarded(3 * N), *pdf = guarded(N);
    uint64_t state = 9;
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    srbf_material_info whole;
    CHECK_OK(srbf_material_query(material, &whole));
    for (int i = 0; i < N; i++) {
        direction(&state, wo[i]), direction(&state, wi[i]);
        wo[i][2] = fabsf(wo[i][2]), wi[i][2] = fabsf(wi[i][2]);
    }
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors_out values = {value, value + 1, value + 2, 12};
    const srbf_numbers_out densities = {pdf, 4};
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = o, .wi = d, .value = values, .pdf = densities)));
    for (int i = 0; i < N; i++) {
        float one[4], factor[3];
        srbf_mixture_info info;
        CHECK_OK(srbf_material_prepare(material, wo[i], mixture));
        CHECK_OK(srbf_mixture_query(mixture, &info));
        CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, wi[i], one, one + 3));
        CHECK_OK(srbf_material_factor(material, wo[i], wi[i], factor));
        /* The lobes are grey, and have the density times their power; the change of the albedo by the factors is relative to that. */
        CHECK(is_near(info.albedo[0], 0.75f * info.power) && is_near(info.albedo[1], 1.5f * info.power));
        for (int c = 0; c < 3; c++) {
            CHECK(is_near(one[c], one[3] * info.power * factor[c]) && is_near(one[c], value[3 * i + c]));
        }
        CHECK(is_near(one[3], pdf[i]));
        const float u[3] = {uniform(&state), uniform(&state), uniform(&state)};
        srbf_sample sample;
        CHECK_OK(srbf_mixture_sample(mixture, u, &sample));
        CHECK(0.2126f * sample.weight[0] + 0.7152f * sample.weight[1] + 0.0722f * sample.weight[2] <=
              1.00001f * info.power * whole.largest_factor);
        CHECK_OK(srbf_mixture_evaluate(mixture, sample.direction, one));
        CHECK(is_near(one[0], sample.weight[0] * sample.pdf) && is_near(one[2], sample.weight[2] * sample.pdf));
    }
    /* The factors may not be overwritten while they are read. */
    const size_t nodes = (whole.byte_count - 4 - whole.provenance_length) / 4 - HALVES * DIFFERENCES;
    float *inside = (float *)(uintptr_t)whole.bytes + nodes;
    const srbf_vectors_out over = {inside, inside + 1, inside + 2, 12};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_ask(mixture, 0, 1, ASK(.wi = d, .value = over)));
    /* A product is one of lobes. */
    float inner[3];
    CHECK_STATUS(SRBF_STATUS_SQUEEZED, srbf_mixture_inner_product(mixture, mixture, inner));
    release(value, 3 * N), release(pdf, N);
}

/* Channels may be negative where the luminance is not. */
static void test_colors(void) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_16];
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    const srbf_lobe cyan = {{0, 0, 1}, 10, {-0.5f, 1, 1}}, dark = {{0, 0, 1}, 10, {1, -0.29f, 0}};
    const float up[3] = {0, 0, 1}, diffuse[3] = {0.1f, 0.1f, -0.01f};
    float value[3], pdf;
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 1, &cyan, diffuse, mixture));
    CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, up, value, &pdf));
    CHECK(value[0] < 0 && value[1] > 0 && value[2] > 0 && pdf > 0);
    CHECK_STATUS(SRBF_STATUS_AMPLITUDE,
                 srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 1, &dark, NULL, mixture));
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    size_t size;
    unsigned char *bytes = read_file(arguments[1], &size);
    srbf_material *material;
    CHECK_OK(srbf_material_from_bytes(bytes, size, &material));
    test_queries(material);
    test_values(material);
    test_colors();
    CHECK_OK(srbf_material_free(material));
    free(bytes);
    printf("factors: passed\n");
    return 0;
}
