/* Loads a material, prepares it for a viewer, draws directions, and prints them.
 *
 *     cc example.c $(pkg-config --cflags --libs srbf) -o example
 *     ./example presets/garnet_red.srbf
 */
#include <srbf.h>
#include <stdio.h>
#include <stdlib.h>

/* Stops with the reason where a call fails. */
static void check(srbf_status status) {
    if (status != SRBF_STATUS_OK) {
        fprintf(stderr, "srbf: %s\n", srbf_last_message());
        exit(1);
    }
}

int main(int count, char **arguments) {
    if (count != 2) {
        fprintf(stderr, "usage: example MATERIAL.srbf\n");
        return 2;
    }
    srbf_material *material;
    srbf_material_info info;
    check(srbf_material_load(arguments[1], &material));
    check(srbf_material_query(material, &info));
    printf("%zu lobes at %zu views, %zu bytes\n", info.lobes, info.views, info.byte_count);

    /* Storage for a mixture: on the stack, one a thread. */
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    srbf_mixture *mixture;
    check(srbf_mixture_init(storage, sizeof storage, &mixture));

    /* The viewer 37 degrees from the normal, which is +z. */
    const float wo[3] = {0.6f, 0.0f, 0.8f};
    srbf_mixture_info lobes;
    check(srbf_material_prepare(material, wo, mixture));
    check(srbf_mixture_query(mixture, &lobes));
    printf("albedo towards the viewer: %.3f %.3f %.3f\n", lobes.albedo[0], lobes.albedo[1], lobes.albedo[2]);

    /* Uniform numbers in [0, 1): any generator will do. */
    srand(1);
    for (int i = 0; i < 5; i++) {
        float u[3];
        for (int k = 0; k < 3; k++) {
            u[k] = (float)(rand() % 32768) / 32768;
        }
        srbf_sample sample;
        check(srbf_mixture_sample(mixture, u, &sample));
        printf("wi %6.3f %6.3f %6.3f  pdf %7.3f  weight %.3f %.3f %.3f\n", sample.direction[0],
               sample.direction[1], sample.direction[2], sample.pdf, sample.weight[0], sample.weight[1],
               sample.weight[2]);
    }
    check(srbf_material_free(material));
    return 0;
}
