/* The light: a map of the sky, read, and given to srbf.h. */
#ifndef ENVIRONMENT_HPP
#define ENVIRONMENT_HPP

#include "common.hpp"
#include <fstream>
#include <memory>
#include <vector>

/* Light from infinitely far away, a latitude-longitude map, as srbf.h holds it; the conventions are those of reference-renderer. */
struct Environment {
    std::vector<unsigned char> memory;
    srbf::Environment light;

    /* A Radiance picture, not run-length encoded. */
    explicit Environment(const char *path) {
        int width = 0, height = 0;
        std::vector<V> pixels;
        std::ifstream file(path, std::ios::binary);
        std::string line;
        while (std::getline(file, line) && !line.empty()) {}
        std::getline(file, line);
        if (std::sscanf(line.c_str(), "-Y %d +X %d", &height, &width) != 2) fail("no Radiance picture");
        std::vector<unsigned char> bytes(size_t(width) * size_t(height) * 4);
        file.read(reinterpret_cast<char *>(bytes.data()), std::streamsize(bytes.size()));
        if (!file) fail("the map ends early");
        for (size_t i = 0; i < bytes.size(); i += 4) {
            const float scale = bytes[i + 3] ? std::ldexp(1.0f, bytes[i + 3] - 136) : 0;
            pixels.push_back(V{float(bytes[i]), float(bytes[i + 1]), float(bytes[i + 2])} * scale);
        }
        size_t size = 0;
        check(srbf_environment_size(size_t(width), size_t(height), &size));
        memory.resize(size + SRBF_ENVIRONMENT_ALIGNMENT);
        void *place = memory.data();
        size_t room = memory.size();
        std::align(SRBF_ENVIRONMENT_ALIGNMENT, size, place, room);
        check(light.make(size_t(width), size_t(height), &pixels[0].x, 0, place, size));
    }
    Environment(const Environment &) = delete; /* what `light` sees stays where it is */
    V radiance(V d, float &pdf) const {
        V radiance;
        check(srbf_environment_evaluate(light.get(), &d.x, &radiance.x, &pdf));
        return radiance;
    }
};

/* Samples of the light, drawn once and used by all pixels: blocks of sixteen, a cache line a row. */
struct Tile {
    struct alignas(64) Block : srbf_light_block {};
    static constexpr uint32_t COUNT = 4096;
    std::vector<Block> blocks{COUNT};

    /* The first two dimensions of Sobol's sequence, each number scrambled: sixteen points one after another lie evenly, and so do all. */
    explicit Tile(const Environment &environment) {
        Random random(1);
        const auto scramble = [&] { return uint32_t(random.unit() * 0x1p24f) << 8; };
        const uint32_t keys[2] = {scramble(), scramble()};
        for (uint32_t b = 0; b < COUNT; b++) {
            float u[3][SRBF_LIGHT_BLOCK];
            for (uint32_t k = 0; k < SRBF_LIGHT_BLOCK; k++) {
                uint32_t point[2] = {keys[0], keys[1]}, steps[2] = {1u << 31, 1u << 31};
                for (uint32_t i = SRBF_LIGHT_BLOCK * b + k; i != 0; i >>= 1, steps[0] >>= 1, steps[1] ^= steps[1] >> 1)
                    if (i & 1) point[0] ^= steps[0], point[1] ^= steps[1];
                u[0][k] = float(point[0] >> 8) * 0x1p-24f, u[1][k] = random.unit(), u[2][k] = float(point[1] >> 8) * 0x1p-24f;
            }
            check(srbf_light_block_draw(environment.light.get(), u[0], &blocks[b]));
        }
    }
};

/* A sky without a small sun, 256 x 128, so that both renderers converge in seconds. */
inline void write_environment(const char *path) {
    std::ofstream file(path, std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 128 +X 256\n";
    for (int y = 0; y < 128; y++) {
        for (int x = 0; x < 256; x++) {
            const float phi = (float(x) / 256 - 0.5f) * 2 * PI, z = std::cos(PI * (float(y) + 0.5f) / 128);
            const float window = std::pow(std::max(0.0f, std::cos(phi - 2) * std::sqrt(1 - z * z) * 0.8f + 0.6f * z), 24.0f);
            const V c = V{0.3f, 0.45f, 0.8f} * (0.4f + 0.4f * std::max(z, 0.0f)) + V{9, 8, 6} * window;
            int exponent;
            const float scale = std::frexp(largest(c), &exponent) * 256 / largest(c);
            const int bytes[4] = {int(c.x * scale), int(c.y * scale), int(c.z * scale), exponent + 128};
            for (int b : bytes) file.put(char(b));
        }
    }
}

#endif
