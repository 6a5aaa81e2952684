/* Light of any kind through the header: lamps that are spheres, sampled by solid angle, with an occluder that they do not know; and
 * functions that answer anything.
 *
 *     light MATERIAL.srbf
 */
#include "check.h"

enum { DRAWS = MANY(40000), CANDIDATES = 8, LAMPS = 3 };

static const float PI = 3.14159265f;

static float dot(const float *a, const float *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static float luminance(const float *c) { return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]; }

typedef struct {
    float centre[3], radius, radiance[3];
} lamp;

/* The lamps as the functions see them, from one point. */
typedef struct {
    float towards[LAMPS][3]; /* unit vectors to the centres */
    float height[LAMPS];     /* 1 - cosine of half the angle under which a lamp is seen */
    float distance[LAMPS];
    const lamp *lamps;
    float share[LAMPS + 1]; /* of the draws: a running sum */
} seen_lamps;

static void see(seen_lamps *seen, const lamp *lamps, const float point[3]) {
    seen->lamps = lamps;
    seen->share[0] = 0;
    for (int i = 0; i < LAMPS; i++) {
        float d[3];
        for (int k = 0; k < 3; k++) {
            d[k] = lamps[i].centre[k] - point[k];
        }
        const float distance = sqrtf(dot(d, d)), sine = lamps[i].radius / distance;
        for (int k = 0; k < 3; k++) {
            seen->towards[i][k] = d[k] / distance;
        }
        seen->distance[i] = distance;
        seen->height[i] = sine * sine / (1 + sqrtf(1 - sine * sine));
        seen->share[i + 1] = seen->share[i] + luminance(lamps[i].radiance) * seen->height[i];
    }
    for (int i = 1; i <= LAMPS; i++) {
        seen->share[i] /= seen->share[LAMPS];
    }
}

static int is_towards(const seen_lamps *seen, int i, const float *d) {
    float apart[3];
    for (int k = 0; k < 3; k++) {
        apart[k] = d[k] - seen->towards[i][k];
    }
    return 0.5f * dot(apart, apart) < seen->height[i];
}

/* Of the nearest lamp; lamps may hide each other. */
static void radiance_of(const seen_lamps *seen, const float *d, float *radiance) {
    float nearest = INFINITY;
    radiance[0] = radiance[1] = radiance[2] = 0;
    for (int i = 0; i < LAMPS; i++) {
        if (is_towards(seen, i, d) && seen->distance[i] < nearest) {
            nearest = seen->distance[i];
            memcpy(radiance, seen->lamps[i].radiance, 3 * sizeof *radiance);
        }
    }
}

static srbf_status evaluate(void *user, size_t count, srbf_light_rows *rows) {
    const seen_lamps *seen = (const seen_lamps *)user;
    for (size_t n = 0; n < count; n++) {
        const float d[3] = {rows->direction[0][n], rows->direction[1][n], rows->direction[2][n]};
        float radiance[3];
        radiance_of(seen, d, radiance);
        rows->pdf[n] = 0;
        for (int i = 0; i < LAMPS; i++) {
            if (is_towards(seen, i, d)) {
                rows->pdf[n] += (seen->share[i + 1] - seen->share[i]) / (2 * PI * seen->height[i]);
            }
        }
        for (int k = 0; k < 3; k++) {
            rows->radiance[k][n] = radiance[k];
        }
    }
    return SRBF_STATUS_OK;
}

static srbf_status sample(void *user, size_t count, const float *u, srbf_light_rows *rows) {
    const seen_lamps *seen = (const seen_lamps *)user;
    for (size_t n = 0; n < count; n++) {
        int i = 0;
        while (i + 1 < LAMPS && u[n] >= seen->share[i + 1]) {
            i++;
        }
        /* Within the cone: 1 - cosine evenly; a hair less, so that rounding leaves it inside. */
        const float fall = 0.99999f * u[16 + n] * seen->height[i], radius = sqrtf(fall * (2 - fall));
        const float x = radius * cosf(2 * PI * u[32 + n]), y = radius * sinf(2 * PI * u[32 + n]), *z = seen->towards[i];
        const float sign = copysignf(1, z[2]), a = -1 / (sign + z[2]), b = z[0] * z[1] * a;
        const float tangent[3] = {1 + sign * z[0] * z[0] * a, sign * b, -sign * z[0]}, bitangent[3] = {b, sign + z[1] * z[1] * a, -z[1]};
        for (int k = 0; k < 3; k++) {
            rows->direction[k][n] = x * tangent[k] + y * bitangent[k] + (1 - fall) * z[k];
        }
    }
    return evaluate(user, count, rows);
}

