/* A path tracer on Embree that renders the scene `teapot` of the reference renderer through srbf.h.
 *
 * Paths go in streams, a row of pixels at a time: at every bounce the hits on the teapot get their mixtures in one call, and are
 * evaluated and sampled as pairs; the hits on the ground share one mixture, and are a batch. Next-event estimation towards the
 * environment, power heuristic, Russian roulette: the estimator of reference-renderer/src/integrator.rs.
 *
 *     embree --environment MAP.hdr                                 writes the map that both renderers read
 *     embree MATERIAL.srbf CONTROL_POINTS MAP.hdr SIZE SPP OUT     writes OUT.mean.pfm and OUT.variance.pfm
 */
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <embree3/rtcore.h>
#include <fstream>
#include <sstream>
#include <srbf.hpp>
#include <string>
#include <vector>

struct V {
    float x, y, z;
};
static V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static V operator*(V a, V b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
static V operator*(V a, float s) { return {a.x * s, a.y * s, a.z * s}; }
static float dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static V normalize(V a) { return a * (1 / std::sqrt(dot(a, a))); }
static float largest(V a) { return std::max({a.x, a.y, a.z}); }
static float luminance(V a) { return 0.2126f * a.x + 0.7152f * a.y + 0.0722f * a.z; }

static const float PI = 3.14159265f;

[[noreturn]] static void fail(const std::string &what) {
    std::fprintf(stderr, "embree: %s (%s)\n", what.c_str(), srbf::last_message());
    std::exit(1);
}
static void check(srbf::Status status) {
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
static void write_environment(const char *path) {
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

/* Everything of one path: plain members, which the batches of srbf.h read and write where they are. */
struct Path {
    V origin, direction, throughput, light;
    float competing; /* density of `direction`, 0 where it does not compete with samples of the environment */
    Random random;
    V point, flat, tangent, bitangent, normal; /* the hit */
    V wo, to_light_local, u, value;
    float value_pdf, light_pdf;
    V to_light;
    srbf_sample sample;
};

template <class Member>
static srbf_vectors in(const std::vector<Path> &paths, Member member) {
    const float *first = &(paths.data()->*member).x;
    return {first, first + 1, first + 2, sizeof(Path)};
}

static float power_heuristic(float pdf, float other) { return 1 / (1 + (other / pdf) * (other / pdf)); }

/* Values towards the light and new directions for all paths of a bounce that hit one material. */
static void shade(std::vector<Path> &paths, const srbf_material *material, const srbf_mixture *ground,
                  std::vector<unsigned char> &storage) {
    const size_t n = paths.size(), stride = srbf_mixture_size(64);
    if (n == 0) return;
    const srbf_vectors wi = in(paths, &Path::to_light_local), u = in(paths, &Path::u), wo = in(paths, &Path::wo);
    Path &first = paths[0];
    const srbf_vectors_out value = {&first.value.x, &first.value.y, &first.value.z, sizeof(Path)};
    const srbf_numbers_out pdf = {&first.value_pdf, sizeof(Path)};
    float *d = first.sample.direction, *w = first.sample.weight;
    const srbf_samples_out samples = {
        {d, d + 1, d + 2, sizeof(Path)}, {&first.sample.pdf, sizeof(Path)}, {w, w + 1, w + 2, sizeof(Path)}};
    if (ground != nullptr) { /* one mixture for all */
        check(srbf_mixture_evaluate_into(ground, n, &wi, &value));
        check(srbf_mixture_pdf_into(ground, n, &wi, &pdf));
        check(srbf_mixture_sample_into(ground, n, &u, &samples));
        return;
    }
    storage.resize(n * stride + SRBF_MIXTURE_ALIGNMENT);
    const size_t shift = (SRBF_MIXTURE_ALIGNMENT - reinterpret_cast<uintptr_t>(storage.data()) % SRBF_MIXTURE_ALIGNMENT) %
                         SRBF_MIXTURE_ALIGNMENT;
    unsigned char *place = storage.data() + shift;
    const srbf_mixture *mixtures = reinterpret_cast<const srbf_mixture *>(place);
    check(srbf_material_prepare_into(material, n, &wo, place, stride));
    check(srbf_mixture_evaluate_pairs_into(mixtures, stride, n, &wi, &value));
    check(srbf_mixture_pdf_pairs_into(mixtures, stride, n, &wi, &pdf));
    check(srbf_mixture_sample_pairs_into(mixtures, stride, n, &u, &samples));
}

/* Follows the paths to their ends; adds up the squares too. */
static void trace(const Scene &scene, const Environment &environment, const srbf_material *material, const srbf_mixture *ground,
                  std::vector<Path> alive, V &sum, V &squares) {
    std::vector<Path> hits[2], next;
    std::vector<unsigned char> storage;
    const auto finish = [&](const Path &p) { sum = sum + p.light, squares = squares + p.light * p.light; };
    for (int bounce = 0; !alive.empty(); bounce++) {
        hits[0].clear(), hits[1].clear(), next.clear();
        for (Path &p : alive) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            RTCRayHit r = {Scene::ray(p.origin, p.direction), {}};
            r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene.scene, &context, &r);
            if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
                const float weight = p.competing > 0 ? power_heuristic(p.competing, environment.pdf(p.direction)) : 1;
                p.light = p.light + p.throughput * environment.radiance(p.direction) * weight;
                finish(p);
                continue;
            }
            if (bounce == 6) {
                finish(p);
                continue;
            }
            const uint32_t *t = &scene.triangles[3 * size_t(r.hit.primID)];
            const float u = r.hit.u, v = r.hit.v;
            p.wo = p.direction * -1;
            p.flat = normalize({r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z});
            if (dot(p.flat, p.wo) < 0) p.flat = p.flat * -1;
            p.point = scene.positions[t[0]] * (1 - u - v) + scene.positions[t[1]] * u + scene.positions[t[2]] * v;
            p.normal = normalize(scene.normals[t[0]] * (1 - u - v) + scene.normals[t[1]] * u + scene.normals[t[2]] * v);
            if (dot(p.normal, p.flat) < 0) p.normal = p.normal * -1;
            const float cosine = dot(p.normal, p.wo);
            if (cosine < 1e-3f) p.normal = normalize(p.normal + p.wo * (1e-3f - cosine));
            p.tangent = normalize(cross(std::fabs(p.normal.z) < 0.9f ? V{0, 0, 1} : V{1, 0, 0}, p.normal));
            p.bitangent = cross(p.normal, p.tangent);
            const auto local = [&](V d) { return V{dot(d, p.tangent), dot(d, p.bitangent), dot(d, p.normal)}; };
            p.wo = local(p.wo);
            p.to_light = environment.sample(p.random, p.light_pdf);
            p.to_light_local = local(p.to_light);
            p.u = {p.random.unit(), p.random.unit(), p.random.unit()};
            hits[r.hit.primID >= scene.ground_from].push_back(p);
        }
        shade(hits[0], material, nullptr, storage);
        shade(hits[1], material, ground, storage);
        for (auto &group : hits) {
            for (Path &p : group) {
                const V start = p.point + p.flat * (1e-4f * std::max({1.0f, std::fabs(p.point.x), std::fabs(p.point.y), std::fabs(p.point.z)}));
                if (dot(p.to_light, p.flat) > 0 && largest(p.value) > 0 && scene.is_clear(start, p.to_light)) {
                    const float weight = power_heuristic(p.light_pdf, p.value_pdf) / p.light_pdf;
                    p.light = p.light + p.throughput * p.value * environment.radiance(p.to_light) * weight;
                }
                const float *d = p.sample.direction;
                p.direction = normalize(p.tangent * d[0] + p.bitangent * d[1] + p.normal * d[2]);
                bool ends = p.sample.pdf == 0 || dot(p.direction, p.flat) <= 0;
                p.throughput = p.throughput * V{p.sample.weight[0], p.sample.weight[1], p.sample.weight[2]};
                if (!ends && bounce >= 3) {
                    const float survival = std::min(largest(p.throughput), 0.95f);
                    ends = p.random.unit() >= survival;
                    p.throughput = p.throughput * (1 / survival);
                }
                p.competing = p.sample.pdf, p.origin = start;
                if (ends) finish(p);
                else next.push_back(p);
            }
        }
        alive.swap(next);
    }
}

