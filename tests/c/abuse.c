/* Every function in abusive use: a status, outputs as they were, never undefined behaviour.
 *
 *     abuse MATERIAL.srbf
 */
#define _DEFAULT_SOURCE
#include "check.h"
#include <sys/mman.h>

static const float UP[3] = {0, 0, 1};
static const float BAD[6][3] = {
    {NAN, 0, 1}, {0, INFINITY, 1}, {0, 0, 0}, {0, 0, 2}, {0, 0, 0.9f}, {1e30f, 1e30f, 1e30f},
};
static const float U[3] = {0.5f, 0.5f, 0.5f};

/* An address that is not NULL and not aligned for numbers. */
#define CROOKED(type, pointer) ((type *)(void *)((char *)(pointer) + 1))

static srbf_mixture *new_mixture(void) {
    void *storage = aligned_alloc(SRBF_MIXTURE_ALIGNMENT, SRBF_MIXTURE_SIZE_16);
    srbf_mixture *mixture = NULL;
    CHECK(storage != NULL);
    CHECK_OK(srbf_mixture_init(storage, SRBF_MIXTURE_SIZE_16, &mixture));
    return mixture;
}

/* Whether the message begins with the name of an argument. */
static int names_an_argument(void) {
    const size_t letters = strspn(srbf_last_message(), "abcdefghijklmnopqrstuvwxyz_->.");
    return letters > 0 && srbf_last_message()[letters] == ':';
}

/* The pointer argument `p` of a call: NULL and misaligned. The macro's argument is a call in terms of `p`. */
#define CHECK_POINTER(type, good, call)                       \
    do {                                                      \
        type *p = NULL;                                       \
        CHECK_STATUS(SRBF_STATUS_NULL, call);                 \
        CHECK(names_an_argument());                           \
        p = CROOKED(type, good);                              \
        CHECK_STATUS(SRBF_STATUS_MISALIGNED, call);           \
        CHECK(names_an_argument());                           \
    } while (0)

/* An object argument: NULL, misaligned, and memory that holds no such object. */
#define CHECK_OBJECT(type, good, call)                        \
    do {                                                      \
        _Alignas(64) unsigned char bytes_[SRBF_MIXTURE_SIZE_64] = {0}; \
        CHECK_POINTER(type, good, call);                      \
        type *p = (type *)(void *)bytes_;                     \
        CHECK_STATUS(SRBF_STATUS_OBJECT, call);               \
        memset(bytes_, 0x5a, sizeof bytes_);                  \
        CHECK_STATUS(SRBF_STATUS_OBJECT, call);               \
    } while (0)

/* Whatever is no material is seen at its head: of bytes that no copy has room for. A device has no end. */
static void test_endless(void) {
    srbf_material *made = NULL;
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_load("/dev/zero", &made));
    CHECK(strcmp(srbf_last_message(), "a file could not be read or written: /dev/zero: not a regular file") == 0);
    const size_t size = (size_t)1 << (sizeof(size_t) > 4 ? 40 : 30);
    void *zeros = mmap(NULL, size, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (zeros != MAP_FAILED) {
        CHECK_STATUS(SRBF_STATUS_MAGIC, srbf_material_from_bytes((const unsigned char *)zeros, size, &made));
        CHECK(munmap(zeros, size) == 0);
    }
    CHECK(made == NULL);
}

/* Storage, bytes and the pointer to the material, one upon another: refused before anything is written. */
static void test_borrow_overlaps(const unsigned char *bytes, size_t size) {
    const size_t room = size + SRBF_MATERIAL_SIZE + 16;
    unsigned char *memory = (unsigned char *)aligned_alloc(16, (room + 15) / 16 * 16);
    _Alignas(16) unsigned char storage[SRBF_MATERIAL_SIZE];
    srbf_material *made = NULL;
    CHECK(memory != NULL);
    memcpy(memory, bytes, size);
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_borrow(memory, size, memory, SRBF_MATERIAL_SIZE, &made));
    CHECK_STATUS(SRBF_STATUS_OVERLAP,
                 srbf_material_borrow(memory, size, memory + (size - 1) / 16 * 16, SRBF_MATERIAL_SIZE, &made));
    CHECK_STATUS(SRBF_STATUS_OVERLAP,
                 srbf_material_borrow(memory, size, storage, sizeof storage, (srbf_material **)(void *)(memory + 16)));
    CHECK_STATUS(SRBF_STATUS_OVERLAP,
                 srbf_material_borrow(memory, size, storage, sizeof storage, (srbf_material **)(void *)(storage + 120)));
    CHECK(made == NULL && memcmp(memory, bytes, size) == 0);
    CHECK_OK(srbf_material_borrow(memory, size, memory + (size + 15) / 16 * 16, SRBF_MATERIAL_SIZE, &made));
    free(memory);
}

