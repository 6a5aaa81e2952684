// A material of srbf in C++17 and CUDA without the library. Written by `srbf export`. How it is called:
//
//     std::vector<uint32_t> words = ...;                                                                        // the bytes of a .srbf file, as they are
//     if (srbf_device::srbf_check(words.data(), words.size()) != 0) return fail();                              // on the processor
//     srbf_device::SrbfMaterial material = srbf_device::srbf_material(words.data());                            // once
//     srbf_device::SrbfView view = srbf_device::srbf_prepare(material, wo);                                     // at every hit
//     srbf_device::SrbfSample drawn = srbf_device::srbf_sample(material, view, srbf_device::vec3(u0, u1, u2));  // a random direction: wi, pdf, weight = f cos / pdf
//     srbf_device::SrbfValue light = srbf_device::srbf_evaluate(material, view, wi);                            // light from wi: value = f cos, pdf
//     srbf_device::vec3 albedo = srbf_device::srbf_albedo(material, view);                                      // light from everywhere
//
// wo and wi are unit vectors towards viewer and light, in the frame of the surface, whose z axis is the normal. u0, u1 and u2 are
// random numbers from 0 to 1.
// Nothing is yours to define.
//
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

// A material, evaluated and drawn from by the bytes of its .srbf file (versions 2 and 3), which are read in place as little-endian words
// of 32 bits. Directions are unit vectors in the shading frame, +z the normal; wo towards the viewer, wi towards the light. Values are f cos,
// the BRDF times the cosine of wi, in linear sRGB, 1/sr; densities are per solid angle, 1/sr.

struct SrbfMaterial {       // numbers of the header
    const uint32_t *data;              // where the words are
    int angles;             // of the views from the normal
    int views;
    int azimuths;           // views of a ring round the normal; 0 in an isotropic material, where a ring is one view
    float turn_views;       // views of a full turn
    bool is_mirrored;       // whether they stand over a quarter of it, and have mirror images elsewhere
    float axis_x;           // cosine and sine of the azimuth from which theirs count
    float axis_y;
    int lobes;
    int squeezed;           // the first lobes
    int mirrored;           // the last lobes, each of which stands for two
    int heads;              // words before the heads of the views,
    int head;               // and of one head;
    int rows;               // before the rows of the views,
    int row;                // and of those of one view;
    int numbers;            // before the numbers of the lobes that are not their angles, within the rows;
    int differences;        // before the changes of the albedos by the factors,
    int nodes;              // and before the nodes of the factors
    int node_bits;          // of a channel of a node, in one word if 10, in three bytes if 8
    float node_unit;        // unit of a code, before it is squared
    int half_nodes;         // nodes along the half angle, or 0
    int difference_nodes;   // along the difference angle
    int azimuth_nodes;      // and along the squared cosine of the azimuth,
    bool has_sign;          // which has the sign of the cosine, from -1
};

struct SrbfLobe { vec3 axis; float sharpness; float y; vec3 colour; float integral; };  // y is its luminance

struct SrbfView {           // the mixture for one wo
    vec3 wo;
    float turn_x;
    float turn_y;           // cosine and sine of the azimuth of the plane of incidence, away from wo
    float along_x;
    float along_y;          // the same from the axis of the views, of the image in the first quarter where there are mirrors
    float image;            // -1 where the mixture is the mirror image of that one
    float tilt_x;
    float tilt_y;           // those of the angle from it to the frame of the lobes
    int within_before;      // the views round wo, of the ring within and of the one beyond
    int within_after;
    int beyond_before;
    int beyond_after;
    float onward;           // how far between before and after,
    float outward;          // and between within and beyond
    vec3 squeeze;           // what squeezed lobes see is multiplied by this
    float diffuse_y;        // luminance of the diffuse albedo
    vec3 diffuse;
    vec3 albedo;            // without factors
    float lobes_power;      // luminance of the albedo: of the lobes,
    float power;            // and with the diffuse term
    SRBF_LOBES
};

struct SrbfValue { vec3 value; float pdf; };
struct SrbfSample { vec3 wi; float pdf; vec3 weight; };
struct SrbfAngle { float s; float c; };  // sine and cosine

SRBF_FN int srbf_int(const uint32_t *data, int i) { return int(data[i]); }
SRBF_FN float srbf_float(const uint32_t *data, int i) { return srbf_bits(data[i]); }

// A number from 0 on as a place up to `most`. Where a compiler forgets that there are NaN, whatever it makes of one is a place too.
SRBF_FN int srbf_index(float x, int most) { return srbf_clamp(int(x), 0, most); }

// Words before the content of a block of a file of version 3, by its tag; 0 without one. A block is tag, bytes, content; behind the last one
// the checksum is the last word.
SRBF_FN int srbf_block(const uint32_t *data, int tag) {
    int end = srbf_int(data, 4) / 4 - 1;
    int at = (srbf_int(data, 2) == 3 ? 10 : end);
    while (at < end && srbf_int(data, at) != tag) { at += 2 + (srbf_int(data, at + 1) + 3) / 4; }
    return (at < end ? at + 2 : 0);
}

