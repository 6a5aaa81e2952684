/* Many threads share one material and one mixture and sample at once: the same results as one thread, bit by bit.
 *
 *     threads MATERIAL.srbf
 */
#include "check.h"
#include <pthread.h>

enum { THREADS = 16, ROUNDS = MANY(4000) };

typedef struct job {
    const srbf_material *material;
    const srbf_mixture *shared;
    uint64_t seed;
    uint64_t result;
} job;

/* A number that depends on every bit of every sample. */
static void *work(void *argument) {
    job *j = (job *)argument;
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_16];
    srbf_mixture *own;
    uint64_t state = j->seed, hash = 14695981039346656037u;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &own));
    for (int i = 0; i < ROUNDS; i++) {
        float wo[3], u[3] = {uniform(&state), uniform(&state), uniform(&state)};
        srbf_sample samples[2];
        direction(&state, wo);
        CHECK_OK(srbf_material_prepare(j->material, wo, own));
        CHECK_OK(srbf_mixture_sample(own, u, &samples[0]));
        CHECK_OK(srbf_mixture_sample(j->shared, u, &samples[1]));
        unsigned char bytes[sizeof samples];
        memcpy(bytes, samples, sizeof samples);
        for (size_t b = 0; b < sizeof bytes; b++) {
            hash = (hash ^ bytes[b]) * 1099511628211u;
        }
        /* Messages are each thread's own. */
        if (i == 0) {
            CHECK(strcmp(srbf_last_message(), "") == 0);
        }
        u[0] = 2;
        CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample(own, u, &samples[0]));
    }
    j->result = hash;
    return NULL;
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    srbf_material *material;
    CHECK_OK(srbf_material_load(arguments[1], &material));
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_16];
    srbf_mixture *shared;
    const float wo[3] = {0.6f, 0, 0.8f};
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &shared));
    CHECK_OK(srbf_material_prepare(material, wo, shared));

    job jobs[THREADS];
    pthread_t threads[THREADS];
    for (int t = 0; t < THREADS; t++) {
        jobs[t] = (job){material, shared, (uint64_t)t + 1, 0};
        CHECK(pthread_create(&threads[t], NULL, work, &jobs[t]) == 0);
    }
    for (int t = 0; t < THREADS; t++) {
        CHECK(pthread_join(threads[t], NULL) == 0);
    }
    CHECK(strcmp(srbf_last_message(), "") == 0);
    for (int t = 0; t < THREADS; t++) {
        job alone = {material, shared, (uint64_t)t + 1, 0};
        pthread_t one;
        CHECK(pthread_create(&one, NULL, work, &alone) == 0 && pthread_join(one, NULL) == 0);
        CHECK(alone.result == jobs[t].result);
    }
    CHECK_OK(srbf_material_free(material));
    printf("threads: passed\n");
    return 0;
}