static void test_materials(const char *path) {
    size_t size;
    unsigned char *bytes = read_file(path, &size);
    _Alignas(16) unsigned char storage[SRBF_MATERIAL_SIZE + 16];
    srbf_material *made = NULL, *material;
    CHECK_OK(srbf_material_load(path, &material));

    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_borrow(NULL, size, storage, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_MAGIC, srbf_material_borrow(NULL, 0, storage, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_MAGIC, srbf_material_borrow(bytes, 0, storage, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_borrow(bytes, SIZE_MAX, storage, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_borrow(bytes, size, storage, SRBF_MATERIAL_SIZE - 1, &made));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_borrow(bytes, size, NULL, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED,
                 srbf_material_borrow(bytes, size, storage + 1, SRBF_MATERIAL_SIZE, &made));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED,
                 srbf_material_borrow(bytes, size, storage + 8, SRBF_MATERIAL_SIZE, &made));
    CHECK_POINTER(srbf_material *, &made, srbf_material_borrow(bytes, size, storage, sizeof storage, p));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_from_bytes(NULL, size, &made));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_from_bytes(bytes, SIZE_MAX, &made));
    CHECK_POINTER(srbf_material *, &made, srbf_material_from_bytes(bytes, size, p));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_load(NULL, &made));
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_load("/no/such/file.srbf", &made));
    CHECK(strstr(srbf_last_message(), "/no/such/file.srbf") != NULL);
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_load("/no/such\nfile\t\x7f.srbf", &made));
    CHECK(strstr(srbf_last_message(), "/no/such\\u{a}file\\u{9}\\u{7f}.srbf: ") != NULL);
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_load("/", &made));
    CHECK_STATUS(SRBF_STATUS_TEXT, srbf_material_load("\xff.srbf", &made));
    CHECK_POINTER(srbf_material *, &made, srbf_material_load(path, p));
    CHECK(made == NULL);
    test_borrow_overlaps(bytes, size);

    srbf_material_info info;
    srbf_view view;
    srbf_plane_lobe lobe;
    float rgb[4];
    CHECK_OBJECT(srbf_material, material, srbf_material_query(p, &info));
    CHECK_POINTER(srbf_material_info, &info, srbf_material_query(material, p));
    CHECK_OBJECT(srbf_material, material, srbf_material_view(p, 0, &view));
    CHECK_POINTER(srbf_view, &view, srbf_material_view(material, 0, p));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view(material, 8, &view));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view(material, SIZE_MAX, &view));
    CHECK_OBJECT(srbf_material, material, srbf_material_view_lobe(p, 0, 0, &lobe));
    CHECK_POINTER(srbf_plane_lobe, &lobe, srbf_material_view_lobe(material, 0, 0, p));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_lobe(material, 8, 0, &lobe));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_lobe(material, SIZE_MAX, SIZE_MAX, &lobe));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_lobe(material, 0, 12, &lobe));
    CHECK_OBJECT(srbf_material, material, srbf_material_factor(p, UP, UP, rgb));
    CHECK_POINTER(float, rgb, srbf_material_factor(material, p, UP, rgb));
    CHECK_POINTER(float, rgb, srbf_material_factor(material, UP, p, rgb));
    CHECK_POINTER(float, rgb, srbf_material_factor(material, UP, UP, p));

    const float nm[1] = {500};
    srbf_spectrum spectrum;
    CHECK_OBJECT(srbf_material, material, srbf_material_spectrum(p, &spectrum));
    CHECK_POINTER(srbf_spectrum, &spectrum, srbf_material_spectrum(material, p));
    CHECK_OBJECT(srbf_material, material, srbf_material_primaries(p, nm, 1, rgb));
    CHECK_POINTER(float, rgb, srbf_material_primaries(material, p, 1, rgb));
    CHECK_POINTER(float, rgb, srbf_material_primaries(material, nm, 1, p));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_primaries(material, nm, SIZE_MAX / 2, rgb));
    float one[1];
    CHECK_POINTER(float, rgb, srbf_primaries_of(p, 1, UP, one));
    CHECK_POINTER(float, rgb, srbf_primaries_of(UP, 1, p, one));
    CHECK_POINTER(float, rgb, srbf_primaries_of(UP, 1, UP, p));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_primaries_of(UP, SIZE_MAX, UP, one));
    /* This one has none. */
    CHECK_OK(srbf_material_query(material, &info));
    CHECK(info.factor_nodes[0] == 0 && info.factor_nodes[1] == 0 && info.factor_nodes[2] == 0 && info.largest_factor == 1 && info.has_signed_factors == 0);
    CHECK_OBJECT(srbf_material, material, srbf_material_factor_node(p, 0, 0, 0, rgb));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_factor_node(material, 0, 0, 0, NULL));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_factor_node(material, 0, 0, 0, rgb));
    CHECK_OBJECT(srbf_material, material, srbf_material_view_albedo_difference(p, 0, rgb));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_view_albedo_difference(material, 0, NULL));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_material_view_albedo_difference(material, 0, rgb));
    CHECK_OBJECT(srbf_material, material, srbf_material_albedo(p, UP, rgb));
    CHECK_POINTER(float, rgb, srbf_material_albedo(material, p, rgb));
    CHECK_POINTER(float, rgb, srbf_material_albedo(material, UP, p));

    srbf_mixture *mixture = new_mixture();
    srbf_mixture_info before, after;
    CHECK_OK(srbf_material_prepare(material, UP, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &before));
    CHECK_OBJECT(srbf_material, material, srbf_material_prepare(p, UP, mixture));
    CHECK_POINTER(float, rgb, srbf_material_prepare(material, p, mixture));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_material_prepare(material, UP, p));
    CHECK_OK(srbf_material_prepare_leaving_out(material, UP, 0.0f, 1e-7f, mixture));
    CHECK_OBJECT(srbf_material, material, srbf_material_prepare_leaving_out(p, UP, 0.0f, 0.0f, mixture));
    CHECK_POINTER(float, rgb, srbf_material_prepare_leaving_out(material, p, 0.0f, 0.0f, mixture));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_material_prepare_leaving_out(material, UP, 0.0f, 0.0f, p));
    for (int i = 0; i < 6; i++)
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_prepare_leaving_out(material, BAD[i], 0.0f, 0.0f, mixture));
    const float shares[] = {-0.1f, 1.1f, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_material_prepare_leaving_out(material, UP, shares[i], 0.0f, mixture));
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_material_prepare_leaving_out(material, UP, 0.0f, shares[i], mixture));
    }
    for (int i = 0; i < 6; i++) {
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_prepare(material, BAD[i], mixture));
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_albedo(material, BAD[i], rgb));
    }
    CHECK_OK(srbf_mixture_query(mixture, &after));
    CHECK(before.lobes == after.lobes && before.power == after.power);

    /* An object that is none any more. */
    CHECK_OK(srbf_material_borrow(bytes, size, storage, sizeof storage, &made));
    CHECK_OK(srbf_material_free(made));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_material_query(made, &info));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_material_free(CROOKED(srbf_material, material)));
    free(mixture);
    free(bytes);
    CHECK_OK(srbf_material_free(material));
}

