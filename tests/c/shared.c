/* Eight threads share one material, one expanded material, one environment and one mixture, and call all that can be called with
 * them: the same results as one thread, bit by bit. Under ThreadSanitizer: no report.
 *
 *     shared MATERIAL.srbf
 */
#include "check.h"
#include <pthread.h>

enum { THREADS = 8, PAIRS = 21, ROWS = 64, WIDTH = 8, HEIGHT = 4, CANDIDATES = 4, ROUNDS = MANY(300) };

typedef struct job {
    const srbf_material *material;
    const srbf_expanded *expanded; /* NULL: the material is anisotropic */
    const srbf_environment *environment;
    const srbf_mixture *mixture;
    uint64_t seed, result;
} job;

static uint64_t hashed(uint64_t hash, const void *bytes, size_t size) {
    for (size_t b = 0; b < size; b++) {
        hash = (hash ^ ((const unsigned char *)bytes)[b]) * 1099511628211u;
    }
    return hash;
}

/* One direction: the mixture that all share, and one of its own. */
static uint64_t one_by_one(const job *j, uint64_t *state, uint64_t hash) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    srbf_mixture *own;
    srbf_sample samples[2];
    float wo[3], u[3] = {uniform(state), uniform(state), uniform(state)}, value[3], pdf, albedo[3];
    direction(state, wo);
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &own));
    CHECK_OK(srbf_material_prepare(j->material, wo, own));
    CHECK_OK(srbf_mixture_sample(own, u, &samples[0]));
    CHECK_OK(srbf_mixture_sample(j->mixture, u, &samples[1]));
    CHECK_OK(srbf_mixture_evaluate_and_pdf(j->mixture, samples[0].direction, value, &pdf));
    CHECK_OK(srbf_material_albedo(j->material, wo, albedo));
    hash = hashed(hashed(hashed(hash, samples, sizeof samples), value, sizeof value), albedo, sizeof albedo);
    if (j->expanded) {
        CHECK_OK(srbf_expanded_prepare(j->expanded, wo, own));
        CHECK_OK(srbf_mixture_sample(own, u, &samples[0]));
        hash = hashed(hash, &samples[0], sizeof samples[0]);
    }
    return hash;
}

static uint64_t light(const job *j, uint64_t *state, uint64_t hash) {
    const float u[3] = {uniform(state), uniform(state), uniform(state)}, frame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const srbf_product_sampling sampling = {CANDIDATES, 0.5f, 4};
    srbf_light_sample sample;
    srbf_product_sample product;
    float radiance[3], pdf, weight, numbers[3 * CANDIDATES];
    CHECK_OK(srbf_environment_sample(j->environment, u, &sample));
    CHECK_OK(srbf_environment_evaluate(j->environment, sample.direction, radiance, &pdf));
    for (int k = 0; k < 3 * CANDIDATES; k++) {
        numbers[k] = uniform(state);
    }
    CHECK_OK(srbf_mixture_sample_product(j->mixture, j->environment, frame, &sampling, numbers, u[0], &product));
    CHECK_OK(srbf_product_ray_weight(&sampling, 1, pdf, &weight));
    hash = hashed(hashed(hash, &sample, sizeof sample), radiance, sizeof radiance);
    return hashed(hashed(hash, &product, sizeof product), &weight, sizeof weight);
}

