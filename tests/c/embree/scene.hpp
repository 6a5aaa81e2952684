/* The shapes: built, and given to Embree. */
#ifndef SCENE_HPP
#define SCENE_HPP

#include "common.hpp"
#include <embree3/rtcore.h>
#include <fstream>
#include <sstream>
#include <vector>

/* The scene: the teapot's 32 patches in 24 x 24 quadrilaterals, and a square below it. */
struct Scene {
    std::vector<V> positions, normals;
    std::vector<uint32_t> triangles;
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    size_t ground_from = 0;

    explicit Scene(const char *control_points) {
        /* Every number behind each `=` of the Rust source: 290 points, then 32 patches of 16. */
        std::ifstream file(control_points);
        std::stringstream text;
        text << file.rdbuf();
        std::vector<double> numbers[2];
        std::string all = text.str();
        size_t from = 0;
        for (auto &list : numbers) {
            from = all.find("= [", from);
            if (from == std::string::npos) fail("no control points");
            for (const char *p = all.c_str() + from; *p != '\0' && *p != ';'; from++) {
                char *end = const_cast<char *>(p) + 1;
                if (std::isdigit(static_cast<unsigned char>(*p)) || *p == '-') list.push_back(std::strtod(p, &end));
                p = end;
            }
        }
        if (numbers[0].size() != 870 || numbers[1].size() != 512) fail("other control points than expected");
        const int steps = 24;
        for (int patch = 0; patch < 32; patch++) {
            const auto first = uint32_t(positions.size());
            for (int i = 0; i <= steps; i++)
                for (int j = 0; j <= steps; j++) {
                    double d[3][3];
                    const double u = double(i) / steps, v = double(j) / steps;
                    for (double step : {0.0, 1e-5}) { /* at a pole: the limit of the normal */
                        evaluate(numbers, patch, u + step * (0.5 - u), v + step * (0.5 - v), d);
                        if (step == 0) positions.push_back({float(d[0][0]), float(d[0][1]), float(d[0][2])});
                        const double n[3] = {d[1][1] * d[2][2] - d[1][2] * d[2][1], d[1][2] * d[2][0] - d[1][0] * d[2][2],
                                             d[1][0] * d[2][1] - d[1][1] * d[2][0]};
                        const double length = std::hypot(n[0], n[1], n[2]);
                        const double along = std::max(std::hypot(d[1][0], d[1][1], d[1][2]), std::hypot(d[2][0], d[2][1], d[2][2]));
                        if (length > 1e-9 * along) {
                            normals.push_back({float(n[0] / length), float(n[1] / length), float(n[2] / length)});
                            break;
                        }
                        if (step > 0) normals.push_back({0, 0, 1});
                    }
                }
            for (uint32_t i = 0; i < steps; i++)
                for (uint32_t j = 0; j < steps; j++) {
                    const uint32_t a = first + i * (steps + 1) + j, b = a + steps + 1;
                    for (uint32_t k : {a, b, b + 1, a, b + 1, a + 1}) triangles.push_back(k);
                }
        }
        ground_from = triangles.size() / 3;
        const auto corner = uint32_t(positions.size());
        for (int k = 0; k < 4; k++) {
            positions.push_back({k == 1 || k == 2 ? 60.0f : -60.0f, k >= 2 ? 60.0f : -60.0f, -1e-3f});
            normals.push_back({0, 0, 1});
        }
        for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) triangles.push_back(corner + k);

        RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void *p = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V), positions.size());
        std::copy(positions.begin(), positions.end(), static_cast<V *>(p));
        p = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size() / 3);
        std::copy(triangles.begin(), triangles.end(), static_cast<uint32_t *>(p));
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene, mesh);
        rtcReleaseGeometry(mesh);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene);
    }
    static void evaluate(const std::vector<double> *numbers, int patch, double u, double v, double d[3][3]) {
        const auto basis = [](double t, double b[2][4]) {
            const double s = 1 - t, value[4] = {s * s * s, 3 * t * s * s, 3 * t * t * s, t * t * t};
            const double slope[4] = {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t};
            std::copy(value, value + 4, b[0]), std::copy(slope, slope + 4, b[1]);
        };
        double bu[2][4], bv[2][4];
        basis(u, bu), basis(v, bv);
        for (int c = 0; c < 3; c++) {
            d[0][c] = d[1][c] = d[2][c] = 0;
            for (size_t k = 0; k < 16; k++) {
                const double p = numbers[0][3 * size_t(numbers[1][size_t(patch) * 16 + k]) + size_t(c)];
                d[0][c] += p * bu[0][k / 4] * bv[0][k % 4];
                d[1][c] += p * bu[1][k / 4] * bv[0][k % 4];
                d[2][c] += p * bu[0][k / 4] * bv[1][k % 4];
            }
        }
    }
    static RTCRay ray(V o, V d) { return {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, INFINITY, ~0u, 0, 0}; }
    bool is_clear(V o, V d) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay r = ray(o, d);
        rtcOccluded1(scene, &context, &r);
        return r.tfar > 0;
    }
};

#endif