/* Bytes cut at every length and with every byte changed: refused. */
static void test_damaged_bytes(const char *path) {
    size_t size;
    unsigned char *bytes = read_file(path, &size);
    _Alignas(16) unsigned char storage[SRBF_MATERIAL_SIZE];
    srbf_material *made = NULL;
    for (size_t n = 0; n < size; n++) {
        /* A copy of just that size, so that a read past the end is seen. */
        unsigned char *cut = (unsigned char *)malloc(n + (n == 0));
        CHECK(cut != NULL);
        memcpy(cut, bytes, n);
        srbf_status status = srbf_material_borrow(cut, n, storage, sizeof storage, &made);
        CHECK(status == SRBF_STATUS_MAGIC || status == SRBF_STATUS_LENGTH);
        CHECK(srbf_material_from_bytes(cut, n, &made) == status);
        free(cut);
    }
    for (size_t i = 0; i < size; i++) {
        unsigned char old = bytes[i];
        bytes[i] ^= (unsigned char)(1u << (i % 8));
        srbf_status status = srbf_material_borrow(bytes, size, storage, sizeof storage, &made);
        CHECK(status >= SRBF_STATUS_MAGIC && status <= SRBF_STATUS_FIELD);
        CHECK(srbf_material_from_bytes(bytes, size, &made) == status);
        CHECK(strlen(srbf_last_message()) > 0);
        bytes[i] = old;
    }
    CHECK(made == NULL);
    free(bytes);
}

