/* An environment through the header: made, stored and read back, looked up, drawn from; light and material sampled together.
 *
 *     environment MATERIAL.srbf
 */
#include "check.h"

enum { WIDTH = 16, HEIGHT = 8, DRAWS = MANY(20000), CANDIDATES = 8 };

static float map[HEIGHT][WIDTH][3];

static float luminance(const float *c) { return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]; }

/* Storage that begins at a multiple of 64. */
static void *aligned(size_t size, void **memory) {
    *memory = malloc(size + SRBF_ENVIRONMENT_ALIGNMENT);
    CHECK(*memory != NULL);
    uintptr_t place = (uintptr_t)*memory + SRBF_ENVIRONMENT_ALIGNMENT - 1;
    return (unsigned char *)*memory + (place - place % SRBF_ENVIRONMENT_ALIGNMENT - (uintptr_t)*memory);
}

static void test_light(const srbf_environment *environment) {
    uint64_t state = 3;
    float mean = 0;
    srbf_environment_info info;
    CHECK_OK(srbf_environment_query(environment, &info));
    const float power = info.power;
    for (int i = 0; i < DRAWS; i++) {
        const float u[3] = {uniform(&state), uniform(&state), uniform(&state)};
        srbf_light_sample sample;
        float radiance[3], both[3], pdf, density;
        CHECK_OK(srbf_environment_sample(environment, u, &sample));
        CHECK_OK(srbf_environment_evaluate(environment, sample.direction, radiance, NULL));
        CHECK_OK(srbf_environment_evaluate(environment, sample.direction, NULL, &pdf));
        CHECK_OK(srbf_environment_evaluate(environment, sample.direction, both, &density));
        CHECK(pdf == density && memcmp(radiance, both, sizeof both) == 0);
        CHECK(fabsf(pdf - sample.pdf) < 1e-3f && fabsf(luminance(sample.radiance) / sample.pdf / power - 1) < 1e-5f);
        mean += sample.direction[2] / DRAWS;
    }
    CHECK_MEAN(mean > 0.3f); /* the sky is brighter than the ground */
}