// Of angles from -pi to pi, to 1e-7. Built-in ones may be 5e-4 off, which sharp lobes show.
SRBF_FN SrbfAngle srbf_sin_cos(float angle) {
    float quarters = srbf_floor(angle * 0.636619772f + 0.5f);
    float a = (angle - quarters * 1.57079637f) + quarters * 4.37113883e-8f;
    float q = a * a;
    float s = a + a * q * (-1.0f / 6.0f + q * (1.0f / 120.0f + q * (-1.0f / 5040.0f + q / 362880.0f)));
    float c = 1.0f + q * (-0.5f + q * (1.0f / 24.0f + q * (-1.0f / 720.0f + q / 40320.0f)));
    bool is_odd = srbf_abs(quarters) == 1.0f;
    SrbfAngle r;
    r.s = (is_odd ? quarters * c : (quarters == 0.0f ? s : -s));
    r.c = (is_odd ? -quarters * s : (quarters == 0.0f ? c : -c));
    return r;
}

SRBF_FN SrbfMaterial srbf_material(const uint32_t *data) {
    SrbfMaterial m;
    bool is_line = srbf_int(data, 3) == 0;
    bool is_old = srbf_int(data, 2) == 2;
    int ring = (is_old ? 9 : 8);
    m.data = data;
    m.angles = srbf_int(data, 5);
    m.lobes = srbf_int(data, 6);
    m.squeezed = srbf_int(data, 7);
    m.mirrored = (is_line ? srbf_int(data, ring) : 0);
    m.azimuths = (is_line ? 0 : srbf_int(data, ring));
    int turns = (is_line ? 0 : srbf_int(data, ring + 1) & 65535);
    m.is_mirrored = turns == 4;
    m.turn_views = float(turns * (m.is_mirrored ? m.azimuths - 1 : m.azimuths));
    SrbfAngle axis = srbf_sin_cos((is_line ? 0.0f : float((srbf_int(data, ring + 1) >> 16) & 65535) * 4.79368996e-5f));
    m.axis_x = axis.c;
    m.axis_y = axis.s;
    m.views = (is_line ? m.angles : 1 + (m.angles - 1) * m.azimuths);
    m.heads = 12 + m.angles;
    m.head = (is_line ? 4 : 6);
    m.rows = m.heads + m.head * m.views;
    m.row = (is_line ? 5 * m.lobes + m.mirrored : 6 * m.lobes);
    m.numbers = m.rows + (is_line ? m.lobes : 2 * m.lobes);
    m.differences = m.rows + m.views * m.row;
    m.node_bits = 10;
    m.node_unit = 1.0f / 360.0f;
    m.half_nodes = srbf_int(data, 11) & 65535;
    m.difference_nodes = srbf_int(data, 11) >> 16;
    m.azimuth_nodes = 1;
    m.has_sign = false;
    if (!is_old) {
        int at = srbf_block(data, 1413693766);
        int nodes = (at > 0 ? srbf_int(data, at) : 0);
        m.half_nodes = nodes & 255;
        m.difference_nodes = (nodes >> 8) & 255;
        m.azimuth_nodes = (nodes >> 16) & 255;
        m.has_sign = (nodes >> 24) == 1;
        m.differences = at + 1;
        m.node_bits = 8;
        if (m.half_nodes > 0) { m.node_unit = srbf_sqrt(srbf_float(data, m.differences + 3 * m.views)) / 255.0f; }
    }
    m.nodes = m.differences + 3 * m.views + 1;
    return m;
}

// The angle of a unit vector from z >= 0, at most pi / 2: 2 atan(t) by Hastings (Abramowitz and Stegun 4.4.49), to 5e-8.
SRBF_FN float srbf_angle(float across, float z) {
    float t = across / (1.0f + z);
    float q = t * t;
    return 2.0f * t * (1.0f + q * (-0.3333314528f + q * (0.1999355085f + q * (-0.1420889944f + q * (0.1065626393f + q * (-0.0752896400f + q * (0.0429096138f + q * (-0.0161657367f + q * 0.0028662257f))))))));
}

// Red, green and blue over the luminance, of (R - Y) / Y and (B - Y) / Y.
SRBF_FN vec3 srbf_colour(float rho, float beta) {
    return vec3(1.0f + rho, 1.0f - (0.2126f * rho + 0.0722f * beta) / 0.7152f, 1.0f + beta);
}

// 1 - exp(-2 s)
SRBF_FN float srbf_inside(float s) {
    return (s < 0.05f ? 2.0f * s * (1.0f - s * (1.0f - s * (0.66666667f - s * (0.33333333f - s * 0.13333333f)))) : 1.0f - srbf_exp2(-2.88539008f * s));
}

// A number of the views before and after, interpolated.
SRBF_FN float srbf_along(const SrbfMaterial &m, const SrbfView &v, int before, int after, int i) {
    float a = srbf_float(m.data, before + i);
    return a + (srbf_float(m.data, after + i) - a) * v.onward;
}

