// Against the library: value and density within 3e-4, the density at a draw within 5e-4. Processors of little-endian words.
#pragma once
#ifdef __CUDACC_RTC__
typedef unsigned int uint32_t;
#else
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#endif
#ifdef __CUDACC__
#define SRBF_FN __host__ __device__ inline
// On a GPU a lobe is made where it is used: an array of them would not fit in registers.
#define SRBF_LOBES
#define SRBF_LOBE(m, v, k) srbf_lobe(m, v, k)
#define SRBF_KEEP(v, k, l)
#else
#define SRBF_FN inline
// On a processor a view keeps its lobes.
#define SRBF_LOBES SrbfLobe lobe[64];
#define SRBF_LOBE(m, v, k) (v).lobe[k]
#define SRBF_KEEP(v, k, l) (v).lobe[k] = l
#endif

namespace srbf_device {

struct vec3 {
    float x, y, z;
    SRBF_FN vec3() {}
    SRBF_FN vec3(float x, float y, float z) : x(x), y(y), z(z) {}
};
SRBF_FN vec3 operator+(vec3 a, vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
SRBF_FN vec3 operator-(vec3 a, vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
SRBF_FN vec3 operator*(vec3 a, vec3 b) { return vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
SRBF_FN vec3 operator*(vec3 a, float b) { return vec3(a.x * b, a.y * b, a.z * b); }
SRBF_FN vec3 operator*(float a, vec3 b) { return b * a; }
SRBF_FN float srbf_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SRBF_FN float srbf_min(float a, float b) { return a < b ? a : b; }
SRBF_FN float srbf_max(float a, float b) { return a > b ? a : b; }
SRBF_FN int srbf_min(int a, int b) { return a < b ? a : b; }
// Of a NaN `low`.
SRBF_FN float srbf_clamp(float a, float low, float high) { return srbf_min(srbf_max(a, low), high); }
SRBF_FN int srbf_clamp(int a, int low, int high) { return a < low ? low : srbf_min(a, high); }
SRBF_FN float srbf_sqrt(float a) { return ::sqrtf(a); }
// Of numbers within those of an int.
SRBF_FN float srbf_floor(float a) {
    float whole = float(int(a));
    return whole - (whole > a ? 1.0f : 0.0f);
}
SRBF_FN float srbf_log(float a) { return ::logf(a); }
SRBF_FN float srbf_abs(float a) { return ::fabsf(a); }
SRBF_FN float srbf_bits(uint32_t u) {
#ifdef __CUDA_ARCH__
    return __uint_as_float(u);
#else
    float f;
    memcpy(&f, &u, 4);
    return f;
#endif
}
#ifdef __CUDA_ARCH__
SRBF_FN float srbf_exp2(float a) { return ::exp2f(a); }
#else
// Below 128; 0 below -100, so that no product of it is subnormal, which is slow. To 2e-7 of it, in a third of the time of the C library's.
SRBF_FN float srbf_exp2(float a) {
    bool is_none = a < -100.0f;
    a = srbf_max(a, -100.0f);
    int whole = int(a + (a < 0.0f ? -0.5f : 0.5f));
    float f = a - float(whole);
    float p = 1.0f + f * (0.693147181f + f * (0.240226507f + f * (0.0555041087f + f * (0.00961812911f + f * (0.00133335581f + f * 0.000154035304f)))));
    return is_none ? 0.0f : p * srbf_bits(uint32_t(whole + 127) << 23);
}
#endif

