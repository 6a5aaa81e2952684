// A path tracer of a ball on a ground under a sky, by include/srbf_device.hpp alone: no library is linked.
//
//     c++ -std=c++17 -O3 -march=native -I include evaluator/examples/path_tracer.cpp -o path_tracer
//     ./path_tracer presets/garnet_red.srbf picture.ppm [samples]
#include "srbf_device.hpp"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>
using namespace srbf_device;

struct Hit {
    float t;
    vec3 point, normal;
    bool is_ball;
};

static float uniform(uint32_t &state) { // PCG (O'Neill 2014)
    state = state * 747796405u + 2891336453u;
    uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return float(((word >> 22) ^ word) >> 8) * (1.0f / 16777216.0f);
}

static vec3 unit(vec3 v) { return v * (1.0f / sqrtf(srbf_dot(v, v))); }

static Hit trace(vec3 from, vec3 towards) {
    Hit hit = {1e30f, vec3(0, 0, 0), vec3(0, 0, 1), false};
    vec3 center(0, 0, 1);
    vec3 apart = from - center;
    float b = srbf_dot(apart, towards), c = srbf_dot(apart, apart) - 1.0f, inside = b * b - c;
    if (inside > 0.0f && -b - sqrtf(inside) > 1e-3f) {
        hit.t = -b - sqrtf(inside);
        hit.is_ball = true;
    }
    if (towards.z < -1e-6f && -from.z / towards.z > 1e-3f && -from.z / towards.z < hit.t) {
        hit.t = -from.z / towards.z;
        hit.is_ball = false;
    }
    hit.point = from + towards * hit.t;
    hit.normal = hit.is_ball ? unit(hit.point - center) : vec3(0, 0, 1);
    return hit;
}

// A sky that is brighter above, and a round lamp.
static vec3 sky(vec3 d) {
    vec3 lamp = unit(vec3(-0.5f, -0.7f, 0.9f));
    float glow = srbf_dot(d, lamp) > 0.97f ? 12.0f : 0.0f;
    return vec3(0.3f, 0.4f, 0.6f) * (0.4f + 0.6f * srbf_max(d.z, 0.0f)) + vec3(glow, 0.9f * glow, 0.7f * glow);
}

int main(int count, char **arguments) {
    FILE *file = count > 2 ? fopen(arguments[1], "rb") : nullptr;
    if (!file) { return fprintf(stderr, "path_tracer MATERIAL.srbf PICTURE.ppm [SAMPLES]\n"), 2; }
    std::vector<uint32_t> words(1 << 20);
    words.resize((fread(words.data(), 1, 4 * words.size(), file) + 3) / 4);
    fclose(file);
    if (srbf_check(words.data(), words.size()) != 0) { return fprintf(stderr, "%s: no material\n", arguments[1]), 2; }
    const SrbfMaterial material = srbf_material(words.data());

    const int width = 128, height = 96, samples = count > 3 ? std::max(1, atoi(arguments[3])) : 16;
    std::vector<unsigned char> picture;
    double sum = 0.0;
    for (int pixel = 0; pixel < width * height; pixel++) {
        vec3 mean(0, 0, 0);
        for (int n = 0; n < samples; n++) {
            uint32_t state = uint32_t(pixel * samples + n) * 2654435769u + 1u;
            float x = (float(pixel % width) + uniform(state)) / float(width) - 0.5f;
            float y = (float(pixel / width) + uniform(state)) / float(height) - 0.5f;
            vec3 from(0, -5, 1.6f), towards = unit(vec3(0.8f * x, 1.0f, -0.1f - 0.6f * y)), throughput(1, 1, 1);
            for (int bounce = 0; bounce < 6; bounce++) {
                Hit hit = trace(from, towards);
                if (hit.t > 1e29f) {
                    mean = mean + throughput * sky(towards) * (1.0f / float(samples));
                    break;
                }
                // The shading frame: +z is the normal.
                vec3 z = hit.normal, side = fabsf(z.x) < 0.7f ? vec3(1, 0, 0) : vec3(0, 1, 0);
                vec3 t = unit(side - z * srbf_dot(side, z));
                vec3 b(z.y * t.z - z.z * t.y, z.z * t.x - z.x * t.z, z.x * t.y - z.y * t.x);
                vec3 random(uniform(state), uniform(state), uniform(state));
                vec3 wo(-srbf_dot(towards, t), -srbf_dot(towards, b), -srbf_dot(towards, z)), wi, weight;
                if (hit.is_ball) {
                    SrbfSample drawn = srbf_sample(material, srbf_prepare(material, wo), random);
                    wi = drawn.wi;
                    weight = drawn.weight;
                } else { // a diffuse ground
                    float r = sqrtf(random.x), phi = 6.2831853f * random.y;
                    wi = vec3(r * cosf(phi), r * sinf(phi), sqrtf(1.0f - random.x));
                    weight = vec3(0.4f, 0.4f, 0.4f);
                }
                throughput = throughput * weight;
                from = hit.point;
                towards = unit(t * wi.x + b * wi.y + z * wi.z);
            }
        }
        for (float v : {mean.x, mean.y, mean.z}) {
            sum += v;
            picture.push_back((unsigned char)(255.0f * powf(srbf_clamp(v, 0.0f, 1.0f), 1.0f / 2.2f) + 0.5f));
        }
    }
    FILE *out = fopen(arguments[2], "wb");
    if (!out) { return fprintf(stderr, "%s: cannot be written\n", arguments[2]), 2; }
    fprintf(out, "P6\n%d %d\n255\n", width, height);
    fwrite(picture.data(), 1, picture.size(), out);
    fclose(out);
    printf("%s: mean %.4f\n", arguments[2], sum / double(picture.size()));
    return 0;
}