SRBF_FN float srbf_within(const SrbfMaterial &m, const SrbfView &v, int start, int size, int i) {
    return srbf_along(m, v, start + v.within_before * size, start + v.within_after * size, i);
}

SRBF_FN float srbf_beyond(const SrbfMaterial &m, const SrbfView &v, int start, int size, int i) {
    return srbf_along(m, v, start + v.beyond_before * size, start + v.beyond_after * size, i);
}

// A number of all views round wo, interpolated.
SRBF_FN float srbf_between(const SrbfMaterial &m, const SrbfView &v, int start, int size, int i) {
    float a = srbf_within(m, v, start, size, i);
    if (v.outward > 0.0f) { a += (srbf_beyond(m, v, start, size, i) - a) * v.outward; }
    return a;
}

// Lobe k, at most lobes + mirrored; the last ones are the images of the mirrored ones.
SRBF_FN SrbfLobe srbf_lobe(const SrbfMaterial &m, const SrbfView &v, int k) {
    int j = (k < m.lobes ? k : k - m.mirrored);
    float x = srbf_within(m, v, m.rows, m.row, j);
    SrbfLobe lobe;
    if (m.azimuths > 0) {
        float y = srbf_within(m, v, m.rows, m.row, m.lobes + j);
        if (v.within_before == 0) {  // the normal's view, which is written in the frame of the surface
            float turned = x * v.along_x + y * v.along_y;
            y = y * v.along_x - x * v.along_y;
            x = turned;
        }
        x += (srbf_beyond(m, v, m.rows, m.row, j) - x) * v.outward;
        y = (y + (srbf_beyond(m, v, m.rows, m.row, m.lobes + j) - y) * v.outward) * v.image;
        float angle = srbf_sqrt(x * x + y * y);
        SrbfAngle a = srbf_sin_cos(angle);
        float scale = a.s / srbf_max(angle, 1e-30f);
        lobe.axis = vec3((x * v.tilt_x + y * v.tilt_y) * scale, (y * v.tilt_x - x * v.tilt_y) * scale, srbf_abs(a.c));
        vec3 seen = lobe.axis * v.squeeze;
        lobe.axis = (k < m.squeezed ? seen * (1.0f / srbf_sqrt(srbf_dot(seen, seen))) : lobe.axis);
    } else {
        SrbfAngle a = srbf_sin_cos(x);
        lobe.axis = vec3(a.s, 0.0f, srbf_abs(a.c));
        if (j >= m.lobes - m.mirrored) {
            SrbfAngle o = srbf_sin_cos(srbf_within(m, v, m.rows, m.row, 4 * m.lobes + m.mirrored + j));
            lobe.axis = vec3(a.s * o.c, (k < m.lobes ? o.s : -o.s), srbf_abs(a.c * o.c));
        }
    }
    lobe.sharpness = srbf_max(srbf_exp2(srbf_between(m, v, m.numbers, m.row, j)), 1e-7f);
    lobe.y = srbf_exp2(srbf_between(m, v, m.numbers, m.row, m.lobes + j));
    lobe.colour = srbf_colour(srbf_between(m, v, m.numbers, m.row, 2 * m.lobes + j), srbf_between(m, v, m.numbers, m.row, 3 * m.lobes + j));
    lobe.integral = 6.28318531f * srbf_inside(lobe.sharpness) / lobe.sharpness;
    return lobe;
}

