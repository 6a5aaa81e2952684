/* A path tracer on Embree that renders the scene `teapot` of the reference renderer through srbf.h.
 *
 * Paths go in streams, a row of pixels at a time: at every bounce the hits on the teapot get their mixtures in one call, and are
 * sampled as pairs; the hits on the ground share one mixture, and are a batch. Where a path meets the teapot first, sums over a block of
 * samples of the environment and eight directions of the mixture give the direct light. One shadow ray and the path's own ray correct
 * them. Everywhere else one sample of the environment and the path's own ray are weighed against each other. Russian roulette.
 *
 *     embree --environment MAP.hdr                                 writes the map that both renderers read
 *     embree MATERIAL.srbf CONTROL_POINTS MAP.hdr SIZE SPP OUT     writes OUT.mean.pfm and OUT.variance.pfm
 */
#include "environment.hpp"
#include "scene.hpp"
#include <chrono>

/* Everything of one path: plain members, which the batches of srbf.h read and write where they are. */
struct Path {
    V origin, direction, throughput, light;
    float competing; /* density of `direction`, 0 where it does not compete with samples of the environment */
    uint32_t block;  /* of the tile */
    Random random;
    V point, flat, tangent, bitangent, normal; /* the hit */
    V wo, u;
    V shadow;     /* where the shadow ray goes, all 0 for none */
    V direct[2];  /* light that the hit reflects if that ray is blocked, or clear */
    V escaped[2]; /* likewise, light that is added if the path's own ray escapes: with sums alone, else all 0 */
    srbf_sample sample;
};

/* Directions of the mixture at a first hit on the teapot. */
static const uint32_t RAYS = 8;

static V from(const float *v) { return {v[0], v[1], v[2]}; }

template <class Member>
static srbf_vectors in(const std::vector<Path> &paths, Member member) {
    const float *first = &(paths.data()->*member).x;
    return {first, first + 1, first + 2, sizeof(Path)};
}

/* Light and mixture together by even sums: both rays, and their light. */
static void draw_sums(Path &p, const srbf_mixture *mixture, const Environment &environment, const Tile &tile) {
    const float frame[9] = {p.tangent.x,   p.tangent.y, p.tangent.z, p.bitangent.x, p.bitangent.y,
                            p.bitangent.z, p.normal.x,  p.normal.y,  p.normal.z};
    const float first[3] = {p.u.x, p.u.y, p.u.z}, steps[3] = {1, 3, 5};
    float u[3][RAYS]; /* one point and its shifts along a lattice */
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < RAYS; i++) {
            const float shifted = first[k] + float(i) * steps[k] / float(RAYS);
            u[k][i] = std::min(shifted - std::floor(shifted), 1 - 0x1p-24f);
        }
    }
    srbf_reflection r;
    check(srbf_mixture_reflect(mixture, environment.light.get(), &tile.blocks[p.block], frame, &p.flat.x, RAYS, u[0],
                               p.random.unit(), &r));
    p.sample = r.ray, p.shadow = from(r.shadow);
    for (int clear = 0; clear < 2; clear++) {
        V open;
        check(srbf_reflection_light(&r, 0, clear, nullptr, &p.direct[clear].x));
        check(srbf_reflection_light(&r, 1, clear, nullptr, &open.x));
        p.escaped[clear] = open - p.direct[clear];
    }
    p.competing = 0;
}

/* One sample of the environment, weighed against the path's own ray by the power heuristic. */
static void draw_light(Path &p, const srbf_mixture *mixture, const Environment &environment) {
    const float u[3] = {p.random.unit(), p.random.unit(), p.random.unit()};
    srbf_light_sample light;
    check(srbf_environment_sample(environment.light.get(), u, &light));
    p.shadow = from(light.direction);
    const V wi = {dot(p.shadow, p.tangent), dot(p.shadow, p.bitangent), dot(p.shadow, p.normal)};
    V value;
    float pdf;
    check(srbf_mixture_evaluate_and_pdf(mixture, &wi.x, &value.x, &pdf));
    p.direct[0] = p.escaped[0] = p.escaped[1] = {};
    p.direct[1] = value * from(light.radiance) * (power_heuristic(light.pdf, pdf) / light.pdf);
    p.competing = p.sample.pdf;
}

/* What lights the scene. */
struct Light {
    const Environment &environment;
    const Tile &tile;
};

