/* An expanded material through the header: made, refused, and evaluated and sampled in every way, against the exact preparation.
 *
 *     expanded MATERIAL.srbf
 */
#include "check.h"

enum { N = 53, ROWS = 512 };

static int is_near(float a, float b) { return fabsf(a - b) <= 1e-3f * fmaxf(fabsf(a), fabsf(b)) + 1e-3f; }

static void test_refused(const srbf_material *material) {
    size_t size, more;
    srbf_expanded *expanded = NULL;
    const srbf_request nothing = {.size = sizeof nothing};
    CHECK_OK(srbf_expanded_size(material, ROWS, &size));
    CHECK_OK(srbf_expanded_size(material, 2 * ROWS, &more));
    CHECK(size > 448 * ROWS && more > size + 448 * ROWS);
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_expanded_size(material, SIZE_MAX, &size));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_expanded_size(material, ROWS, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_expanded_size(NULL, ROWS, &size));
    unsigned char *storage = malloc(size);
    CHECK(storage != NULL);
    memset(storage, 0xff, size);
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_expanded_make(material, ROWS, storage, size - 1, &expanded));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_expanded_make(material, ROWS, NULL, size, &expanded));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_expanded_make(material, ROWS, storage, size, NULL));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_expanded_make(material, 2, storage + 8, size - 8, &expanded));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_expanded_make(material, 1, storage, size, &expanded));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_expanded_make(material, 20000, storage, size, &expanded));
    CHECK(expanded == NULL);
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_expanded_ask((srbf_expanded *)storage, 1, &nothing));
    free(storage);
}

static void test_values(const srbf_material *material, const srbf_expanded *expanded) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    float wo[N][3], wi[N][3], u[N][3];
    float *value = guarded(3 * N), *pdf = guarded(N), *alone = guarded(3 * N), *density = guarded(N);
    float *drawn = guarded(3 * N), *weight = guarded(3 * N), *towards = guarded(3 * N), *at = guarded(N);
    uint64_t state = 9;
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    for (int i = 0; i < N; i++) {
        direction(&state, wo[i]), direction(&state, wi[i]);
        wo[i][2] = fabsf(wo[i][2]), wi[i][2] = fabsf(wi[i][2]);
        for (int k = 0; k < 3; k++) {
            u[i][k] = uniform(&state);
        }
    }
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors numbers = {u[0], u[0] + 1, u[0] + 2, 12};
    const srbf_vectors_out values = {value, value + 1, value + 2, 12}, others = {alone, alone + 1, alone + 2, 12};
    const srbf_vectors_out to = {towards, towards + 1, towards + 2, 12};
    const srbf_numbers_out densities = {pdf, 4}, densities_alone = {density, 4}, to_density = {at, 4};
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = o, .wi = d, .value = values, .pdf = densities)));
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = o, .wi = d, .value = others)));
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = o, .wi = d, .pdf = densities_alone)));
    for (int i = 0; i < N; i++) {
        float exact[3], exact_pdf, one[3], one_pdf;
        CHECK_OK(srbf_material_prepare(material, wo[i], mixture));
        CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, wi[i], exact, &exact_pdf));
        CHECK_OK(srbf_expanded_prepare(expanded, wo[i], mixture));
        CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, wi[i], one, &one_pdf));
        for (int k = 0; k < 3; k++) {
            CHECK(value[3 * i + k] == alone[3 * i + k]);
            CHECK(is_near(value[3 * i + k], exact[k]) && is_near(one[k], exact[k]));
        }
        CHECK(fabsf(pdf[i] - density[i]) <= 1e-5f * pdf[i]);
        CHECK(is_near(pdf[i], exact_pdf) && is_near(one_pdf, exact_pdf));
    }

    /* Samples, and with the same preparation the values of above. */
    const srbf_samples_out samples = {{drawn, drawn + 1, drawn + 2, 12}, {pdf, 4}, {weight, weight + 1, weight + 2, 12}};
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = o, .u = numbers, .samples = samples, .wi = d, .value = to, .pdf = to_density)));
    for (int i = 0; i < N; i++) {
        CHECK(fabsf(at[i] - density[i]) <= 1e-5f * density[i] && pdf[i] > 0);
        CHECK(is_near(towards[3 * i], value[3 * i]) && weight[3 * i] >= 0 && weight[3 * i] < 2);
    }
    const srbf_samples_out again = {{alone, alone + 1, alone + 2, 12}, {density, 4}, {value, value + 1, value + 2, 12}};
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = o, .u = numbers, .samples = again)));
    CHECK(memcmp(drawn, alone, 3 * N * sizeof *drawn) == 0 && memcmp(pdf, density, N * sizeof *pdf) == 0);
    CHECK(memcmp(weight, value, 3 * N * sizeof *weight) == 0);

    /* Nothing at all, and outputs that meet. */
    CHECK_OK(srbf_expanded_ask(expanded, 0, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_expanded_ask(expanded, N, ASK(.wo = o, .value = others)));
    const srbf_numbers_out inside = {(float *)expanded, 4};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_expanded_ask(expanded, N, ASK(.wo = o, .wi = d, .pdf = inside)));
    release(value, 3 * N), release(pdf, N), release(alone, 3 * N), release(density, N);
    release(drawn, 3 * N), release(weight, 3 * N), release(towards, 3 * N), release(at, N);
}

int main(int argc, char **argv) {
    srbf_material *material;
    srbf_expanded *expanded;
    size_t size;
    CHECK(argc == 2);
    CHECK_OK(srbf_material_load(argv[1], &material));
    test_refused(material);
    CHECK_OK(srbf_expanded_size(material, ROWS, &size));
    void *storage = malloc(size);
    CHECK(storage != NULL);
    CHECK_OK(srbf_expanded_make(material, ROWS, storage, size, &expanded));
    CHECK((void *)expanded == storage);
    test_values(material, expanded);
    free(storage);
    CHECK_OK(srbf_material_free(material));
    puts("expanded: passed");
    return 0;
}