// Finds the views round wo, and how far between them it lies.
SRBF_FN SrbfView srbf_place(const SrbfMaterial &m, vec3 wo) {
    SrbfView v;
    // Any vector but a direction above the horizon has the numbers of the normal, and reflects nothing.
    bool is_above = wo.z >= 0.0f && srbf_abs(srbf_dot(wo, wo) - 1.0f) < 0.5f;
    v.wo = (is_above ? wo : vec3(0.0f, 0.0f, -1.0f));
    vec3 d = (is_above ? wo : vec3(0.0f, 0.0f, 1.0f));
    float across = srbf_sqrt(d.x * d.x + d.y * d.y);
    v.turn_x = (across > 1e-18f ? -d.x / srbf_max(across, 1e-18f) : 1.0f);
    v.turn_y = (across > 1e-18f ? -d.y / srbf_max(across, 1e-18f) : 0.0f);
    v.along_x = v.turn_x * m.axis_x + v.turn_y * m.axis_y;
    v.along_y = v.turn_y * m.axis_x - v.turn_x * m.axis_y;
    v.image = (m.is_mirrored && (v.along_x < 0.0f) != (v.along_y < 0.0f) ? -1.0f : 1.0f);
    v.along_x = (m.is_mirrored ? -srbf_abs(v.along_x) : v.along_x);
    v.along_y = (m.is_mirrored ? -srbf_abs(v.along_y) : v.along_y);
    float theta = srbf_angle(across, d.z);
    int before = 0;
    int after = m.angles - 1;
    while (after - before > 1) {
        int middle = (before + after) / 2;
        if (srbf_float(m.data, 12 + middle) <= theta) { before = middle; } else { after = middle; }
    }
    float low = srbf_float(m.data, 12 + before);
    float high = srbf_float(m.data, 12 + after);
    float blend = (high > low ? srbf_clamp((theta - low) / srbf_max(high - low, 1e-9f), 0.0f, 1.0f) : 0.0f);
    v.within_before = before;
    v.within_after = after;
    v.beyond_before = before;
    v.beyond_after = after;
    v.onward = blend;
    v.outward = 0.0f;
    if (m.azimuths > 0) {
        // The azimuth of wo, from 0 to 2 pi, in views of a ring.
        float quarter = srbf_angle(srbf_abs(v.along_y), srbf_abs(v.along_x));
        float upper = (v.along_x > 0.0f ? 3.14159265f - quarter : quarter);
        float at = (v.along_y > 0.0f ? 6.28318531f - upper : upper) * m.turn_views * 0.159154943f;
        int whole = srbf_index(at, int(m.turn_views));
        int first = (m.is_mirrored ? srbf_clamp(whole, 0, m.azimuths - 1) : whole % m.azimuths);
        int second = (m.is_mirrored ? srbf_clamp(whole + 1, 0, m.azimuths - 1) : (whole + 1) % m.azimuths);
        v.within_before = (before > 0 ? 1 + (before - 1) * m.azimuths + first : 0);
        v.within_after = (before > 0 ? 1 + (before - 1) * m.azimuths + second : 0);
        v.beyond_before = (after > 0 ? 1 + (after - 1) * m.azimuths + first : 0);
        v.beyond_after = (after > 0 ? 1 + (after - 1) * m.azimuths + second : 0);
        v.onward = at - float(whole);
        v.outward = blend;
    }
    return v;
}

// The mixture for an outgoing direction with wo.z >= 0.
SRBF_FN SrbfView srbf_prepare(const SrbfMaterial &m, vec3 wo) {
    SrbfView v = srbf_place(m, wo);
    int colour = m.head - 3;
    v.tilt_x = 1.0f;
    v.tilt_y = 0.0f;
    v.squeeze = vec3(1.0f, srbf_exp2(-srbf_within(m, v, m.heads, m.head, 0)), 1.0f);
    if (m.azimuths > 0) {
        // The logarithm of the squeeze matrix, in the plane of incidence; its eigenvectors are the frame of the lobes.
        float xx = srbf_within(m, v, m.heads, 6, 0);
        float xy = srbf_within(m, v, m.heads, 6, 1);
        float yy = srbf_within(m, v, m.heads, 6, 2);
        if (v.within_before == 0) {
            float cc = v.along_x * v.along_x;
            float cs = v.along_x * v.along_y;
            float ss = v.along_y * v.along_y;
            vec3 turned = vec3(cc * xx + ss * yy + 2.0f * cs * xy, cs * (yy - xx) + (cc - ss) * xy, ss * xx + cc * yy - 2.0f * cs * xy);
            xx = turned.x;
            xy = turned.y;
            yy = turned.z;
        }
        xx += (srbf_beyond(m, v, m.heads, 6, 0) - xx) * v.outward;
        xy = (xy + (srbf_beyond(m, v, m.heads, 6, 1) - xy) * v.outward) * v.image;
        yy += (srbf_beyond(m, v, m.heads, 6, 2) - yy) * v.outward;
        float h = 0.5f * (xx - yy);
        float reach = srbf_sqrt(h * h + xy * xy);
        if (reach > 1e-18f) {  // the squares of less have lost their digits
            v.tilt_x = srbf_sqrt(0.5f * (1.0f + srbf_abs(h) / reach));
            v.tilt_y = (h < 0.0f ? -xy : xy) / (2.0f * reach * v.tilt_x);
        }
        reach = (h < 0.0f ? -reach : reach);
        v.squeeze = vec3(srbf_exp2(0.5f * (xx + yy) + reach), srbf_exp2(0.5f * (xx + yy) - reach), 1.0f);
    }
    v.diffuse_y = srbf_exp2(srbf_between(m, v, m.heads, m.head, colour));
    v.diffuse = v.diffuse_y * srbf_colour(srbf_between(m, v, m.heads, m.head, colour + 1), srbf_between(m, v, m.heads, m.head, colour + 2));
    v.lobes_power = 0.0f;
    v.albedo = v.diffuse;
    for (int k = 0; k < m.lobes + m.mirrored; k++) {
        SrbfLobe lobe = srbf_lobe(m, v, k);
        SRBF_KEEP(v, k, lobe);
        v.lobes_power += lobe.y * lobe.integral;
        v.albedo = v.albedo + lobe.colour * (lobe.y * lobe.integral);
    }
    v.power = v.lobes_power + v.diffuse_y;
    return v;
}

// The directional albedo: the integral of f cos over the hemisphere. What factors change of it is stored at the views.
SRBF_FN vec3 srbf_albedo(const SrbfMaterial &m, const SrbfView &v) {
    if (m.half_nodes == 0) { return v.albedo; }
    vec3 change = vec3(srbf_between(m, v, m.differences, 3, 0), srbf_between(m, v, m.differences, 3, 1), srbf_between(m, v, m.differences, 3, 2));
    return v.albedo + change * v.power;
}