static void test_lobes(void) {
    const srbf_lobe good = {{0, 0, 1}, 10, {1, 1, 1}};
    float *out = guarded(3);
    struct {
        srbf_lobe lobe;
        srbf_status status;
    } bad[] = {
        {{{0, 0, 0}, 10, {1, 1, 1}}, SRBF_STATUS_AXIS},
        {{{NAN, 0, 1}, 10, {1, 1, 1}}, SRBF_STATUS_AXIS},
        {{{0, 0, 2}, 10, {1, 1, 1}}, SRBF_STATUS_AXIS},
        {{{0, 0, 1}, -1, {1, 1, 1}}, SRBF_STATUS_SHARPNESS},
        {{{0, 0, 1}, NAN, {1, 1, 1}}, SRBF_STATUS_SHARPNESS},
        {{{0, 0, 1}, 2e8f, {1, 1, 1}}, SRBF_STATUS_SHARPNESS},
        {{{0, 0, 1}, 10, {1, -1, 1}}, SRBF_STATUS_AMPLITUDE},
        {{{0, 0, 1}, 10, {1, NAN, 1}}, SRBF_STATUS_AMPLITUDE},
        {{{0, 0, 1}, 10, {1, 1, INFINITY}}, SRBF_STATUS_AMPLITUDE},
    };
    srbf_mixture *mixture = new_mixture();
    srbf_mixture_info before, after;
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 1, &good, NULL, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &before));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        srbf_lobe pair[2] = {good, bad[i].lobe};
        CHECK_STATUS(bad[i].status, srbf_mixture_from_lobes(SRBF_DOMAIN_SPHERE, 1, 0, 2, pair, NULL, mixture));
    }
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_inner_product(p, mixture, out));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_inner_product(mixture, p, out));
    CHECK_POINTER(float, out, srbf_mixture_inner_product(mixture, mixture, p));
    srbf_lobe products[4];
    size_t count = 77;
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_product(p, mixture, 4, products, &count));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_product(mixture, p, 4, products, &count));
    CHECK_POINTER(srbf_lobe, products, srbf_mixture_product(mixture, mixture, 4, p, &count));
    CHECK_POINTER(size_t, &count, srbf_mixture_product(mixture, mixture, 4, products, p));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_product(mixture, mixture, 4, (srbf_lobe *)(void *)mixture, &count));
    CHECK(count == 77);
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_mixture_product(mixture, mixture, 0, NULL, &count));
    CHECK(count == 1 || count == 4);
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 0.5f, 1, 1, &good, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_SQUEEZED, srbf_mixture_product(mixture, mixture, 4, products, &count));
    CHECK_STATUS(SRBF_STATUS_SQUEEZED, srbf_mixture_inner_product(mixture, mixture, out));
    CHECK_OK(srbf_mixture_from_lobes(SRBF_DOMAIN_HEMISPHERE, 1, 0, 1, &good, NULL, mixture));
    CHECK(is_untouched(out, 0) && is_untouched(out, 1) && is_untouched(out, 2));

    srbf_lobe many[65];
    for (int i = 0; i < 65; i++) {
        many[i] = good;
    }
    CHECK_STATUS(SRBF_STATUS_CAPACITY, srbf_mixture_from_lobes(0, 1, 0, 17, many, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_CAPACITY, srbf_mixture_from_lobes(0, 1, 0, 65, many, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_CAPACITY, srbf_mixture_from_lobes(0, 1, 0, SIZE_MAX, many, NULL, mixture));
    const float negative[3] = {0, -1, 0};
    CHECK_STATUS(SRBF_STATUS_AMPLITUDE, srbf_mixture_from_lobes(1, 1, 0, 1, &good, negative, mixture));
    CHECK_STATUS(SRBF_STATUS_AMPLITUDE, srbf_mixture_from_lobes(0, 1, 0, 1, &good, UP, mixture));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED,
                 srbf_mixture_from_lobes(1, 1, 0, 1, &good, CROOKED(const float, UP), mixture));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_from_lobes(2, 1, 0, 1, &good, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_from_lobes(0, 1, 2, 1, &good, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_SQUEEZE, srbf_mixture_from_lobes(0, 0, 1, 1, &good, NULL, mixture));
    CHECK_STATUS(SRBF_STATUS_SQUEEZE, srbf_mixture_from_lobes(0, NAN, 1, 1, &good, NULL, mixture));
    CHECK_POINTER(const srbf_lobe, &good, srbf_mixture_from_lobes(0, 1, 0, 1, p, NULL, mixture));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_from_lobes(0, 1, 0, 1, &good, NULL, p));
    /* Finite amplitudes whose integral is not. */
    srbf_lobe huge = {{0, 0, 1}, 0, {3e38f, 3e38f, 3e38f}};
    CHECK_STATUS(SRBF_STATUS_AMPLITUDE, srbf_mixture_from_lobes(0, 1, 0, 1, &huge, NULL, mixture));
    CHECK_OK(srbf_mixture_query(mixture, &after));
    CHECK(before.lobes == after.lobes && before.power == after.power && before.domain == after.domain);
    release(out, 3);
    free(mixture);
}