static void test_product(const char *path, const srbf_environment *environment) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    const float wo[3] = {0.6f, 0, 0.8f}, frame[9] = {1, 0, 0, 0, 0.6f, 0.8f, 0, -0.8f, 0.6f};
    srbf_material *material;
    srbf_mixture *mixture;
    CHECK_OK(srbf_material_load(path, &material));
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    CHECK_OK(srbf_material_prepare(material, wo, mixture));
    const srbf_product_sampling alone = {CANDIDATES, 0.5f, INFINITY}, shared = {CANDIDATES, 0.5f, 4};
    double sums[3] = {0, 0, 0};
    uint64_t state = 4;
    srbf_product_sample sample;
    float u[3 * CANDIDATES];
    for (int i = 0; i < DRAWS; i++) {
        for (int k = 0; k < 3 * CANDIDATES; k++) {
            u[k] = uniform(&state);
        }
        CHECK_OK(srbf_mixture_sample_product(mixture, environment, frame, &alone, u, uniform(&state), &sample));
        sums[0] += (double)luminance(sample.weight) / DRAWS;
        /* The same light, part of it by the path's own ray. */
        CHECK_OK(srbf_mixture_sample_product(mixture, environment, frame, &shared, u, uniform(&state), &sample));
        sums[1] += (double)luminance(sample.weight) / DRAWS;
        srbf_sample ray;
        float world[3], radiance[3], pdf, weight;
        CHECK_OK(srbf_mixture_sample(mixture, u, &ray));
        for (int k = 0; k < 3; k++) {
            world[k] = ray.direction[0] * frame[k] + ray.direction[1] * frame[3 + k] + ray.direction[2] * frame[6 + k];
        }
        CHECK_OK(srbf_environment_evaluate(environment, world, radiance, &pdf));
        CHECK_OK(srbf_product_ray_weight(&shared, ray.pdf, pdf, &weight));
        CHECK(weight >= 0 && weight <= 1);
        for (int k = 0; k < 3; k++) {
            radiance[k] *= ray.weight[k];
        }
        sums[1] += (double)(luminance(radiance) * weight) / DRAWS;
        sums[2] += (double)luminance(radiance) / DRAWS;
    }
    printf("reflected: %g by candidates, %g with rays, %g by rays alone\n", sums[0], sums[1], sums[2]);
    CHECK_MEAN(fabs(sums[1] / sums[0] - 1) < 0.03 && fabs(sums[2] / sums[0] - 1) < 0.1);

    float weight;
    CHECK_OK(srbf_product_ray_weight(&alone, 1, 1, &weight));
    CHECK(weight == 0);
    /* Densities that are none. */
    const float densities[] = {0, -1, NAN, INFINITY, -INFINITY, 3e38f, 1e-45f, 1};
    for (int i = 0; i < 64; i++) {
        CHECK_OK(srbf_product_ray_weight(&shared, densities[i / 8], densities[i % 8], &weight));
        CHECK(weight >= 0 && weight <= 1 && (weight == 0 || densities[i / 8] > 0));
    }
    const srbf_product_sampling bad[] = {{1, 0.5f, 4}, {33, 0.5f, 4}, {UINT32_MAX, 0.5f, 4}, {8, -1, 4}, {8, NAN, 4}, {8, 0.5f, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_sample_product(mixture, environment, frame, &bad[i], u, 0, &sample));
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_product_ray_weight(&bad[i], 1, 1, &weight));
    }
    const float crooked[9] = {1, 0, 0, 0.6f, 0.8f, 0, 0, 0, 1};
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_sample_product(mixture, environment, crooked, &alone, u, 0, &sample));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample_product(mixture, environment, frame, &alone, u, 1, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product(mixture, NULL, frame, &alone, u, 0, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product(mixture, environment, frame, &alone, NULL, 0, &sample));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product(mixture, environment, frame, NULL, u, 0, &sample));
    u[5] = NAN;
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample_product(mixture, environment, frame, &alone, u, 0, &sample));
    /* A mixture that reflects nothing. */
    u[5] = 0;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    CHECK_OK(srbf_mixture_sample_product(mixture, environment, frame, &alone, u, 0, &sample));
    CHECK(sample.weight[0] == 0 && sample.direction[1] == -0.8f && sample.direction[2] == 0.6f);
    CHECK_OK(srbf_material_free(material));
}

/* No number of the range draws a density of 0, on a map of 2 x 2 pixels of which one column is black, and beside a sun of 1e6. */
static void test_edges(void) {
    static float pixels[8][16][3];
    const float ends[] = {0, 1e-38f, 5.9604645e-8f, 0.25f, 0.49999997f, 0.5f, 0.75f, 0.99999994f};
    enum { ENDS = sizeof ends / sizeof *ends };
    for (int sun = 0; sun < 2; sun++) {
        const size_t width = sun ? 16 : 2, height = sun ? 8 : 2;
        const float small[12] = {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1};
        for (int i = 0; i < 8 * 16; i++) {
            pixels[i / 16][i % 16][0] = pixels[i / 16][i % 16][1] = pixels[i / 16][i % 16][2] = i == 35 ? 1e6f : 1;
        }
        size_t size;
        void *memory;
        CHECK_OK(srbf_environment_size(width, height, &size));
        void *storage = aligned(size, &memory);
        srbf_environment *environment;
        CHECK_OK(srbf_environment_make(width, height, sun ? &pixels[0][0][0] : small, 0, storage, size, &environment));
        for (int i = 0; i < MANY(ENDS * ENDS * ENDS * 144); i++) {
            const int n = i / (ENDS * ENDS * ENDS);
            float u[3] = {ends[i % ENDS], ends[i / ENDS % ENDS], ends[i / (ENDS * ENDS) % ENDS]};
            /* The edges of the cells of both maps are among them. 143.99999994 / 144 rounds to 1. */
            u[0] = fminf(((float)n + u[0]) / 144, 0.99999994f);
            srbf_light_sample sample;
            CHECK_OK(srbf_environment_sample(environment, u, &sample));
            CHECK(sample.pdf > 0 && isfinite(sample.pdf) && isfinite(sample.radiance[1] / sample.pdf));
        }
        free(memory);
    }
}