// A node of the factors: three codes.
SRBF_FN vec3 srbf_node(const SrbfMaterial &m, int node) {
    uint32_t bits = uint32_t(m.node_bits);
    uint32_t mask = (1u << bits) - 1u;
    int start = (m.node_bits == 8 ? 3 * node : 4 * node);
    uint32_t shift = uint32_t(8 * (start & 3));
    uint32_t code = m.data[m.nodes + start / 4] >> shift;
    if (shift > 8u) { code = code | (m.data[m.nodes + start / 4 + 1] << (32u - shift)); }
    vec3 q = vec3(float(code & mask), float((code >> bits) & mask), float((code >> (bits + bits)) & mask)) * m.node_unit;
    return q * q;
}

// Factors at one azimuth, from node `first` on; (a, b) is the place among its nodes.
SRBF_FN vec3 srbf_plane(const SrbfMaterial &m, int first, float a, float b) {
    int i = srbf_index(a, m.half_nodes - 2);
    int j = srbf_index(b, m.difference_nodes - 2);
    float x = srbf_min(a - float(i), 1.0f);
    float y = srbf_min(b - float(j), 1.0f);
    int node = first + i * m.difference_nodes + j;
    vec3 first_row = srbf_node(m, node) * (1.0f - y) + srbf_node(m, node + 1) * y;
    vec3 second_row = srbf_node(m, node + m.difference_nodes) * (1.0f - y) + srbf_node(m, node + m.difference_nodes + 1) * y;
    return first_row * (1.0f - x) + second_row * x;
}

// The factor on the lobes, from a table over (1 - h.z)^(1/4), (1 - h.wo)^(1/2) and the squared cosine of the azimuth of wi round h, h the
// half direction.
SRBF_FN vec3 srbf_factor(const SrbfMaterial &m, vec3 wo, vec3 wi) {
    if (m.half_nodes == 0) { return vec3(1.0f, 1.0f, 1.0f); }
    vec3 s = wi + wo;
    vec3 d = wi - wo;
    float n2 = srbf_dot(s, s);
    float n = srbf_sqrt(n2);
    float across = s.x * s.x + s.y * s.y;
    float a = srbf_sqrt(srbf_sqrt(across / srbf_max(n2 + srbf_max(s.z, 0.0f) * n, 1e-30f))) * float(m.half_nodes - 1);
    float b = srbf_sqrt(srbf_dot(d, d) / (4.0f + 2.0f * n)) * float(m.difference_nodes - 1);
    if (m.azimuth_nodes == 1) { return srbf_plane(m, 0, a, b); }
    float c = srbf_min(d.z * d.z * n2 / srbf_max(srbf_dot(d, d) * across, 1e-30f), 1.0f);
    if (m.has_sign) { c = (d.z < 0.0f ? 0.5f - 0.5f * c : 0.5f + 0.5f * c); }
    c = c * float(m.azimuth_nodes - 1);
    int k = srbf_index(c, m.azimuth_nodes - 2);
    float z = c - float(k);
    int size = m.half_nodes * m.difference_nodes;
    return srbf_plane(m, k * size, a, b) * (1.0f - z) + srbf_plane(m, (k + 1) * size, a, b) * z;
}

// Half a word, of those from the first on.
SRBF_FN int srbf_half(const uint32_t *data, int i) {
    uint32_t shift = uint32_t(16 * (i & 1));
    return int((data[i / 2] >> shift) & 65535u);
}

// The numbers of one wavelength of the block of spectra whose content is at a word.
SRBF_FN vec3 srbf_column(const uint32_t *data, int at, int n) {
    int head = srbf_int(data, at);
    bool is_grey = (head & 255) == 1;
    bool is_short = ((head >> 8) & 255) == 8;
    int scale = 2 * (at + 2) + (head >> 16);
    float low = srbf_bits(uint32_t(srbf_half(data, scale)) << 16u);
    float unit = srbf_bits(uint32_t(srbf_half(data, scale + 1)) << 16u);
    vec3 q = vec3(0.0f, 0.0f, 0.0f);
    for (int c = 0; c < 3; c++) {
        int place = (is_grey ? n : 3 * n + c);
        int code = srbf_half(data, scale + 2 + (is_short ? place / 2 : place));
        if (is_short) { code = ((place & 1) == 1 ? code >> 8 : code & 255); }
        float number = low + float(code) * unit;
        if (c == 0) { q.x = number; }
        if (c == 1) { q.y = number; }
        if (c == 2) { q.z = number; }
    }
    return (is_grey ? q * vec3(0.2126f, 0.7152f, 0.0722f) : q);
}

// From 0 to 1 over 20 nm.
SRBF_FN float srbf_ramp(float nm, float start) { return srbf_clamp((nm - start) * 0.05f, 0.0f, 1.0f); }