static void test_single(const srbf_material *material) {
    srbf_mixture *mixture = new_mixture(), *made = NULL;
    srbf_mixture_info info;
    srbf_sample sample;
    srbf_lobe lobe;
    _Alignas(16) unsigned char storage[SRBF_MIXTURE_SIZE_16 + 16];
    float *out = guarded(4);
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_init(NULL, sizeof storage, &made));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_mixture_init(storage + 8, SRBF_MIXTURE_SIZE_16, &made));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_mixture_init(storage, SRBF_MIXTURE_SIZE_16 - 1, &made));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_mixture_init(storage, 0, &made));
    CHECK_POINTER(srbf_mixture *, &made, srbf_mixture_init(storage, sizeof storage, p));
    srbf_mixture **inside = (srbf_mixture **)(void *)(storage + SRBF_MIXTURE_SIZE_16 - sizeof made);
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_init(storage, SRBF_MIXTURE_SIZE_16, inside));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_init(storage, SIZE_MAX, inside));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_init(storage, sizeof storage, (srbf_mixture **)(void *)storage));
    CHECK(made == NULL && srbf_mixture_size(SIZE_MAX) == 0);

    CHECK_OK(srbf_material_prepare(material, UP, mixture));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_query(p, &info));
    CHECK_POINTER(srbf_mixture_info, &info, srbf_mixture_query(mixture, p));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_lobe(p, 0, &lobe));
    CHECK_POINTER(srbf_lobe, &lobe, srbf_mixture_lobe(mixture, 0, p));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_mixture_lobe(mixture, 12, &lobe));
    CHECK_STATUS(SRBF_STATUS_INDEX, srbf_mixture_lobe(mixture, SIZE_MAX, &lobe));

    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_evaluate(p, UP, out));
    CHECK_POINTER(const float, UP, srbf_mixture_evaluate(mixture, p, out));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_evaluate(mixture, BAD[0], out));
    CHECK(strcmp(srbf_last_message(), "wi: a direction must be a finite unit vector") == 0);
    CHECK_POINTER(float, out, srbf_mixture_evaluate(mixture, UP, p));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_pdf(p, UP, out));
    CHECK_POINTER(const float, UP, srbf_mixture_pdf(mixture, p, out));
    CHECK_POINTER(float, out, srbf_mixture_pdf(mixture, UP, p));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_evaluate_and_pdf(p, UP, out, out + 3));
    CHECK_POINTER(const float, UP, srbf_mixture_evaluate_and_pdf(mixture, p, out, out + 3));
    CHECK_POINTER(float, out, srbf_mixture_evaluate_and_pdf(mixture, UP, p, out + 3));
    CHECK_POINTER(float, out, srbf_mixture_evaluate_and_pdf(mixture, UP, out, p));
    CHECK_OBJECT(srbf_mixture, mixture, srbf_mixture_sample(p, U, &sample));
    CHECK_POINTER(const float, U, srbf_mixture_sample(mixture, p, &sample));
    CHECK_POINTER(srbf_sample, &sample, srbf_mixture_sample(mixture, U, p));
    for (int i = 0; i < 6; i++) {
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_evaluate(mixture, BAD[i], out));
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_pdf(mixture, BAD[i], out));
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_evaluate_and_pdf(mixture, BAD[i], out, out + 3));
    }
    const float bad_u[4][3] = {{1, 0.5f, 0.5f}, {0.5f, -0.1f, 0.5f}, {0.5f, 0.5f, NAN}, {INFINITY, 0, 0}};
    for (int i = 0; i < 4; i++) {
        CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample(mixture, bad_u[i], &sample));
    }
    for (int i = 0; i < 4; i++) {
        CHECK(is_untouched(out, i));
    }

    /* The horizon itself, and the ends of the uniform numbers. */
    const float horizon[3] = {1, 0, 0}, ends[2] = {0, 0x1.fffffep-1f};
    CHECK_OK(srbf_mixture_evaluate(mixture, horizon, out));
    CHECK(isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]));
    for (int i = 0; i < 8; i++) {
        const float u[3] = {ends[i & 1], ends[i >> 1 & 1], ends[i >> 2 & 1]};
        CHECK_OK(srbf_mixture_sample(mixture, u, &sample));
        float *d = sample.direction;
        CHECK(fabsf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-5f && d[2] >= 0 && isfinite(sample.pdf));
    }
    /* In and out in one place. */
    float place[4] = {0, 0, 1, 0}, expected[3];
    CHECK_OK(srbf_mixture_evaluate(mixture, UP, expected));
    CHECK_OK(srbf_mixture_evaluate(mixture, place, place));
    CHECK(memcmp(place, expected, sizeof expected) == 0);
    release(out, 4);
    free(mixture);
}

/* Requests: a call with n and a request. */
typedef srbf_status ask(const void *object, size_t n, const srbf_request *request);

static srbf_status ask_one_mixture(const void *object, size_t n, const srbf_request *request) {
    return srbf_mixture_ask((const srbf_mixture *)object, 0, n, request);
}

static srbf_status ask_mixtures(const void *object, size_t n, const srbf_request *request) {
    return srbf_mixture_ask((const srbf_mixture *)object, SRBF_MIXTURE_SIZE_16, n, request);
}

static srbf_status ask_material(const void *object, size_t n, const srbf_request *request) {
    return srbf_material_ask((const srbf_material *)object, n, request);
}

static srbf_status ask_materials(const void *object, size_t n, const srbf_request *request) {
    (void)object;
    return srbf_material_ask(NULL, n, request);
}

static srbf_status ask_expanded(const void *object, size_t n, const srbf_request *request) {
    return srbf_expanded_ask((const srbf_expanded *)object, n, request);
}

