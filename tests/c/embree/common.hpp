/* Shared by the parts of the path tracer: vectors, errors, random numbers. */
#ifndef COMMON_HPP
#define COMMON_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <srbf.hpp>
#include <string>

struct V {
    float x, y, z;
};
inline V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V operator*(V a, V b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline V operator*(V a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline float dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline V normalize(V a) { return a * (1 / std::sqrt(dot(a, a))); }
inline float largest(V a) { return std::max({a.x, a.y, a.z}); }
inline float luminance(V a) { return 0.2126f * a.x + 0.7152f * a.y + 0.0722f * a.z; }

/* The weight of a sample that was drawn with density `own`, beside another technique. */
inline float power_heuristic(float own, float other) { return 1 / (1 + (other / own) * (other / own)); }

inline const float PI = 3.14159265f;

[[noreturn]] inline void fail(const std::string &what) {
    std::fprintf(stderr, "embree: %s (%s)\n", what.c_str(), srbf::last_message());
    std::exit(1);
}
inline void check(srbf::Status status) {
    if (status) fail(status.text());
}

/* PCG32 (O'Neill 2014), a sequence of its own for every pixel. */
struct Random {
    uint64_t state, stream;
    explicit Random(uint64_t seed) : state(seed * 0x9e3779b97f4a7c15u), stream(2 * seed + 1) { unit(), unit(); }
    float unit() {
        const uint64_t old = state;
        state = old * 6364136223846793005u + stream;
        const uint32_t shifted = uint32_t(((old >> 18) ^ old) >> 27), turn = uint32_t(old >> 59);
        return float(((shifted >> turn) | (shifted << ((32 - turn) & 31))) >> 8) * 0x1p-24f;
    }
};

#endif