// What takes colours of the material to values at a wavelength in nm, once for a path: max(dot(srbf_primary(m, nm), value), 0). Densities and
// draws are those of the colours. Without a map in the file these are smooth primaries of sRGB, which are 1 together.
SRBF_FN vec3 srbf_primary(const SrbfMaterial &m, float nm) {
    int at = srbf_block(m.data, 1667592307);
    if (at == 0) {
        float red = 1519.0f - 76.0f * srbf_ramp(nm, 400.0f) - 584.0f * srbf_ramp(nm, 420.0f) - 450.0f * srbf_ramp(nm, 440.0f) - 409.0f * srbf_ramp(nm, 460.0f);
        red += 5064.0f * srbf_ramp(nm, 560.0f) + 20374.0f * srbf_ramp(nm, 580.0f) + 7330.0f * srbf_ramp(nm, 600.0f);
        float green = 9313.0f * srbf_ramp(nm, 460.0f) + 14394.0f * srbf_ramp(nm, 480.0f) + 9061.0f * srbf_ramp(nm, 500.0f);
        green = green - 7485.0f * srbf_ramp(nm, 560.0f) - 17953.0f * srbf_ramp(nm, 580.0f) - 7330.0f * srbf_ramp(nm, 600.0f);
        return vec3(red, green, 32768.0f - red - green) * (1.0f / 32768.0f);
    }
    int low = 0;
    int high = (srbf_int(m.data, at) >> 16) - 1;
    int first = 2 * (at + 2);
    while (low + 1 < high) {
        int middle = (low + high) / 2;
        if (float(srbf_half(m.data, first + middle)) <= nm * 10.0f) { low = middle; } else { high = middle; }
    }
    float before = float(srbf_half(m.data, first + low));
    float after = float(srbf_half(m.data, first + high));
    float t = (nm * 10.0f > before ? srbf_min((nm * 10.0f - before) / srbf_max(after - before, 0.5f), 1.0f) : 0.0f);
    return srbf_column(m.data, at, low) * (1.0f - t) + srbf_column(m.data, at, high) * t;
}

// f cos for an incident direction, and the density of srbf_sample there.
SRBF_FN SrbfValue srbf_evaluate(const SrbfMaterial &m, const SrbfView &v, vec3 wi) {
    SrbfValue r;
    r.value = vec3(0.0f, 0.0f, 0.0f);
    r.pdf = 0.0f;
    // Nothing from below the horizon or towards it, nor from or towards a vector that is no direction.
    if (!(wi.z > 0.0f && v.wo.z >= 0.0f && srbf_abs(srbf_dot(wi, wi) - 1.0f) < 0.5f)) { return r; }
    float c = v.turn_x * v.tilt_x - v.turn_y * v.tilt_y;
    float s = v.turn_y * v.tilt_x + v.turn_x * v.tilt_y;
    vec3 d = vec3(wi.x * c + wi.y * s, wi.y * c - wi.x * s, wi.z);
    vec3 u = d * v.squeeze;
    float length2 = srbf_dot(u, u);
    float length1 = srbf_sqrt(length2);
    float scale = v.squeeze.x * v.squeeze.y / (length2 * length1);
    float y = v.diffuse_y * wi.z * 0.318309886f;
    r.value = v.diffuse * (wi.z * 0.318309886f);
    for (int k = 0; k < m.lobes + m.mirrored; k++) {
        SrbfLobe lobe = SRBF_LOBE(m, v, k);
        bool is_squeezed = k < m.squeezed;
        vec3 e = (is_squeezed ? u - lobe.axis * length1 : d - lobe.axis);
        float t = -0.72134752f * lobe.sharpness * srbf_dot(e, e) * (is_squeezed ? 1.0f / length2 : 1.0f);
        // The part below the horizon, mirrored up.
        float below = -2.88539008f * lobe.sharpness * wi.z * lobe.axis.z * (is_squeezed ? 1.0f / length1 : 1.0f);
        float g = lobe.y * srbf_exp2(t) * (1.0f + srbf_exp2(below)) * (is_squeezed ? scale : 1.0f);
        y += g;
        r.value = r.value + lobe.colour * g;
    }
    r.value = r.value * srbf_factor(m, v.wo, wi);
    r.pdf = (v.power > 0.0f ? y / v.power : 0.0f);
    return r;
}

