/* Shared by the C tests: checks that say where they failed, guard zones, and a material to work with. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <srbf.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                        \
    do {                                                                                        \
        if (!(condition)) {                                                                     \
            fprintf(stderr, "%s:%d: failed: %s (last message: %s)\n", __FILE__, __LINE__,       \
                    #condition, srbf_last_message());                                           \
            exit(1);                                                                            \
        }                                                                                       \
    } while (0)

/* The call returns the status, by name. */
#define CHECK_STATUS(expected, call)                                                            \
    do {                                                                                        \
        srbf_status got_ = (call);                                                              \
        if (got_ != (expected)) {                                                               \
            fprintf(stderr, "%s:%d: %s: %d (%s), not %s\n", __FILE__, __LINE__, #call,          \
                    (int)got_, srbf_status_text(got_), #expected);                              \
            exit(1);                                                                            \
        }                                                                                       \
    } while (0)

#define CHECK_OK(call) CHECK_STATUS(SRBF_STATUS_OK, call)

/* With SHORT, for tools under which a program takes fifty times as long: loops have a twentieth of their rounds, and means and integrals, which
 * need all of them, are not held. */
#ifdef SHORT
#define MANY(rounds) ((rounds) / 20)
#define CHECK_MEAN(condition) ((void)(condition))
#else
#define MANY(rounds) (rounds)
#define CHECK_MEAN(condition) CHECK(condition)
#endif

/* A request: an output that is not named is not wanted. */
#define ASK(...) (&(const srbf_request){.size = sizeof(srbf_request), __VA_ARGS__})

/* Numbers between two zones of a pattern that must stay. */
#define ZONE 16
#define PATTERN 0x7fc0dead /* a NaN that no computation makes */

static inline float *guarded(size_t n) {
    uint32_t *memory = (uint32_t *)malloc((n + 2 * ZONE) * sizeof(uint32_t));
    CHECK(memory != NULL);
    for (size_t i = 0; i < n + 2 * ZONE; i++) {
        memory[i] = PATTERN;
    }
    return (float *)(void *)(memory + ZONE);
}

/* Number `i`, counted from the start of the guarded array, still holds the pattern. */
static inline int is_untouched(const float *numbers, ptrdiff_t i) {
    uint32_t bits;
    memcpy(&bits, numbers + i, sizeof bits);
    return bits == PATTERN;
}

static inline void check_zones(const float *numbers, size_t n) {
    for (ptrdiff_t i = 1; i <= ZONE; i++) {
        CHECK(is_untouched(numbers, -i));
        CHECK(is_untouched(numbers, (ptrdiff_t)n + i - 1));
    }
}

static inline void release(float *numbers, size_t n) {
    check_zones(numbers, n);
    free(numbers - ZONE);
}

static inline unsigned char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    CHECK(fseek(file, 0, SEEK_END) == 0);
    long end = ftell(file);
    CHECK(end > 0 && fseek(file, 0, SEEK_SET) == 0);
    unsigned char *bytes = (unsigned char *)malloc((size_t)end);
    CHECK(bytes != NULL && fread(bytes, 1, (size_t)end, file) == (size_t)end);
    fclose(file);
    *size = (size_t)end;
    return bytes;
}

/* Uniform numbers in [0, 1): PCG32 (O'Neill 2014). */
static inline float uniform(uint64_t *state) {
    uint64_t old = *state;
    *state = old * 6364136223846793005u + 1442695040888963407u;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27), turn = (uint32_t)(old >> 59);
    uint32_t bits = (shifted >> turn) | (shifted << ((32 - turn) & 31));
    return (float)(bits >> 8) * 0x1p-24f;
}

/* A direction above the horizon. */
static inline void direction(uint64_t *state, float d[3]) {
    float z = 1 - uniform(state), phi = 6.2831853f * uniform(state), r = sqrtf(1 - z * z);
    d[0] = r * cosf(phi), d[1] = r * sinf(phi), d[2] = z;
}

#endif
