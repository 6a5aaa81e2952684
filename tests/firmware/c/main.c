/* A Cortex-M4F in C: the preset in flash, through srbf.h and the static library, without a C library. Prints the checksums that
 * src/road.rs does. `material.h` is a `.srbf` file as an array, made by the check. */
#define SRBF_FREESTANDING
#include <srbf.h>

_Alignas(4) static const unsigned char material_bytes[] = {
#include "material.h"
};

extern uint32_t stack_high, bss_start, bss_end, data_start, data_end, data_from;

/* Asks the emulator. */
static void semihosting(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void text(const char *text) {
    semihosting(4, text);
}

static _Noreturn void end(uint32_t status) {
    const uint32_t argument[2] = {0x20026, status};
    for (;;) {
        semihosting(0x20, argument);
    }
}

static void fault(void) {
    text("the processor reports a fault\n");
    end(1);
}

static void check(srbf_status status) {
    if (status != SRBF_STATUS_OK) {
        text(srbf_status_text(status));
        text("\n");
        end(2);
    }
}

static uint32_t state = 1;

static float uniform(void) {
    state = state * 1664525u + 1013904223u;
    return (float)(state >> 8) * (1.0f / 16777216.0f);
}

static void three(float u[3]) {
    for (int i = 0; i < 3; i++) {
        u[i] = uniform();
    }
}

static void direction(float d[3]) {
    for (;;) {
        float x = 2 * uniform() - 1, y = 2 * uniform() - 1;
        float squared = x * x + y * y;
        if (squared < 1) {
            float scale = 1 / (1 + squared);
            d[0] = 2 * x * scale, d[1] = 2 * y * scale, d[2] = (1 - squared) * scale;
            return;
        }
    }
}

/* FNV-1a over the bits of numbers. */
static void add(uint32_t *sum, const float *numbers, int count) {
    for (int i = 0; i < count; i++) {
        union {
            float number;
            unsigned char bytes[4];
        } bits = {numbers[i]};
        for (int j = 0; j < 4; j++) {
            *sum = (*sum ^ bits.bytes[j]) * 0x01000193u;
        }
    }
}

static void add_sample(uint32_t *sum, const srbf_sample *sample) {
    add(sum, sample->direction, 3);
    add(sum, &sample->pdf, 1);
    add(sum, sample->weight, 3);
}

static void run(void) {
    static _Alignas(SRBF_MATERIAL_ALIGNMENT) unsigned char material_storage[SRBF_MATERIAL_SIZE];
    static _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char mixture_storage[SRBF_MIXTURE_SIZE_16];
    srbf_material *material;
    srbf_mixture *mixture;
    check(srbf_material_borrow(material_bytes, sizeof material_bytes, material_storage, sizeof material_storage, &material));
    check(srbf_mixture_init(mixture_storage, sizeof mixture_storage, &mixture));
    uint32_t sums[4] = {0x811c9dc5u, 0x811c9dc5u, 0x811c9dc5u, 0x811c9dc5u};
    for (int o = 0; o < 24; o++) {
        float wo[3], wi[3], u[3], value[3], pdf;
        direction(wo);
        check(srbf_material_prepare(material, wo, mixture));
        for (int i = 0; i < 12; i++) {
            srbf_sample sample;
            direction(wi);
            three(u);
            check(srbf_mixture_evaluate(mixture, wi, value));
            add(&sums[0], value, 3);
            check(srbf_mixture_pdf(mixture, wi, &pdf));
            add(&sums[1], &pdf, 1);
            check(srbf_mixture_sample(mixture, u, &sample));
            add_sample(&sums[2], &sample);
            check(srbf_material_sample_and_evaluate(material, wo, u, &sample, wi, value, &pdf));
            add_sample(&sums[3], &sample);
            add(&sums[3], value, 3);
            add(&sums[3], &pdf, 1);
        }
    }
    static const char *const names[4] = {"values", "densities", "draws", "hits"};
    for (int i = 0; i < 4; i++) {
        char digits[] = "        \n";
        for (int j = 0; j < 8; j++) {
            digits[j] = "0123456789abcdef"[sums[i] >> (28 - 4 * j) & 15];
        }
        text("checksum of ");
        text(names[i]);
        text(" ");
        text(digits);
    }
}

/* After the floating point unit has been switched on. */
__attribute__((noinline)) static _Noreturn void start(void) {
    run();
    end(0);
}

void reset(void) {
    for (uint32_t *to = &data_start, *from = &data_from; to < &data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end;) {
        *to++ = 0;
    }
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20;
    __asm__ volatile("dsb\n isb");
    start();
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_high, (const void *)reset, (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault,
    (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault,
    (const void *)fault, (const void *)fault, (const void *)fault, (const void *)fault,
};