// Draws an incident direction by three uniform numbers in [0, 1); weight = value / pdf.
SRBF_FN SrbfSample srbf_sample(const SrbfMaterial &m, const SrbfView &v, vec3 u) {
    vec3 random = vec3(u.x, srbf_clamp(u.y, 0.0f, 0.99999994f), srbf_clamp(u.z, 0.0f, 1.0f));
    float goal = srbf_min(random.x * v.power, v.power * 0.9999999f);
    SrbfAngle turn = srbf_sin_cos(6.28318531f * random.z - 3.14159265f);
    float cos_phi = -turn.c;
    float sin_phi = -turn.s;
    float across = srbf_sqrt(random.y);
    vec3 d = vec3(across * cos_phi, across * sin_phi, srbf_sqrt(1.0f - random.y));
    if (goal < v.lobes_power) {
        float sum = 0.0f;
        int k = 0;
        SrbfLobe lobe = SRBF_LOBE(m, v, 0);
        for (k = 0; k < m.lobes + m.mirrored; k++) {
            lobe = SRBF_LOBE(m, v, k);
            sum += lobe.y * lobe.integral;
            if (goal < sum || k + 1 == m.lobes + m.mirrored) { break; }
        }
        float x = random.y * srbf_inside(lobe.sharpness);
        // 1 - u is exact for large u, where 1 - x would lose digits.
        float w = (x < 0.05f ? x * (1.0f + x * (0.5f + x * (0.33333333f + x * (0.25f + x * (0.2f + x * 0.16666667f))))) : -srbf_log(srbf_max((1.0f - random.y) + random.y * srbf_exp2(-2.88539008f * lobe.sharpness), 1e-37f))) / lobe.sharpness;
        w = srbf_min(w, 2.0f);
        across = srbf_sqrt(w * (2.0f - w));
        vec3 n = lobe.axis;
        float q = (n.x * cos_phi + n.y * sin_phi) / (1.0f + n.z);
        vec3 side = vec3(cos_phi - n.x * q, sin_phi - n.y * q, -q * (1.0f + n.z));
        d = n * (1.0f - w) + side * across;
        if (k < m.squeezed) { d = vec3(d.x / v.squeeze.x, d.y / v.squeeze.y, d.z); }
        d = vec3(d.x, d.y, srbf_abs(d.z)) * (1.0f / srbf_sqrt(srbf_dot(d, d)));
    }
    float c = v.turn_x * v.tilt_x - v.turn_y * v.tilt_y;
    float s = v.turn_y * v.tilt_x + v.turn_x * v.tilt_y;
    SrbfSample r;
    r.wi = vec3(d.x * c - d.y * s, d.x * s + d.y * c, d.z);
    SrbfValue f = srbf_evaluate(m, v, r.wi);
    r.pdf = f.pdf;
    r.weight = f.value * (f.pdf > 0.0f ? 1.0f / srbf_max(f.pdf, 1e-37f) : 0.0f);
    return r;
}