static void fill(float *u, int n, uint64_t *state) {
    for (int k = 0; k < n; k++) {
        u[k] = uniform(state);
    }
}

static void test_lamps(srbf_mixture *mixture) {
    static const lamp lamps[LAMPS] = {{{1, 2, 3}, 1, {3, 2, 1}}, {{-3, 0, 3}, 0.5f, {10, 10, 20}}, {{0.4f, 2.4f, 5}, 2, {1, 1, 1}}};
    const float point[3] = {0.1f, -0.2f, 0}, frame[9] = {1, 0, 0, 0, 0.6f, 0.8f, 0, -0.8f, 0.6f};
    seen_lamps seen;
    see(&seen, lamps, point);
    const srbf_light_source light = {&seen, sample, evaluate};
    const srbf_product_sampling sampling = {CANDIDATES, 0.5f, INFINITY};
    double sums[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
    uint64_t state = 5;
    for (int n = 0; n < DRAWS; n++) {
        float u[3 * SRBF_LIGHT_BLOCK], radiance[6], light_found[3], found[3];
        srbf_product_sample drawn;
        fill(u, 3 * CANDIDATES, &state);
        CHECK_OK(srbf_mixture_sample_product_from(mixture, &light, frame, &sampling, u, uniform(&state), &drawn));
        /* The shadow ray's radiance: an occluder hides one side. */
        radiance_of(&seen, drawn.direction, radiance);
        for (int k = 0; k < 3; k++) {
            found[k] = drawn.direction[0] < 0.3f ? drawn.factor[k] * radiance[k] : 0;
        }
        double estimates[3];
        estimates[0] = (double)luminance(found);

        srbf_light_block block;
        srbf_reflection reflection;
        fill(u, 3 * SRBF_LIGHT_BLOCK, &state);
        CHECK_OK(srbf_light_block_draw_from(&light, u, &block));
        fill(u, 3 * CANDIDATES, &state);
        CHECK_OK(srbf_mixture_reflect_from(mixture, &light, &block, frame, frame + 6, CANDIDATES, u, uniform(&state), &reflection));
        float world[3];
        for (int k = 0; k < 3; k++) {
            const float *d = reflection.ray.direction;
            world[k] = d[0] * frame[k] + d[1] * frame[3 + k] + d[2] * frame[6 + k];
        }
        const float *towards[2] = {world, reflection.shadow};
        for (int ray = 0; ray < 2; ray++) {
            radiance_of(&seen, towards[ray], radiance + 3 * ray);
            for (int k = 0; k < 3; k++) {
                radiance[3 * ray + k] *= towards[ray][0] < 0.3f && dot(towards[ray], frame + 6) > 0;
            }
        }
        CHECK_OK(srbf_reflection_light_from(&reflection, radiance, light_found));
        estimates[1] = (double)luminance(light_found);

        /* By the lobes alone. */
        srbf_sample ray;
        fill(u, 3, &state);
        CHECK_OK(srbf_mixture_sample(mixture, u, &ray));
        for (int k = 0; k < 3; k++) {
            world[k] = ray.direction[0] * frame[k] + ray.direction[1] * frame[3 + k] + ray.direction[2] * frame[6 + k];
        }
        radiance_of(&seen, world, radiance);
        for (int k = 0; k < 3; k++) {
            radiance[k] *= ray.weight[k] * (float)(world[0] < 0.3f);
        }
        estimates[2] = (double)luminance(radiance);
        for (int i = 0; i < 3; i++) {
            sums[i] += estimates[i] / DRAWS;
            squares[i] += estimates[i] * estimates[i] / DRAWS;
        }
    }
    printf("of lamps: %g by candidates, %g by even sums, %g by the lobes alone\n", sums[0], sums[1], sums[2]);
    for (int i = 0; i < 2; i++) {
        const double error = sqrt((squares[i] - sums[i] * sums[i] + squares[2] - sums[2] * sums[2]) / DRAWS);
        CHECK_MEAN(fabs(sums[i] - sums[2]) < 4.5 * error);
    }
}

/* Functions that answer anything: numbers without a meaning, and other statuses than 0. */
typedef struct {
    uint64_t state;
    int fails;
} hostile;

static float any(hostile *h) {
    static const float numbers[] = {NAN, INFINITY, -INFINITY, 0, -0.0f, -1, 3.4e38f, -3.4e38f, 1e-45f, 1, 0.5f, 1e30f};
    return numbers[(int)(uniform(&h->state) * (float)(sizeof numbers / sizeof *numbers))];
}

static srbf_status hostile_evaluate(void *user, size_t count, srbf_light_rows *rows) {
    hostile *h = (hostile *)user;
    (void)count; /* all sixteen, whatever was asked */
    float *numbers = &rows->direction[0][0];
    for (size_t i = 0; i < sizeof *rows / sizeof *numbers; i++) {
        numbers[i] = any(h);
    }
    for (int i = 0; i < 8; i++) {
        rows->direction[0][i] = 0.6f;
        rows->direction[1][i] = 0;
        rows->direction[2][i] = 0.8f;
    }
    return h->fails ? -77 : SRBF_STATUS_OK;
}

static srbf_status hostile_sample(void *user, size_t count, const float *u, srbf_light_rows *rows) {
    for (int i = 0; i < 48; i++) {
        CHECK(u[i] >= 0 && u[i] < 1);
    }
    return hostile_evaluate(user, count, rows);
}

static void test_hostile(srbf_mixture *mixture) {
    const float frame[9] = {1, 0, 0, 0, 0.6f, 0.8f, 0, -0.8f, 0.6f};
    hostile own = {6, 0};
    const srbf_light_source light = {&own, hostile_sample, hostile_evaluate};
    uint64_t state = 7;
    float u[3 * 32];
    srbf_product_sample drawn;
    srbf_light_block block;
    srbf_reflection reflection;
    for (int n = 0; n < MANY(3000); n++) {
        const srbf_product_sampling sampling = {2 + (uint32_t)(n % 31), (float)(n % 3) / 2, 4};
        fill(u, 96, &state);
        CHECK_OK(srbf_mixture_sample_product_from(mixture, &light, frame, &sampling, u, uniform(&state), &drawn));
        CHECK(fabsf(dot(drawn.direction, drawn.direction) - 1) < 1e-2f);
        for (int k = 0; k < 3; k++) {
            CHECK(isfinite(drawn.factor[k]) && !isnan(drawn.weight[k]));
        }
        CHECK_OK(srbf_light_block_draw_from(&light, u, &block));
        const srbf_status status = srbf_mixture_reflect_from(mixture, &light, &block, frame, frame + 6, 1 + (size_t)(n % 16), u, 0.5f, &reflection);
        CHECK(status == SRBF_STATUS_OK || status == SRBF_STATUS_AMPLITUDE);
        if (status == SRBF_STATUS_OK) {
            const float radiance[6] = {1, 1, 1, 0, 0, 0};
            float found[3];
            CHECK_OK(srbf_reflection_light_from(&reflection, radiance, found));
            CHECK(!isnan(found[0]) && !isnan(found[1]) && !isnan(found[2]));
        }
    }
    own.fails = 1;
    const srbf_product_sampling sampling = {CANDIDATES, 0.5f, INFINITY};
    CHECK_STATUS(SRBF_STATUS_LIGHT, srbf_mixture_sample_product_from(mixture, &light, frame, &sampling, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_LIGHT, srbf_light_block_draw_from(&light, u, &block));
    CHECK_STATUS(SRBF_STATUS_LIGHT, srbf_mixture_reflect_from(mixture, &light, &block, frame, frame + 6, 8, u, 0, &reflection));
    own.fails = 0;
    const srbf_light_source half[2] = {{&own, NULL, hostile_evaluate}, {&own, hostile_sample, NULL}};
    for (int i = 0; i < 2; i++) {
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product_from(mixture, &half[i], frame, &sampling, u, 0, &drawn));
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_light_block_draw_from(&half[i], u, &block));
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_reflect_from(mixture, &half[i], &block, frame, frame + 6, 8, u, 0, &reflection));
    }
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product_from(mixture, NULL, frame, &sampling, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_product_from(NULL, &light, frame, &sampling, u, 0, &drawn));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample_product_from(mixture, &light, frame, &sampling, u, 1, &drawn));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_reflection_light_from(NULL, u, u));
}

int main(int argc, char **argv) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    const float wo[3] = {0.6f, 0, 0.8f};
    srbf_material *material;
    srbf_mixture *mixture;
    CHECK(argc == 2);
    CHECK_OK(srbf_material_load(argv[1], &material));
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    CHECK_OK(srbf_material_prepare(material, wo, mixture));
    test_lamps(mixture);
    test_hostile(mixture);
    CHECK_OK(srbf_material_free(material));
    puts("light: passed");
    return 0;
}