/* Every wrong pointer, stride, count and overlap of every array of a request, one at a time; `good` asks for all. */
static void test_request(ask *call, const void *object, const srbf_request *good, size_t n, int has_wo) {
    CHECK_OK(call(object, n, good));
    CHECK_OK(call(object, 0, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, call(object, n, NULL));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, call(object, n, CROOKED(srbf_request, good)));
    srbf_request r = *good;
    for (size_t size = 0; size < 2 * sizeof r; size += sizeof r - 8) {
        r.size = size;
        CHECK_STATUS(SRBF_STATUS_SIZE, call(object, n, &r));
    }
    for (int which = has_wo ? 0 : 1; which < 3; which++) {
        r = *good;
        srbf_vectors *in = which == 0 ? &r.wo : which == 1 ? &r.wi : &r.u;
        const srbf_vectors whole = *in;
        in->y = NULL;
        CHECK_STATUS(SRBF_STATUS_NULL, call(object, n, &r));
        *in = whole, in->z = CROOKED(const float, whole.z);
        CHECK_STATUS(SRBF_STATUS_MISALIGNED, call(object, n, &r));
        *in = whole, in->stride = 0;
        CHECK_STATUS(SRBF_STATUS_STRIDE, call(object, n, &r));
        *in = whole, in->stride = 6;
        CHECK_STATUS(SRBF_STATUS_STRIDE, call(object, n, &r));
        *in = whole, in->stride = SIZE_MAX - 3;
        CHECK_STATUS(SRBF_STATUS_SIZE, call(object, n, &r));
        /* Upon outputs: the first, and the last number of one. */
        *in = whole, in->x = good->pdf.values;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        *in = whole, in->x = good->samples.pdf.values + n - 1;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
    }
    for (int which = 0; which < 3; which++) {
        r = *good;
        srbf_vectors_out *out = which == 0 ? &r.value : which == 1 ? &r.samples.direction : &r.samples.weight;
        const srbf_vectors_out whole = *out;
        out->y = NULL;
        CHECK_STATUS(SRBF_STATUS_NULL, call(object, n, &r));
        *out = whole, out->y = CROOKED(float, whole.y);
        CHECK_STATUS(SRBF_STATUS_MISALIGNED, call(object, n, &r));
        *out = whole, out->stride = 2;
        CHECK_STATUS(SRBF_STATUS_STRIDE, call(object, n, &r));
        /* An output upon another, shifted, upon an input, of other strides, upon the object. */
        *out = whole, out->y = out->x;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        *out = whole, out->y = out->x + n - 1;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        *out = whole, out->z = (float *)(uintptr_t)good->wi.z;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        *out = whole, out->z = (float *)(uintptr_t)good->u.x + 1, r.u.stride = 8;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        r = *good, out->x = (float *)(uintptr_t)object + 8;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
    }
    for (int which = 0; which < 2; which++) {
        r = *good;
        srbf_numbers_out *out = which == 0 ? &r.pdf : &r.samples.pdf;
        out->values = CROOKED(float, out->values);
        CHECK_STATUS(SRBF_STATUS_MISALIGNED, call(object, n, &r));
        r = *good, out->stride = 1;
        CHECK_STATUS(SRBF_STATUS_STRIDE, call(object, n, &r));
        r = *good, out->values = good->value.x + n - 1;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
        r = *good, out->values = (float *)(uintptr_t)good->u.y;
        CHECK_STATUS(SRBF_STATUS_OVERLAP, call(object, n, &r));
    }
    r = *good, r.samples.direction.x = NULL;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, call(object, n, &r));
    CHECK_STATUS(SRBF_STATUS_SIZE, call(object, SIZE_MAX, good));
    CHECK_STATUS(SRBF_STATUS_SIZE, call(object, SIZE_MAX / 8 + 1, good));
}

/* The last mixture may be larger than the stride: an output within what only it holds is refused too. */
static void test_large_last(const srbf_material *material, const srbf_vectors *wo, const srbf_vectors *wi) {
    enum { N = 3 };
    const size_t stride = SRBF_MIXTURE_SIZE_16, size = (N - 1) * stride + SRBF_MIXTURE_SIZE_64 + 64;
    unsigned char *storage = (unsigned char *)aligned_alloc(16, size);
    srbf_mixture *last;
    CHECK(storage != NULL);
    CHECK_OK(srbf_material_prepare_into(material, N, wo, storage, stride));
    CHECK_OK(srbf_mixture_init(storage + (N - 1) * stride, SRBF_MIXTURE_SIZE_64, &last));
    CHECK_OK(srbf_material_prepare(material, UP, last));
    const srbf_mixture *all = (const srbf_mixture *)(const void *)storage;
    srbf_numbers_out within = {(float *)(void *)(storage + N * stride + 16), sizeof(float)};
    srbf_numbers_out behind = {(float *)(void *)(storage + size - 64), sizeof(float)};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_ask(all, stride, N, ASK(.wi = *wi, .pdf = within)));
    CHECK_OK(srbf_mixture_ask(all, stride, N, ASK(.wi = *wi, .pdf = behind)));
    free(storage);
}