/* The same light by even sums as by rays alone; and the refusals. */
static void test_reflect(const char *path, const srbf_environment *environment) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    const float wo[3] = {0.6f, 0, 0.8f}, frame[9] = {1, 0, 0, 0, 0.6f, 0.8f, 0, -0.8f, 0.6f}, *flat = frame + 6;
    srbf_material *material;
    srbf_mixture *mixture;
    CHECK_OK(srbf_material_load(path, &material));
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    CHECK_OK(srbf_material_prepare(material, wo, mixture));
    srbf_light_block block;
    srbf_reflection drawn;
    float u[3 * SRBF_LIGHT_BLOCK], light[3], radiance[3];
    double sums[2] = {0, 0};
    uint64_t state = 9;
    for (int i = 0; i < DRAWS; i++) {
        for (int k = 0; k < 3 * SRBF_LIGHT_BLOCK; k++) {
            u[k] = uniform(&state);
        }
        CHECK_OK(srbf_light_block_draw(environment, u, &block));
        for (int k = 0; k < 3 * CANDIDATES; k++) {
            u[k] = uniform(&state);
        }
        CHECK_OK(srbf_mixture_reflect(mixture, environment, &block, frame, flat, CANDIDATES, u, uniform(&state), &drawn));
        float world[3];
        for (int k = 0; k < 3; k++) {
            const float *d = drawn.ray.direction;
            world[k] = d[0] * frame[k] + d[1] * frame[3 + k] + d[2] * frame[6 + k];
        }
        /* Everything on one side is hidden. */
        const int escapes = world[0] > -0.2f, lit = drawn.shadow[0] > -0.2f;
        CHECK_OK(srbf_reflection_light(&drawn, escapes, lit, NULL, light));
        sums[0] += (double)luminance(light) / DRAWS;
        float values[6], same[3];
        memcpy(values, drawn.ray_value, sizeof drawn.ray_value);
        memcpy(values + 3, drawn.shadow_value, sizeof drawn.shadow_value);
        CHECK_OK(srbf_reflection_light(&drawn, escapes, lit, values, same));
        CHECK(memcmp(light, same, sizeof light) == 0);
        CHECK_OK(srbf_environment_evaluate(environment, world, radiance, NULL));
        for (int k = 0; k < 3; k++) {
            radiance[k] *= drawn.ray.weight[k] * (float)escapes;
        }
        sums[1] += (double)luminance(radiance) / DRAWS;
    }
    printf("reflected: %g by even sums, %g by rays alone\n", sums[0], sums[1]);
    CHECK_MEAN(fabs(sums[1] / sums[0] - 1) < 0.1);
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_reflect(mixture, environment, &block, frame, flat, 0, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_reflect(mixture, environment, &block, frame, flat, 17, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_reflect(mixture, environment, &block, frame, flat, 8, u, 1, &drawn));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_reflect(mixture, environment, NULL, frame, flat, 8, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_reflection_light(NULL, 1, 1, NULL, light));
    const float none[3] = {0, 0, 0};
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_reflect(mixture, environment, &block, frame, none, 8, u, 0, &drawn));
    u[4] = 1;
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_light_block_draw(environment, u, &block));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_reflect(mixture, environment, &block, frame, flat, 8, u, 0, &drawn));
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    u[4] = 0;
    CHECK_OK(srbf_mixture_reflect(mixture, environment, &block, frame, flat, 8, u, 0, &drawn));
    CHECK(drawn.ray.pdf == 0 && drawn.shadow[0] == 0 && drawn.shadow[2] == 0);
    CHECK_OK(srbf_material_free(material));
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            for (int c = 0; c < 3; c++) {
                map[y][x][c] = y < 4 ? 1 + (float)(x == 5 && y == 2) * 50 : 0.1f;
            }
        }
    }
    size_t size;
    void *memory, *copy_memory;
    CHECK_OK(srbf_environment_size(WIDTH, HEIGHT, &size));
    unsigned char *storage = aligned(size, &memory);
    srbf_environment *environment = NULL, *again = NULL;
    const float *pixels = &map[0][0][0];
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_environment_make(WIDTH, HEIGHT, pixels, 0, storage, size - 1, &environment));
    CHECK_STATUS(SRBF_STATUS_MISALIGNED, srbf_environment_make(WIDTH, HEIGHT, pixels, 0, storage + 16, size, &environment));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_make(0, HEIGHT, pixels, 0, storage, size, &environment));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_make(SIZE_MAX, 2, pixels, 0, storage, size, &environment));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_make(WIDTH, HEIGHT, pixels, NAN, storage, size, &environment));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_environment_make(WIDTH, HEIGHT, NULL, 0, storage, size, &environment));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_environment_make(WIDTH, HEIGHT, pixels, 0, NULL, size, &environment));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_size(65536, 1, &size));
    for (float bad = -1; !isnan(bad); bad = bad < 0 ? INFINITY : NAN) {
        map[3][2][1] = bad;
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_make(WIDTH, HEIGHT, pixels, 0, storage, size, &environment));
    }
    map[3][2][1] = 1;
    const float black[3] = {0, 0, 0};
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_environment_make(1, 1, black, 0, storage, size, &environment));
    srbf_environment_info info;
    memset(storage, 0, 64);
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_environment_query((const srbf_environment *)(void *)storage, &info));
    CHECK_OK(srbf_environment_make(WIDTH, HEIGHT, pixels, 0.5f, storage, size, &environment));
    CHECK((unsigned char *)environment == storage);
    test_light(environment);
    test_product(arguments[1], environment);
    test_reflect(arguments[1], environment);
    test_edges();

    CHECK_STATUS(SRBF_STATUS_NULL, srbf_environment_query(environment, NULL));
    CHECK_OK(srbf_environment_query(environment, &info));
    const void *table = info.table;
    const size_t table_size = info.table_size;
    unsigned char *copy = aligned(table_size, &copy_memory);
    memcpy(copy, table, table_size);
    void *head_memory;
    unsigned char *head = aligned(SRBF_ENVIRONMENT_HEAD_SIZE, &head_memory);
    CHECK_OK(srbf_environment_read(copy, table_size, 0.5f, head, SRBF_ENVIRONMENT_HEAD_SIZE, &again));
    const float up[3] = {0, 0.6f, 0.8f}, none[3] = {0, 0, 0}, u[3] = {0, 0.5f, 1};
    float first[3], second[3];
    srbf_light_sample sample;
    CHECK_OK(srbf_environment_evaluate(environment, up, first, NULL));
    CHECK_OK(srbf_environment_evaluate(again, up, second, NULL));
    CHECK(memcmp(first, second, sizeof first) == 0);
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_environment_evaluate(again, none, second, NULL));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_environment_evaluate(again, up, second, second + 1));
    CHECK_OK(srbf_environment_evaluate(again, up, NULL, NULL));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_environment_sample(again, u, &sample));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_environment_read(copy, table_size - 4, 0, head, SRBF_ENVIRONMENT_HEAD_SIZE, &again));
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_environment_read(copy, table_size - 1, 0, head, SRBF_ENVIRONMENT_HEAD_SIZE, &again));
    copy[table_size / 2] ^= 1;
    CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_environment_read(copy, table_size, 0, head, SRBF_ENVIRONMENT_HEAD_SIZE, &again));
    free(memory), free(copy_memory), free(head_memory);
    printf("environment: passed\n");
    return 0;
}
