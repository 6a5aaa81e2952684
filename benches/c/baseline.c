/* The code of a renderer author without the library: a loop over the lobes, `expf`, structure of arrays.
   Compiled twice by build.rs, once with -ffast-math. */
#include <math.h>
#include <stddef.h>

#define PASTE2(a, b) a##b
#define PASTE(a, b) PASTE2(a, b)
#define NAME(x) PASTE(x, SUFFIX)

/* lobes: seven arrays one after the other: x y z sharpness red green blue, each [count]. */

/* The textbook form: one direction after the other, exp(s (cos - 1)). */
void NAME(srbf_baseline_dot_)(const float *lobes, size_t count, const float *x, const float *y, const float *z,
                              float *red, float *green, float *blue, size_t n) {
    for (size_t i = 0; i < n; ++i) {
        float r = 0, g = 0, b = 0;
        for (size_t k = 0; k < count; ++k) {
            float cosine = lobes[k] * x[i] + lobes[count + k] * y[i] + lobes[2 * count + k] * z[i];
            float value = expf(lobes[3 * count + k] * (cosine - 1.0f));
            r += lobes[4 * count + k] * value;
            g += lobes[5 * count + k] * value;
            b += lobes[6 * count + k] * value;
        }
        red[i] = r;
        green[i] = g;
        blue[i] = b;
    }
}

/* The same in chordal form, lobes outermost so that the compiler can vectorise over directions. */
void NAME(srbf_baseline_chord_)(const float *restrict lobes, size_t count, const float *restrict x,
                                const float *restrict y, const float *restrict z, float *restrict red,
                                float *restrict green, float *restrict blue, size_t n) {
    for (size_t i = 0; i < n; ++i) red[i] = green[i] = blue[i] = 0;
    for (size_t k = 0; k < count; ++k) {
        float ax = lobes[k], ay = lobes[count + k], az = lobes[2 * count + k], s = -0.5f * lobes[3 * count + k];
        float ar = lobes[4 * count + k], ag = lobes[5 * count + k], ab = lobes[6 * count + k];
        for (size_t i = 0; i < n; ++i) {
            float dx = x[i] - ax, dy = y[i] - ay, dz = z[i] - az;
            float value = expf(s * (dx * dx + dy * dy + dz * dz));
            red[i] += ar * value;
            green[i] += ag * value;
            blue[i] += ab * value;
        }
    }
}

/* The textbook form, lobes outermost: the fastest that the compiler makes of it. */
void NAME(srbf_baseline_dot_lobes_)(const float *restrict lobes, size_t count, const float *restrict x,
                                    const float *restrict y, const float *restrict z, float *restrict red,
                                    float *restrict green, float *restrict blue, size_t n) {
    for (size_t i = 0; i < n; ++i) red[i] = green[i] = blue[i] = 0;
    for (size_t k = 0; k < count; ++k) {
        float ax = lobes[k], ay = lobes[count + k], az = lobes[2 * count + k], s = lobes[3 * count + k];
        float ar = lobes[4 * count + k], ag = lobes[5 * count + k], ab = lobes[6 * count + k];
        for (size_t i = 0; i < n; ++i) {
            float value = expf(s * (ax * x[i] + ay * y[i] + az * z[i] - 1.0f));
            red[i] += ar * value;
            green[i] += ag * value;
            blue[i] += ab * value;
        }
    }
}
