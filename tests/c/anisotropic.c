/* An anisotropic material through the header: queried, prepared, evaluated and sampled one by one and as pairs; and damaged.
 *
 *     anisotropic MATERIAL.srbf
 */
#include "check.h"

enum { N = 37, VIEWS = 25, LOBES = 5, SQUEEZED = 3 };

static int is_near(float a, float b) { return fabsf(a - b) <= 2e-5f * fmaxf(fabsf(a), fabsf(b)) + 1e-7f; }

static srbf_mixture *prepared(const srbf_material *material, const float wo[3], void *storage, size_t size) {
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(storage, size, &mixture));
    CHECK_OK(srbf_material_prepare(material, wo, mixture));
    return mixture;
}

static void test_query(const srbf_material *material, size_t size) {
    srbf_material_info info;
    srbf_view view;
    srbf_plane_lobe lobe;
    CHECK_OK(srbf_material_query(material, &info));
    CHECK(info.views == VIEWS && info.lobes == LOBES && info.squeezed_lobes == SQUEEZED && info.byte_count == size);
    for (size_t v = 0; v <= info.views; v++) {
        CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view(material, v, &view));
        CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_lobe(material, v, 0, &lobe));
    }
}

/* Half a turn of the surface changes nothing, a quarter does; samples have the density and the weight that they say. */
static void test_directions(const srbf_material *material, int is_in_codes) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[3][SRBF_MIXTURE_SIZE_16];
    uint64_t state = 11;
    double changed = 0;
    for (int i = 0; i < 200; i++) {
        float wo[3], wi[3], value[3][3], pdf[3], albedo[3];
        direction(&state, wo), direction(&state, wi);
        for (int turn = 0; turn < 3; turn++) {
            /* As it is; by half a turn; by a quarter. */
            const float c = turn == 0 ? 1.0f : turn == 1 ? -1.0f : 0.0f, s = turn == 2 ? 1.0f : 0.0f;
            const float o[3] = {c * wo[0] - s * wo[1], s * wo[0] + c * wo[1], wo[2]};
            const float d[3] = {c * wi[0] - s * wi[1], s * wi[0] + c * wi[1], wi[2]};
            srbf_mixture *mixture = prepared(material, o, storage[turn], sizeof storage[turn]);
            CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, d, value[turn], &pdf[turn]));
            if (turn > 0) continue;
            srbf_mixture_info info;
            CHECK_OK(srbf_mixture_query(mixture, &info));
            CHECK_OK(srbf_material_albedo(material, o, albedo));
            CHECK(is_near(info.albedo[1], albedo[1]) && info.lobes == LOBES);
            double mean = 0;
            enum { DRAWS = 400 };
            for (int k = 0; k < DRAWS; k++) {
                const float u[3] = {((float)k + uniform(&state)) / DRAWS, uniform(&state), uniform(&state)};
                srbf_sample sample;
                float again[3], density;
                CHECK_OK(srbf_mixture_sample(mixture, u, &sample));
                CHECK(sample.direction[2] >= 0 && sample.pdf > 0);
                CHECK_OK(srbf_mixture_evaluate_and_pdf(mixture, sample.direction, again, &density));
                CHECK(is_near(density, sample.pdf) && is_near(again[0], sample.weight[0] * sample.pdf));
                mean += (double)sample.weight[1] / DRAWS;
            }
            /* Every weight is within a few times the mean, so 400 stratified ones are within a tenth of the closed form. */
            CHECK(fabs(mean - (double)albedo[1]) < 0.1 * (double)albedo[1]);
        }
        /* Codes of tilts at the normal need not be symmetric. */
        CHECK(is_in_codes || (is_near(value[0][0], value[1][0]) && is_near(pdf[0], pdf[1])));
        changed += fabs((double)pdf[0] - (double)pdf[2]) / (double)(pdf[0] + pdf[2]) / 200;
    }
    CHECK(changed > 0.05);
}

static void test_pairs(const srbf_material *material) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_16];
    float wo[N][3], wi[N][3], *value = guarded(3 * N), *pdf = guarded(N);
    uint64_t state = 5;
    for (int i = 0; i < N; i++) direction(&state, wo[i]), direction(&state, wi[i]);
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors_out values = {value, value + 1, value + 2, 12};
    const srbf_numbers_out densities = {pdf, 4};
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = o, .wi = d, .value = values, .pdf = densities)));
    for (int i = 0; i < N; i++) {
        float one[4];
        CHECK_OK(srbf_mixture_evaluate_and_pdf(prepared(material, wo[i], storage, sizeof storage), wi[i], one, one + 3));
        CHECK(is_near(one[0], value[3 * i]) && is_near(one[2], value[3 * i + 2]) && is_near(one[3], pdf[i]));
    }
    release(value, 3 * N), release(pdf, N);
}

/* Cut anywhere and with a bit of any byte flipped, the bytes are refused; one behind the end is not read (AddressSanitizer sees it). */
static void test_damage(const unsigned char *bytes, size_t size) {
    _Alignas(SRBF_MATERIAL_ALIGNMENT) unsigned char storage[SRBF_MATERIAL_SIZE];
    srbf_material *material;
    unsigned char *copy = (unsigned char *)malloc(size);
    CHECK(copy != NULL);
    for (size_t length = 0; length < size; length++) {
        unsigned char *cut = (unsigned char *)malloc(length ? length : 1);
        CHECK(cut != NULL);
        memcpy(cut, bytes, length);
        CHECK(srbf_material_borrow(cut, length, storage, sizeof storage, &material) != SRBF_STATUS_OK);
        free(cut);
    }
    for (size_t bit = 0; bit < 8 * size; bit += 7) { /* every byte, and every bit of some */
        memcpy(copy, bytes, size);
        copy[bit / 8] ^= (unsigned char)(1u << bit % 8);
        CHECK(srbf_material_borrow(copy, size, storage, sizeof storage, &material) != SRBF_STATUS_OK);
    }
    free(copy);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    size_t size;
    unsigned char *bytes = read_file(arguments[1], &size);
    srbf_material *material;
    CHECK_OK(srbf_material_from_bytes(bytes, size, &material));
    test_query(material, size);
    /* The tag of the first block. */
    test_directions(material, memcmp(bytes + 40, "PACK", 4) == 0);
    test_pairs(material);
    test_damage(bytes, size);
    CHECK_OK(srbf_material_free(material));
    free(bytes);
    printf("anisotropic: passed\n");
    return 0;
}
