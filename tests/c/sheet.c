/* A sheet through the header: loaded, refused, asked one hit at a time and many together, on both sides.
 *
 *     sheet SHEET.srbf MATERIAL.srbf
 */
#include "check.h"

enum { N = 70 };

static unsigned char *bytes_of(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    CHECK(fseek(file, 0, SEEK_END) == 0);
    *size = (size_t)ftell(file);
    CHECK(fseek(file, 0, SEEK_SET) == 0);
    unsigned char *bytes = malloc(*size);
    CHECK(bytes != NULL && fread(bytes, 1, *size, file) == *size);
    CHECK(fclose(file) == 0);
    return bytes;
}

static void test_refused(const char *path, const char *material_path) {
    _Alignas(SRBF_SHEET_ALIGNMENT) unsigned char room[SRBF_SHEET_SIZE + 16], zeros[SRBF_SHEET_SIZE] = {0};
    srbf_sheet *sheet = NULL;
    srbf_sheet_info info;
    size_t size, other_size;
    unsigned char *bytes = bytes_of(path, &size), *material = bytes_of(material_path, &other_size);
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_load(NULL, &sheet));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_load(path, NULL));
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_sheet_load("/no/such/file.srbf", &sheet));
    CHECK_STATUS(SRBF_STATUS_FIELD, srbf_sheet_load(material_path, &sheet));
    CHECK(strstr(srbf_last_message(), "a material where a sheet is expected") != NULL);
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_borrow(NULL, size, room, sizeof room, &sheet));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_borrow(bytes, size, NULL, sizeof room, &sheet));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_borrow(bytes, size, room, sizeof room, NULL));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_sheet_borrow(bytes, size, room, SRBF_SHEET_SIZE - 1, &sheet));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_sheet_borrow(bytes, size, room + 8, sizeof room - 8, &sheet));
    CHECK_STATUS(SRBF_STATUS_LENGTH, srbf_sheet_borrow(bytes, size - 1, room, sizeof room, &sheet));
    CHECK_STATUS(SRBF_STATUS_FIELD, srbf_sheet_borrow(material, other_size, room, sizeof room, &sheet));
    srbf_material *none = NULL;
    CHECK_STATUS(SRBF_STATUS_FIELD, srbf_material_from_bytes(bytes, size, &none));
    CHECK(sheet == NULL && none == NULL);

    const float up[3] = {0, 0, 1}, u[3] = {0.5f, 0.5f, 0.5f}, none_at_all[3] = {NAN, 0, 1}, one[3] = {1, 1, 1};
    float value[3], other[3], pdf;
    srbf_sample sample;
    const srbf_request nothing = {.size = sizeof nothing};
    srbf_sheet *no_sheet = (srbf_sheet *)(void *)zeros;
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_query(no_sheet, &info));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_albedos(no_sheet, up, value, other));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_evaluate_and_pdf(no_sheet, up, up, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_sample(no_sheet, up, u, &sample));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_ask(no_sheet, 1, &nothing));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_free(no_sheet));
    CHECK_OK(srbf_sheet_free(NULL));

    CHECK_OK(srbf_sheet_borrow(bytes, size, room, sizeof room, &sheet));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_query(sheet, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_albedos(sheet, up, NULL, other));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_evaluate_and_pdf(sheet, NULL, up, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_evaluate_and_pdf(sheet, up, up, value, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_sample(sheet, up, u, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_sheet_ask(sheet, 1, NULL));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_sheet_evaluate_and_pdf(sheet, none_at_all, up, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_sheet_albedos(sheet, one, value, other));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_sheet_sample(sheet, up, one, &sample));
    CHECK_OK(srbf_sheet_free(sheet));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_sheet_query(sheet, &info));
    free(bytes), free(material);
}