/* Pairs of directions, exact and expanded. */
static uint64_t pairs(const job *j, uint64_t *state, uint64_t hash) {
    float wo[PAIRS][3], wi[PAIRS][3], u[PAIRS][3], out[PAIRS][7];
    for (int i = 0; i < PAIRS; i++) {
        direction(state, wo[i]), direction(state, wi[i]);
        for (int k = 0; k < 3; k++) {
            u[i][k] = uniform(state);
        }
    }
    const srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, d = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    const srbf_vectors numbers = {u[0], u[0] + 1, u[0] + 2, 12};
    float *to = out[0];
    const srbf_samples_out samples = {{to, to + 1, to + 2, 28}, {to + 3, 28}, {to + 4, to + 5, to + 6, 28}};
    const srbf_vectors_out values = {to, to + 1, to + 2, 28};
    const srbf_numbers_out densities = {to + 3, 28};
    memset(out, 0, sizeof out);
    CHECK_OK(srbf_material_ask(j->material, PAIRS, ASK(.wo = o, .wi = d, .value = values, .pdf = densities)));
    hash = hashed(hash, out, sizeof out);
    CHECK_OK(srbf_material_ask(j->material, PAIRS, ASK(.wo = o, .u = numbers, .samples = samples)));
    hash = hashed(hash, out, sizeof out);
    if (j->expanded) {
        CHECK_OK(srbf_expanded_ask(j->expanded, PAIRS, ASK(.wo = o, .wi = d, .value = values, .pdf = densities)));
        hash = hashed(hash, out, sizeof out);
        CHECK_OK(srbf_expanded_ask(j->expanded, PAIRS, ASK(.wo = o, .u = numbers, .samples = samples)));
        hash = hashed(hash, out, sizeof out);
    }
    return hash;
}

static void *work(void *argument) {
    job *j = (job *)argument;
    uint64_t state = j->seed, hash = 14695981039346656037u;
    for (int i = 0; i < ROUNDS; i++) {
        hash = pairs(j, &state, light(j, &state, one_by_one(j, &state, hash)));
        /* Messages are each thread's own. */
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_prepare(NULL, NULL, NULL));
    }
    j->result = hash;
    return NULL;
}

/* Runs every job, each in a thread of its own, together or one after the other. */
static void run(job *jobs, int together) {
    pthread_t threads[THREADS];
    for (int t = 0; t < THREADS; t++) {
        CHECK(pthread_create(&threads[t], NULL, work, &jobs[t]) == 0);
        if (!together) {
            CHECK(pthread_join(threads[t], NULL) == 0);
        }
    }
    for (int t = 0; together && t < THREADS; t++) {
        CHECK(pthread_join(threads[t], NULL) == 0);
    }
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    srbf_material *material;
    CHECK_OK(srbf_material_load(arguments[1], &material));
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    srbf_mixture *mixture;
    const float wo[3] = {0.6f, 0, 0.8f};
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    CHECK_OK(srbf_material_prepare(material, wo, mixture));

    size_t size = 0, expanded_size = 0;
    float map[HEIGHT * WIDTH * 3];
    for (int i = 0; i < HEIGHT * WIDTH * 3; i++) {
        map[i] = (float)(i % 7);
    }
    CHECK_OK(srbf_environment_size(WIDTH, HEIGHT, &size));
    size = (size + SRBF_ENVIRONMENT_ALIGNMENT - 1) / SRBF_ENVIRONMENT_ALIGNMENT * SRBF_ENVIRONMENT_ALIGNMENT;
    void *light_memory = aligned_alloc(SRBF_ENVIRONMENT_ALIGNMENT, size);
    srbf_environment *environment;
    CHECK(light_memory != NULL);
    CHECK_OK(srbf_environment_make(WIDTH, HEIGHT, map, 0, light_memory, size, &environment));
    srbf_expanded *expanded = NULL;
    void *memory = NULL;
    srbf_view view;
    /* An anisotropic material, which has no views by angle, is not expanded. */
    if (srbf_material_view(material, 0, &view) == SRBF_STATUS_OK) {
        CHECK_OK(srbf_expanded_size(material, ROWS, &expanded_size));
        CHECK((memory = malloc(expanded_size)) != NULL);
        CHECK_OK(srbf_expanded_make(material, ROWS, memory, expanded_size, &expanded));
    }

    job together[THREADS], alone[THREADS];
    for (int t = 0; t < THREADS; t++) {
        together[t] = (job){material, expanded, environment, mixture, (uint64_t)t + 1, 0};
        alone[t] = together[t];
    }
    run(together, 1), run(alone, 0);
    for (int t = 0; t < THREADS; t++) {
        CHECK(together[t].result == alone[t].result);
    }
    CHECK_OK(srbf_material_free(material));
    free(memory), free(light_memory);
    printf("shared: passed\n");
    return 0;
}
