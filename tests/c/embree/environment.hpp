/* The light: a map of the sky, read, looked up and sampled. */
#ifndef ENVIRONMENT_HPP
#define ENVIRONMENT_HPP

#include "common.hpp"
#include <fstream>
#include <vector>

/* Light from infinitely far away, a latitude-longitude map; the conventions of reference-renderer/src/environment.rs. */
struct Environment {
    int width = 0, height = 0;
    std::vector<V> pixels;
    std::vector<float> density;
    std::vector<double> cumulative;

    double solid_angle(int row) const {
        return 2 * M_PI / width * (std::cos(M_PI * row / height) - std::cos(M_PI * (row + 1) / height));
    }

    /* A Radiance picture, not run-length encoded. */
    explicit Environment(const char *path) {
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
        double total = 0;
        for (int y = 0; y < height; y++) {
            for (int x = 0; x < width; x++) {
                float sum = 0, count = 0; /* of itself and its neighbours, as far as a lookup blends */
                for (int r = std::max(y - 1, 0); r <= std::min(y + 1, height - 1); r++)
                    for (int c = -1; c <= 1; c++, count++) sum += luminance(at(x + c, r));
                density.push_back(sum / count);
                cumulative.push_back(total += double(sum / count) * solid_angle(y));
            }
        }
        for (float &d : density) d = float(d / total);
    }
    V at(int x, int y) const {
        return pixels[size_t(std::clamp(y, 0, height - 1)) * size_t(width) + size_t((x + width) % width)];
    }
    void place(V d, float &x, float &y) const {
        const float turns = 0.5f - std::atan2(d.y, d.x) / (2 * PI);
        x = (turns - std::floor(turns)) * float(width);
        y = std::acos(std::clamp(d.z, -1.0f, 1.0f)) / PI * float(height);
    }
    V radiance(V d) const {
        float x, y;
        place(d, x, y);
        const float column = std::floor(x - 0.5f), row = std::floor(y - 0.5f), u = x - 0.5f - column, v = y - 0.5f - row;
        const int c = int(column), r = int(row);
        return (at(c, r) * (1 - u) + at(c + 1, r) * u) * (1 - v) + (at(c, r + 1) * (1 - u) + at(c + 1, r + 1) * u) * v;
    }
    float pdf(V d) const {
        float x, y;
        place(d, x, y);
        return density[size_t(std::min(int(y), height - 1)) * size_t(width) + size_t(std::min(int(x), width - 1))];
    }
    V sample(Random &random, float &pdf) const {
        const double target = (double(random.unit()) + double(random.unit()) * 0x1p-24) * cumulative.back();
        const size_t i = std::min(size_t(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin()),
                                  cumulative.size() - 1);
        const double row = double(i / size_t(width)), low = std::cos(M_PI * (row + 1) / height), high = std::cos(M_PI * row / height);
        const float z = float(high + (low - high) * double(random.unit())), r = std::sqrt(std::max(0.0f, 1 - z * z));
        const float phi = -((float(i % size_t(width)) + random.unit()) / float(width) - 0.5f) * 2 * PI;
        pdf = density[i];
        return {r * std::cos(phi), r * std::sin(phi), z};
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
