/* The C interface without an operating system, a C library or an allocator: its own _start, memory functions and exit.
 * `material.h` is a `.srbf` file as an array, made by the check. Exit status 0 if everything worked. */
#define SRBF_FREESTANDING
#include <srbf.h>

#if defined(SRBF_HOSTED)
#error "SRBF_FREESTANDING must hide the hosted part"
#endif

static const unsigned char material_bytes[] = {
#include "material.h"
};

/* All that may stay undefined in the library. */
void *memcpy(void *to, const void *from, size_t n) {
    unsigned char *t = to;
    for (const unsigned char *f = from; n > 0; n--) {
        *t++ = *f++;
    }
    return to;
}

void *memmove(void *to, const void *from, size_t n) {
    unsigned char *t = to;
    const unsigned char *f = from;
    if (t < f) {
        return memcpy(to, from, n);
    }
    while (n-- > 0) {
        t[n] = f[n];
    }
    return to;
}

void *memset(void *to, int value, size_t n) {
    for (unsigned char *t = to; n > 0; n--) {
        *t++ = (unsigned char)value;
    }
    return to;
}

int memcmp(const void *a, const void *b, size_t n) {
    const unsigned char *x = a, *y = b;
    for (; n > 0; n--, x++, y++) {
        if (*x != *y) {
            return *x < *y ? -1 : 1;
        }
    }
    return 0;
}

int bcmp(const void *a, const void *b, size_t n) {
    return memcmp(a, b, n);
}

static _Noreturn void quit(long status) {
    __asm__ volatile("syscall" : : "a"(60L), "D"(status) : "rcx", "r11", "memory");
    __builtin_unreachable();
}

#define CHECK(condition)       \
    do {                       \
        if (!(condition)) {    \
            quit(__LINE__ % 255 + 1); \
        }                      \
    } while (0)

static int is_near(float a, float b) {
    float difference = a < b ? b - a : a - b;
    return difference <= 1e-3f * a + 1e-7f;
}

static void run(void) {
    _Alignas(SRBF_MATERIAL_ALIGNMENT) unsigned char material_storage[SRBF_MATERIAL_SIZE];
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char mixture_storage[SRBF_MIXTURE_SIZE_64];
    srbf_material *material;
    srbf_mixture *mixture;
    const float wo[3] = {0.6f, 0, 0.8f};
    CHECK(srbf_version() == SRBF_VERSION && srbf_status_text(SRBF_STATUS_OK)[0] == 's');
    CHECK(srbf_material_borrow(material_bytes, sizeof material_bytes, material_storage, sizeof material_storage,
                               &material) == SRBF_STATUS_OK);
    CHECK(srbf_mixture_init(mixture_storage, sizeof mixture_storage, &mixture) == SRBF_STATUS_OK);
    CHECK(srbf_material_prepare(material, wo, mixture) == SRBF_STATUS_OK);
    float u[3][64], drawn[7][64], pdf[64];
    for (int i = 0; i < 64; i++) {
        u[0][i] = ((float)i + 0.5f) / 64, u[1][i] = (float)(i * 29 % 64) / 64, u[2][i] = (float)(i * 23 % 64) / 64;
    }
    const size_t dense = sizeof(float);
    srbf_vectors in = {u[0], u[1], u[2], dense};
    srbf_samples_out out = {
        {drawn[0], drawn[1], drawn[2], dense}, {drawn[3], dense}, {drawn[4], drawn[5], drawn[6], dense}};
    srbf_vectors wi = {drawn[0], drawn[1], drawn[2], dense};
    srbf_numbers_out pdf_out = {pdf, dense};
    CHECK(srbf_mixture_ask(mixture, 0, 64, &(srbf_request){.size = sizeof(srbf_request), .u = in, .samples = out}) == SRBF_STATUS_OK);
    CHECK(srbf_mixture_ask(mixture, 0, 64, &(srbf_request){.size = sizeof(srbf_request), .wi = wi, .pdf = pdf_out}) == SRBF_STATUS_OK);
    for (int i = 0; i < 64; i++) {
        const float one[3] = {u[0][i], u[1][i], u[2][i]};
        srbf_sample sample;
        CHECK(srbf_mixture_sample(mixture, one, &sample) == SRBF_STATUS_OK);
        CHECK(sample.pdf > 0 && is_near(sample.pdf, drawn[3][i]) && is_near(sample.pdf, pdf[i]));
        CHECK(sample.direction[2] >= 0);
    }
    CHECK(srbf_mixture_sample(mixture, NULL, NULL) == SRBF_STATUS_NULL);
    CHECK(srbf_material_borrow(material_bytes, sizeof material_bytes - 1, material_storage, sizeof material_storage,
                               &material) == SRBF_STATUS_LENGTH);
    quit(0);
}

/* The stack is aligned to 16 here, and to 8 in a function that was called. */
__attribute__((naked)) void _start(void) {
    __asm__("call start_with_a_stack");
}

__attribute__((used)) void start_with_a_stack(void) {
    run();
}