/* Shadow rays and new directions for all paths of a bounce that hit one material. */
static void shade(std::vector<Path> &paths, bool is_first, const Light &light, const srbf_material *material,
                  const srbf_mixture *ground, std::vector<unsigned char> &storage) {
    const size_t n = paths.size(), stride = srbf_mixture_size(64);
    if (n == 0) return;
    const srbf_vectors wo = in(paths, &Path::wo);
    Path &first = paths[0];
    float *d = first.sample.direction, *w = first.sample.weight;
    srbf_request request = {};
    request.size = sizeof request;
    request.u = in(paths, &Path::u);
    request.samples = {{d, d + 1, d + 2, sizeof(Path)}, {&first.sample.pdf, sizeof(Path)}, {w, w + 1, w + 2, sizeof(Path)}};
    if (ground != nullptr) { /* one mixture for all */
        check(srbf_mixture_ask(ground, 0, n, &request));
        for (Path &p : paths) draw_light(p, ground, light.environment);
        return;
    }
    storage.resize(n * stride + SRBF_MIXTURE_ALIGNMENT);
    const size_t shift = (SRBF_MIXTURE_ALIGNMENT - reinterpret_cast<uintptr_t>(storage.data()) % SRBF_MIXTURE_ALIGNMENT) %
                         SRBF_MIXTURE_ALIGNMENT;
    unsigned char *place = storage.data() + shift;
    const srbf_mixture *mixtures = reinterpret_cast<const srbf_mixture *>(place);
    check(srbf_material_prepare_into(material, n, &wo, place, stride));
    const auto mixture = [&](size_t i) { return reinterpret_cast<const srbf_mixture *>(place + i * stride); };
    if (is_first) {
        for (size_t i = 0; i < n; i++) draw_sums(paths[i], mixture(i), light.environment, light.tile);
        return;
    }
    check(srbf_mixture_ask(mixtures, stride, n, &request));
    for (size_t i = 0; i < n; i++) draw_light(paths[i], mixture(i), light.environment);
}

/* Follows the paths to their ends; adds up the squares too. */
static void trace(const Scene &scene, const Light &light, const srbf_material *material, const srbf_mixture *ground,
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
                float pdf;
                const V radiance = light.environment.radiance(p.direction, pdf);
                if (bounce == 0) p.light = radiance;
                else if (p.competing > 0) p.light = p.light + p.throughput * radiance * power_heuristic(p.competing, pdf);
                else p.light = p.light + p.escaped[0];
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
            p.u = {p.random.unit(), p.random.unit(), p.random.unit()};
            hits[r.hit.primID >= scene.ground_from].push_back(p);
        }
        shade(hits[0], bounce == 0, light, material, nullptr, storage);
        shade(hits[1], bounce == 0, light, material, ground, storage);
        for (auto &group : hits) {
            for (Path &p : group) {
                const V start = p.point + p.flat * (1e-4f * std::max({1.0f, std::fabs(p.point.x), std::fabs(p.point.y), std::fabs(p.point.z)}));
                const bool is_asked = dot(p.shadow, p.flat) > 0 && (luminance(p.direct[1]) != 0 || luminance(p.escaped[1]) != 0);
                const int clear = is_asked && scene.is_clear(start, p.shadow);
                p.light = p.light + p.throughput * p.direct[clear];
                p.escaped[0] = p.throughput * p.escaped[clear];
                const float *d = p.sample.direction;
                p.direction = normalize(p.tangent * d[0] + p.bitangent * d[1] + p.normal * d[2]);
                bool ends = p.sample.pdf == 0 || dot(p.direction, p.flat) <= 0;
                p.throughput = p.throughput * from(p.sample.weight);
                if (!ends && bounce >= 3) {
                    const float survival = std::min(largest(p.throughput), 0.95f);
                    ends = p.random.unit() >= survival;
                    p.throughput = p.throughput * (1 / survival);
                }
                p.origin = start;
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
    const Tile tile(environment);
    const Light light{environment, tile};
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
                const auto pixel_index = uint32_t(y * size + x);
                /* Another pixel takes the blocks in another order, of which those of 2^k samples are evenly spread. */
                const uint32_t block = (pixel_index * 0x9e3779b1u >> 20 ^ uint32_t(s)) % Tile::COUNT;
                Path p = {eye, {}, {1, 1, 1}, {}, 0, block, Random(uint64_t(s) * 0x100000001b3u + pixel_index + 1),
                          {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
                const float px = (float(x) + p.random.unit() - 0.5f * float(size)) * pixel;
                const float py = (float(y) + p.random.unit() - 0.5f * float(size)) * pixel;
                p.direction = normalize(forward + right * px + down * py);
                paths.push_back(p);
            }
            V sum = {}, squares = {};
            trace(scene, light, material.get(), ground.get(), std::move(paths), sum, squares);
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