static void test_values(const srbf_sheet *sheet) {
    float wo[N][3], wi[N][3], u[N][3], value[N][3], pdf[N];
    srbf_sample drawn[N];
    uint64_t state = 9;
    int through = 0, behind = 0;
    for (int i = 0; i < N; i++) {
        direction(&state, wo[i]), direction(&state, wi[i]);
        wo[i][2] = (i % 2 ? -1.0f : 1.0f) * fabsf(wo[i][2]);
        wi[i][2] = (i % 3 ? -1.0f : 1.0f) * fabsf(wi[i][2]);
        for (int k = 0; k < 3; k++) {
            u[i][k] = uniform(&state);
        }
    }
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors numbers = {u[0], u[0] + 1, u[0] + 2, 12};
    const srbf_vectors_out values = {value[0], value[0] + 1, value[0] + 2, 12};
    float *first = drawn[0].direction, *weight = drawn[0].weight;
    const srbf_samples_out samples = {{first, first + 1, first + 2, sizeof drawn[0]},
                                      {&drawn[0].pdf, sizeof drawn[0]},
                                      {weight, weight + 1, weight + 2, sizeof drawn[0]}};
    const srbf_numbers_out densities = {pdf, 4};
    CHECK_OK(srbf_sheet_ask(sheet, N, ASK(.wo = o, .u = numbers, .samples = samples, .wi = d, .value = values, .pdf = densities)));
    CHECK_OK(srbf_sheet_ask(sheet, 0, NULL));
    for (int i = 0; i < N; i++) {
        float single[3], density;
        srbf_sample sample;
        CHECK_OK(srbf_sheet_evaluate_and_pdf(sheet, wo[i], wi[i], single, &density));
        CHECK_OK(srbf_sheet_sample(sheet, wo[i], u[i], &sample));
        CHECK(fabsf(density - pdf[i]) <= 1e-3f * fmaxf(density, 1e-3f));
        CHECK((sample.direction[2] < 0) == (drawn[i].direction[2] < 0));
        for (int k = 0; k < 3; k++) {
            CHECK(fabsf(single[k] - value[i][k]) <= 1e-3f * fmaxf(fabsf(single[k]), 1e-3f));
        }
        CHECK_OK(srbf_sheet_evaluate_and_pdf(sheet, wo[i], sample.direction, single, &density));
        CHECK(sample.pdf > 0 ? fabsf(density / sample.pdf - 1) < 2e-3f : sample.weight[0] == 0);
        through += sample.pdf > 0 && (sample.direction[2] < 0) != (wo[i][2] < 0);
        behind += wo[i][2] < 0;
    }
    CHECK(through > 5 && behind > 5 && behind < N - 5);
}

int main(int argc, char **argv) {
    srbf_sheet *sheet;
    srbf_sheet_info info;
    CHECK(argc == 3);
    test_refused(argv[1], argv[2]);
    CHECK_OK(srbf_sheet_load(argv[1], &sheet));
    CHECK_OK(srbf_sheet_query(sheet, &info));
    CHECK(info.byte_count > 0 && info.lobes > 0 && info.lobes <= 64 && info.provenance_length > 0);
    /* A quarter is a material. */
    int quarters = 0;
    for (int q = 0; q < 4; q++) {
        srbf_material *material;
        if (info.quarters[q] == NULL) {
            continue;
        }
        CHECK_OK(srbf_material_from_bytes(info.quarters[q], info.quarter_byte_counts[q], &material));
        CHECK_OK(srbf_material_free(material));
        quarters++;
    }
    CHECK(quarters > 1);
    const float front[3] = {0.6f, 0, 0.8f}, back[3] = {0.6f, 0, -0.8f};
    float reflected[3], transmitted[3];
    CHECK_OK(srbf_sheet_albedos(sheet, front, reflected, transmitted));
    CHECK(reflected[1] > 0 && transmitted[1] > 0 && reflected[1] + transmitted[1] < 1.01f);
    CHECK_OK(srbf_sheet_albedos(sheet, back, reflected, transmitted));
    CHECK(transmitted[1] > 0);
    test_values(sheet);
    CHECK_OK(srbf_sheet_free(sheet));
    puts("sheet: passed");
    return 0;
}