#ifndef __CUDACC_RTC__
// Whether words are a material that this text can read, before they are read: 0, or which word is wrong, from 1; -1 if there are too few.
// Then nothing outside is read, and every result is a number, whatever the directions. The checksum is not looked at.
inline int srbf_check(const uint32_t *words, size_t count) {
    if (count < 13) { return -1; }
    const uint32_t magic[2] = {0x42525389u, 0x1a0a0d46u};
    for (int i = 0; i < 2; i++) {
        if (words[i] != magic[i]) { return i + 1; }
    }
    if (words[2] != 2u && words[2] != 3u) { return 3; }
    if (words[3] > 1u) { return 4; }
    // The last word may be there in part, but in version 3.
    if (words[4] > 0x7fffffffu || (size_t(words[4]) + 3) / 4 > count || (words[2] == 3u && words[4] % 4u != 0u)) { return 5; }
    if (words[5] < 1u || words[5] > 1024u) { return 6; }
    if (words[6] < 1u || words[6] > 64u) { return 7; }
    if (words[7] > words[6]) { return 8; }
    const int ring = words[2] == 2u ? 9 : 8;
    const bool is_line = words[3] == 0u;
    if (is_line && (words[ring] > words[6] - words[7] || words[ring] + words[6] > 64u)) { return ring + 1; }
    const uint32_t turns = words[ring + 1] & 65535u;
    if (!is_line && turns != 1u && turns != 2u && turns != 4u) { return ring + 2; }
    if (!is_line && (words[ring] < (turns == 4u ? 2u : 1u) || words[ring] > 64u)) { return ring + 1; }
    // The lobes first, before what stands behind them is looked at.
    const size_t angles = words[5], lobes = words[6], views = is_line ? angles : 1 + (angles - 1) * words[ring];
    const size_t head = is_line ? 4 : 6, row = is_line ? 5 * lobes + words[ring] : 6 * lobes;
    const size_t rows = 12 + angles + views * head, end_of_lobes = rows + views * row;
    const size_t end_of_all = size_t(words[4]) / 4;
    if (views > 4096 || end_of_lobes >= end_of_all) { return 5; }
    // Their numbers: in the ranges of the format.
    int wrong = 0;
    auto expect = [&](bool holds, size_t at) { wrong = holds || wrong != 0 ? wrong : int(at) + 1; };
    auto within = [&](size_t at, size_t n, float low, float high) {
        for (size_t end = at + n; at < end; at++) {
            const float number = srbf_bits(words[at]);
            // By its bits a NaN is seen whatever the options of the compiler.
            expect((words[at] & 0x7f800000u) != 0x7f800000u && number >= low && number <= high, at);
        }
    };
    const float pi = 3.14159274f;
    within(12, 1, 0.0f, 0.0f);
    for (size_t i = 13; i < 12 + angles; i++) { within(i, 1, srbf_bits(words[i - 1] + 1u), 0.5f * pi); }
    for (size_t view = 0; view < views; view++) {
        const size_t own = 12 + angles + view * head, first = rows + view * row;
        if (is_line) {
            // At the normal nothing depends on an azimuth.
            const float most = view == 0 ? 0.0f : 1.0f;
            within(own, 1, -6.64f * most, most);
            within(first, lobes, -pi * most, pi * most);
            within(first + 5 * lobes, words[ring], -0.5f * pi * most, 0.5f * pi * most);
        } else {
            within(own, 3, -10.0f, 10.0f);
            const float xx = srbf_bits(words[own]), xy = srbf_bits(words[own + 1]), yy = srbf_bits(words[own + 2]);
            const float middle = 0.5f * (xx + yy), half = 0.5f * (xx - yy), reach = srbf_sqrt(half * half + xy * xy);
            expect(middle - reach >= -5.0f && middle + reach <= 6.64f, own);
            within(first, 2 * lobes, -pi, pi);
            for (size_t k = first; k < first + lobes; k++) {
                const float x = srbf_bits(words[k]), y = srbf_bits(words[k + lobes]);
                expect(x * x + y * y <= pi * pi, k);
            }
        }
        within(own + head - 3, 1, -126.0f, 2.0f);
        within(own + head - 2, 2, -16.0f, 16.0f);
        const size_t numbers = first + (is_line ? 1 : 2) * lobes;
        within(numbers, lobes, -100.0f, 26.5f);
        within(numbers + lobes, lobes, -126.0f, 60.0f);
        within(numbers + 2 * lobes, 2 * lobes, -16.0f, 16.0f);
    }
    if (wrong != 0) { return wrong; }
    if (words[2] == 3u) {
        const uint32_t lobe = 0x45424f4cu, factors = 0x54434146u, spectra = 0x63657073u;
        if (words[10] != lobe || words[11] != 4 * (end_of_lobes - 12)) { return 11; }
        bool has_factors = false;
        for (size_t at = end_of_lobes; at + 1 < end_of_all;) {
            // A block that this text does not know and may not leave out begins with a capital letter.
            if (words[at] != factors && (words[at] & 32u) == 0u) { return int(at) + 1; }
            const size_t length = words[at + 1], next = at + 2 + (length + 3) / 4;
            if (length > 4 * (end_of_all - at) || next >= end_of_all) { return int(at) + 2; }
            if (words[at] == factors && (has_factors || length < 4)) { return int(at) + 1; }
            has_factors = has_factors || words[at] == factors;
            if (words[at] == spectra) {
                // As long as its head says, the numbers of its columns in range.
                if (length < 8) { return int(at) + 2; }
                const size_t kind = words[at + 2] & 255u, bits = (words[at + 2] >> 8) & 255u, count = words[at + 2] >> 16;
                if (kind > 1 || (bits != 8 && bits != 16) || count < 1 || count > 1024) { return int(at) + 3; }
                if (length != 12 + count * (2 + (kind == 0 ? 3 : 1) * bits / 8)) { return int(at) + 3; }
                auto half = [&](size_t i) { return (words[at + 4 + i / 2] >> (16 * (i % 2))) & 65535u; };
                for (size_t i = 0; i < count; i++) { expect(half(i) > (i == 0 ? 0u : half(i - 1)), at + 4 + i / 2); }
                const uint32_t low = half(count) << 16, unit = half(count + 1) << 16;
                const float least = srbf_bits(low), most = least + srbf_bits(unit) * (bits == 8 ? 255.0f : 65535.0f);
                expect((low & 0x7f800000u) != 0x7f800000u && unit < 0x7f800000u, at + 4 + count / 2);
                expect(least >= -1e6f && least <= 1e6f && most <= 1e6f, at + 4 + count / 2);
            }
            at = next;
        }
        if (wrong != 0) { return wrong; }
        if (!has_factors) { return 0; }
    }
    SrbfMaterial m = srbf_material(words);
    if (m.half_nodes == 0) { return words[2] == 2u && words[11] == 0u ? 0 : 12; }
    if (m.half_nodes < 2 || m.half_nodes > 32 || m.difference_nodes < 2 || m.difference_nodes > 32) { return 12; }
    if (m.azimuth_nodes < 1 || m.azimuth_nodes > 8) { return 12; }
    const size_t nodes = size_t(m.half_nodes) * m.difference_nodes * m.azimuth_nodes;
    if (size_t(m.nodes) + (m.node_bits == 8 ? (3 * nodes + 3) / 4 : nodes) >= end_of_all + (words[2] == 2u ? 1 : 0)) { return -1; }
    within(size_t(m.differences), 3 * views, -16.0f, 16.0f);
    const size_t largest = size_t(m.nodes) - 1;
    within(largest, 1, srbf_bits(words[largest]) == 0.0f ? 0.0f : 1e-20f, 8.0831f);
    return wrong;
}
#endif

} // namespace srbf_device_device