/* A material whose object and bytes lie where a call would write: refused, and the material stays whole. */
static void test_upon_material(const srbf_material *original, const srbf_vectors *wo, const srbf_vectors *wi) {
    enum { N = 8 };
    const size_t stride = SRBF_MIXTURE_SIZE_16;
    srbf_material_info info;
    CHECK_OK(srbf_material_query(original, &info));
    const size_t bytes_at = (SRBF_MATERIAL_SIZE + stride + 15) / 16 * 16;
    unsigned char *memory = (unsigned char *)aligned_alloc(16, (bytes_at + info.byte_count + N * stride + 15) / 16 * 16);
    CHECK(memory != NULL);
    memcpy(memory + bytes_at, info.bytes, info.byte_count);
    srbf_material *material;
    CHECK_OK(srbf_material_borrow(memory + bytes_at, info.byte_count, memory, SRBF_MATERIAL_SIZE, &material));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_prepare_into(material, 1, wo, memory, stride));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_prepare_into(material, N, wo, memory + SRBF_MATERIAL_SIZE, stride));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_prepare_into(material, N, wo, memory + bytes_at, stride));
    srbf_numbers_out pdf = {(float *)(void *)(memory + bytes_at), sizeof(float)};
    srbf_numbers_out apart = {(float *)(void *)(memory + SRBF_MATERIAL_SIZE), sizeof(float)};
    float *value = (float *)(void *)(memory + bytes_at + 64);
    srbf_vectors_out values = {value, value + N, value + 2 * N, sizeof(float)};
    srbf_samples_out samples = {values, apart, {value + 3 * N, value + 4 * N, value + 5 * N, sizeof(float)}};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, ASK(.wo = *wo, .wi = *wi, .pdf = pdf)));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, ASK(.wo = *wo, .wi = *wi, .value = values, .pdf = apart)));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, ASK(.wo = *wo, .u = *wi, .samples = samples)));
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = *wo, .wi = *wi, .pdf = apart)));
    CHECK_OK(srbf_material_prepare_into(material, 1, wo, memory + SRBF_MATERIAL_SIZE, stride));
    CHECK(memcmp(memory + bytes_at, info.bytes, info.byte_count) == 0);
    free(memory);
}

