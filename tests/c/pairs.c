/* Answers of the C interface to many pairs of directions, by the protocol of evaluator/examples/reference.rs, for lab/differential.py.
 *
 *     pairs FILE.srbf material|sheet|blend < in > out
 */
#include "check.h"

static float *row(float *rows, size_t n, size_t index) { return rows + index * n; }

static srbf_vectors in(float *rows, size_t n, size_t first) {
    srbf_vectors vectors = {row(rows, n, first), row(rows, n, first + 1), row(rows, n, first + 2), sizeof(float)};
    return vectors;
}

static srbf_vectors_out out(float *rows, size_t n, size_t first) {
    srbf_vectors_out vectors = {row(rows, n, first), row(rows, n, first + 1), row(rows, n, first + 2), sizeof(float)};
    return vectors;
}

static float *given(size_t *n) {
    size_t count = 0, room = 1 << 16;
    float *numbers = (float *)malloc(room * sizeof(float));
    for (size_t got = 1; got > 0; count += got) {
        if (count == room) {
            room *= 2;
            numbers = (float *)realloc(numbers, room * sizeof(float));
        }
        CHECK(numbers != NULL);
        got = fread(numbers + count, sizeof(float), room - count, stdin);
    }
    CHECK(count % 9 == 0);
    *n = count / 9;
    return numbers;
}

int main(int argc, char **argv) {
    CHECK(argc == 3);
    size_t n;
    float *numbers = given(&n), *answers = (float *)calloc(14 * n, sizeof(float));
    CHECK(answers != NULL);
    srbf_request request = {0};
    request.size = sizeof request;
    request.wo = in(numbers, n, 0), request.wi = in(numbers, n, 3), request.u = in(numbers, n, 6);
    request.value = out(answers, n, 0), request.samples.direction = out(answers, n, 4), request.samples.weight = out(answers, n, 8);
    request.pdf.values = row(answers, n, 3), request.pdf.stride = sizeof(float);
    request.samples.pdf.values = row(answers, n, 7), request.samples.pdf.stride = sizeof(float);
    const int is_sheet = strcmp(argv[2], "sheet") == 0, is_blend = strcmp(argv[2], "blend") == 0;
    srbf_sheet *sheet = NULL;
    srbf_material *material = NULL, *other = NULL;
    srbf_sheet_info info;
    if (is_sheet || is_blend) {
        CHECK_OK(srbf_sheet_load(argv[1], &sheet));
        CHECK_OK(srbf_sheet_query(sheet, &info));
    } else {
        CHECK_OK(srbf_material_load(argv[1], &material));
    }
    if (is_blend) {
        CHECK_OK(srbf_material_from_bytes(info.quarters[0], info.quarter_byte_counts[0], &material));
        CHECK_OK(srbf_material_from_bytes(info.quarters[1], info.quarter_byte_counts[1], &other));
    }
    const srbf_blend_part parts[2] = {{.material = material, .weight = 1, .tint = {0.7f, 0.7f, 0.7f}},
                                      {.material = other, .weight = 1, .tint = {0.3f, 0.24f, 0.18f}}};
    if (is_blend) {
        CHECK_OK(srbf_blend_ask(parts, 2, 0, n, &request));
    } else if (is_sheet) {
        CHECK_OK(srbf_sheet_ask(sheet, n, &request));
    } else {
        CHECK_OK(srbf_material_ask(material, n, &request));
    }
    for (size_t i = 0; i < n; i++) {
        float wo[3], albedo[3], transmitted[3];
        for (size_t c = 0; c < 3; c++) wo[c] = row(numbers, n, c)[i];
        const int is_other_side = is_sheet && (wo[2] < 0) != (row(numbers, n, 5)[i] < 0);
        if (is_blend) {
            CHECK_OK(srbf_blend_albedo(parts, 2, wo, albedo));
        } else if (is_sheet) {
            CHECK_OK(srbf_sheet_albedos(sheet, wo, albedo, transmitted));
        } else {
            CHECK_OK(srbf_material_albedo(material, wo, albedo));
        }
        for (size_t c = 0; c < 3; c++) row(answers, n, 11 + c)[i] = is_other_side ? transmitted[c] : albedo[c];
    }
    CHECK(fwrite(answers, sizeof(float), 14 * n, stdout) == 14 * n);
    CHECK_OK(srbf_material_free(material));
    CHECK_OK(srbf_material_free(other));
    CHECK_OK(srbf_sheet_free(sheet));
    free(numbers);
    free(answers);
    return 0;
}
