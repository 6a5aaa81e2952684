/* The code of a renderer author for an analytic material: a GGX reflection above a diffuse term, in linear sRGB, with
   Fresnel by Schlick 1994, masking by Smith (correlated, Heitz 2014), and draws from the visible normals (Heitz 2018). */
#include <math.h>

#define PI 3.14159265358979f

struct ggx {
    float diffuse[3], specular[3]; /* albedo of the diffuse term; reflectance at normal incidence */
    float alpha;                   /* roughness */
    float share;                   /* share of the draws that the reflection gets */
};

/* Smith's function for a direction. */
static float lambda(float alpha, const float w[3]) {
    float tangent_squared = (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]);
    return 0.5f * (sqrtf(1.0f + alpha * alpha * tangent_squared) - 1.0f);
}

/* f cos and the density towards wi. */
void srbf_ggx_evaluate(const struct ggx *m, const float wo[3], const float wi[3], float value[3], float *pdf) {
    if (wi[2] <= 0.0f || wo[2] <= 0.0f) {
        value[0] = value[1] = value[2] = *pdf = 0.0f;
        return;
    }
    float h[3] = {wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]};
    float shrink = 1.0f / sqrtf(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    for (int i = 0; i < 3; ++i) h[i] *= shrink;
    float cosine = wo[0] * h[0] + wo[1] * h[1] + wo[2] * h[2];
    float squared = m->alpha * m->alpha, d = h[2] * h[2] * (squared - 1.0f) + 1.0f;
    float normals = squared / (PI * d * d);
    float out = lambda(m->alpha, wo), in = lambda(m->alpha, wi);
    float reflection = normals / ((1.0f + out + in) * 4.0f * wo[2]);
    float off = 1.0f - cosine, fifth = off * off * off * off * off;
    for (int i = 0; i < 3; ++i) {
        float fresnel = m->specular[i] + (1.0f - m->specular[i]) * fifth;
        value[i] = m->diffuse[i] / PI * wi[2] + fresnel * reflection;
    }
    *pdf = m->share * normals / ((1.0f + out) * 4.0f * wo[2]) + (1.0f - m->share) * wi[2] / PI;
}

/* A direction from three uniform numbers, with its weight f cos / pdf and its density. */
void srbf_ggx_sample(const struct ggx *m, const float wo[3], const float u[3], float wi[3], float weight[3], float *pdf) {
    float radius = sqrtf(u[1]), s = sinf(2.0f * PI * u[2]), c = cosf(2.0f * PI * u[2]);
    if (u[0] < m->share) {
        float v[3] = {m->alpha * wo[0], m->alpha * wo[1], wo[2]};
        float shrink = 1.0f / sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int i = 0; i < 3; ++i) v[i] *= shrink;
        float across = v[0] * v[0] + v[1] * v[1], t1[3] = {1.0f, 0.0f, 0.0f};
        if (across > 0.0f) {
            t1[0] = -v[1] / sqrtf(across);
            t1[1] = v[0] / sqrtf(across);
        }
        float t2[3] = {-v[2] * t1[1], v[2] * t1[0], v[0] * t1[1] - v[1] * t1[0]};
        float a = radius * c, b = radius * s, half = 0.5f * (1.0f + v[2]);
        b = (1.0f - half) * sqrtf(1.0f - a * a) + half * b;
        float up = sqrtf(fmaxf(0.0f, 1.0f - a * a - b * b)), h[3];
        for (int i = 0; i < 3; ++i) h[i] = a * t1[i] + b * t2[i] + up * v[i];
        h[0] *= m->alpha;
        h[1] *= m->alpha;
        h[2] = fmaxf(1e-6f, h[2]);
        shrink = 1.0f / sqrtf(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        for (int i = 0; i < 3; ++i) h[i] *= shrink;
        float cosine = wo[0] * h[0] + wo[1] * h[1] + wo[2] * h[2];
        for (int i = 0; i < 3; ++i) wi[i] = 2.0f * cosine * h[i] - wo[i];
    } else {
        wi[0] = radius * c;
        wi[1] = radius * s;
        wi[2] = sqrtf(fmaxf(0.0f, 1.0f - u[1]));
    }
    float value[3];
    srbf_ggx_evaluate(m, wo, wi, value, pdf);
    for (int i = 0; i < 3; ++i) weight[i] = *pdf > 0.0f ? value[i] / *pdf : 0.0f;
}