static void test_batches(const srbf_material *material) {
    enum { N = 40 };
    float *inputs = guarded(6 * N), *outputs = guarded(11 * N);
    srbf_mixture *mixture = new_mixture();
    CHECK_OK(srbf_material_prepare(material, UP, mixture));
    uint64_t state = 3;
    for (int i = 0; i < 2 * N; i++) {
        float d[3];
        direction(&state, d);
        inputs[i] = fabsf(d[0]), inputs[i + 2 * N] = fabsf(d[1]), inputs[i + 4 * N] = d[2];
    }
    const size_t dense = sizeof(float);
    const srbf_vectors good_in = {inputs, inputs + 2 * N, inputs + 4 * N, dense};
    const srbf_vectors_out good_out = {outputs, outputs + N, outputs + 2 * N, dense};
    const srbf_numbers_out pdf = {outputs + 3 * N, dense};
    const srbf_vectors_out weight = {outputs + 4 * N, outputs + 5 * N, outputs + 6 * N, dense};
    const srbf_vectors_out directions = {outputs + 7 * N, outputs + 8 * N, outputs + 9 * N, dense};
    const srbf_numbers_out density = {outputs + 10 * N, dense};
    float up[3] = {0, 0, 1}, *wos = guarded(3 * N);
    for (int i = 0; i < N; i++) {
        memcpy(wos + 3 * i, up, sizeof up);
    }
    const srbf_vectors wo = {wos, wos + 1, wos + 2, sizeof up};
    const srbf_material *each[N];
    for (int i = 0; i < N; i++) each[i] = material;
    const srbf_request good = {.size = sizeof good, .materials = {each, sizeof each[0]}, .wo = wo, .wi = good_in,
                               .u = {inputs + N, inputs + 3 * N, inputs + 5 * N, dense}, .value = good_out, .pdf = pdf,
                               .samples = {directions, density, weight}};
    const size_t stride = SRBF_MIXTURE_SIZE_16;
    unsigned char *storage = (unsigned char *)aligned_alloc(SRBF_MIXTURE_ALIGNMENT, N * stride);
    CHECK(storage != NULL);
    CHECK_OK(srbf_material_prepare_into(material, N, &wo, storage, stride));
    const srbf_mixture *all = (const srbf_mixture *)(const void *)storage;
    size_t expanded_size;
    CHECK_OK(srbf_expanded_size(material, 2, &expanded_size));
    void *room = malloc(expanded_size);
    srbf_expanded *expanded = NULL;
    CHECK_OK(srbf_expanded_make(material, 2, room, expanded_size, &expanded));
    test_request(ask_one_mixture, mixture, &good, N, 0);
    test_request(ask_mixtures, all, &good, N, 0);
    test_request(ask_material, material, &good, N, 1);
    test_request(ask_materials, material, &good, N, 1);
    test_request(ask_expanded, expanded, &good, N, 1);
    CHECK_OBJECT(const srbf_mixture, mixture, srbf_mixture_ask(p, 0, N, &good));
    CHECK_OBJECT(const srbf_mixture, mixture, srbf_mixture_ask(p, stride, 1, &good));
    CHECK_OBJECT(const srbf_expanded, expanded, srbf_expanded_ask(p, N, &good));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_material_ask(CROOKED(const srbf_material, material), N, &good));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_material_ask((const srbf_material *)(const void *)mixture, N, &good));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_mixture_ask(all, stride + 8, N, &good));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_mixture_ask(all, SIZE_MAX - 15, N, &good));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_mixture_ask(all, stride / 2, N, &good));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_mixture_ask(all, 16, 1, &good));
    srbf_request upon = good;
    upon.pdf.values = (float *)(void *)(storage + (N - 1) * stride);
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_ask(all, stride, N, &upon));
    upon.pdf.values = (float *)(void *)each;
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(NULL, N, &upon));
    test_large_last(material, &wo, &good_in);

    /* Preparing n. */
    CHECK_OBJECT(const srbf_material, material, srbf_material_prepare_into(p, N, &wo, storage, stride));
    CHECK_POINTER(srbf_vectors, &wo, srbf_material_prepare_into(material, N, p, storage, stride));
    CHECK_POINTER(unsigned char, storage, srbf_material_prepare_into(material, N, &wo, p, stride));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_material_prepare_into(material, N, &wo, storage, stride - 16));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_material_prepare_into(material, N, &wo, storage, 0));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_material_prepare_into(material, N, &wo, storage, stride + 4));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_prepare_into(material, SIZE_MAX / 8, &wo, storage, stride));
    srbf_vectors inside = {(float *)(void *)storage, wos, wos, sizeof(float)};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_prepare_into(material, N, &inside, storage, stride));
    CHECK_OK(srbf_material_prepare_into(material, 0, NULL, NULL, 0));
    test_upon_material(material, &wo, &good_in);
    wos[3 * 5] = NAN;
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_prepare_into(material, N, &wo, storage, stride));
    for (int i = 0; i < N; i++) {
        srbf_mixture_info info;
        CHECK_OK(srbf_mixture_query((const srbf_mixture *)(const void *)(storage + (size_t)i * stride), &info));
        CHECK(info.lobes == (i == 5 ? 0 : 12));
    }

    /* Not-a-numbers in a batch do not spread to their neighbours. */
    float *clean = guarded(N), *dirty = guarded(N);
    srbf_numbers_out clean_out = {clean, dense}, dirty_out = {dirty, dense};
    CHECK_OK(srbf_mixture_ask(mixture, 0, N, ASK(.wi = good_in, .pdf = clean_out)));
    const float strange[5] = {NAN, INFINITY, -INFINITY, 1e38f, 0};
    for (int i = 0; i < N; i += 3) {
        inputs[i] = inputs[2 * N + i] = inputs[4 * N + i] = strange[i % 5];
    }
    CHECK_OK(srbf_mixture_ask(mixture, 0, N, ASK(.wi = good_in, .pdf = dirty_out)));
    for (int i = 0; i < N; i++) {
        CHECK(i % 3 == 0 || clean[i] == dirty[i]);
    }
    CHECK_OK(srbf_mixture_ask(mixture, 0, N, &good));
    CHECK_OK(srbf_mixture_ask(all, stride, N, &good));
    CHECK_OK(srbf_material_ask(material, N, &good));

    release(clean, N), release(dirty, N), release(wos, 3 * N);
    release(inputs, 6 * N), release(outputs, 11 * N);
    free(room);
    free(storage);
    free(mixture);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    test_endless();
    test_materials(arguments[1]);
    test_damaged_bytes(arguments[1]);
    test_lobes();
    srbf_material *material;
    CHECK_OK(srbf_material_load(arguments[1], &material));
    test_single(material);
    test_batches(material);
    CHECK_OK(srbf_material_free(material));
    /* No number is without a text. */
    for (srbf_status status = -3; status < 60; status++) {
        CHECK(strlen(srbf_status_text(status)) > 0);
    }
    CHECK(strcmp(srbf_status_text(INT32_MIN), srbf_status_text(INT32_MAX)) == 0);
    printf("abusive use: passed\n");
    return 0;
}