static void write_pfm(const std::string &path, const std::vector<V> &pixels, int size) {
    std::ofstream file(path, std::ios::binary);
    file << "PF\n" << size << ' ' << size << "\n-1.0\n";
    for (int y = size - 1; y >= 0; y--)
        file.write(reinterpret_cast<const char *>(&pixels[size_t(y) * size_t(size)]), std::streamsize(sizeof(V)) * size);
    if (!file) fail("cannot write " + path);
}

int main(int count, char **arguments) {
    if (count == 3 && std::string(arguments[1]) == "--environment") {
        write_environment(arguments[2]);
        return 0;
    }
    if (count != 7) fail("see the top of main.cpp for the arguments");
    const int size = std::atoi(arguments[4]), spp = std::atoi(arguments[5]);
    srbf::Material material;
    check(material.load(arguments[1]));
    const Scene scene(arguments[2]);
    const Environment environment(arguments[3]);
    /* The ground: Lambert's law, albedo 1/2, without a material. */
    srbf::Mixture<16> ground;
    const srbf::Vec3 half = {0.5f, 0.5f, 0.5f};
    check(ground.from_lobes(SRBF_DOMAIN_HEMISPHERE, {}, &half));

    const V eye = {3.6f, -9.6f, 5.2f}, forward = normalize(V{0.15f, 0, 1.25f} - eye), right = normalize(cross(forward, {0, 0, 1}));
    const V down = cross(forward, right);
    const float pixel = 2 * std::tan(27 * PI / 360) / float(size);
    std::vector<V> mean, variance;
    const auto start = std::chrono::steady_clock::now();
    for (int y = 0; y < size; y++) {
        for (int x = 0; x < size; x++) {
            std::vector<Path> paths;
            for (int s = 0; s < spp; s++) {
                Path p = {eye, {}, {1, 1, 1}, {}, 0, Random(uint64_t(s) * 0x100000001b3u + uint64_t(y * size + x) + 1),
                          {}, {}, {}, {}, {}, {}, {}, {}, {}, 0, 0, {}, {}};
                const float px = (float(x) + p.random.unit() - 0.5f * float(size)) * pixel;
                const float py = (float(y) + p.random.unit() - 0.5f * float(size)) * pixel;
                p.direction = normalize(forward + right * px + down * py);
                paths.push_back(p);
            }
            V sum = {}, squares = {};
            trace(scene, environment, material.get(), ground.get(), std::move(paths), sum, squares);
            const V m = sum * (1 / float(spp));
            mean.push_back(m);
            variance.push_back((squares * (1 / float(spp)) - m * m) * (1 / float(spp - 1)));
        }
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("embree: %.0f ns a path\n", seconds * 1e9 / size / size / spp);
    write_pfm(std::string(arguments[6]) + ".mean.pfm", mean, size);
    write_pfm(std::string(arguments[6]) + ".variance.pfm", variance, size);
    return 0;
}
