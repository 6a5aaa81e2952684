/* Spectra of the colours of a material: with a map of 3 wavelengths, of one wavelength, and without a map.
 *
 *     spectrum MATERIAL.srbf
 *
 * The columns are (0.25, 0, 0), (0, 1, 0) and (0, 0, 0.5) at 450, 550 and 950 nm; or 1 for the luminance at 905 nm.
 */
#include "check.h"

static int is_near(float a, float b) { return fabsf(a - b) <= 2e-5f; }

static void test_map(const srbf_material *material) {
    const float nm[5] = {400, 500, 550, 950, 2000}, white[3] = {1, 1, 1}, dark[3] = {-1, 0.5f, 0};
    float primaries[15], values[5];
    CHECK_OK(srbf_material_primaries(material, nm, 5, primaries));
    CHECK(is_near(primaries[0], 0.25f) && is_near(primaries[3], 0.125f) && is_near(primaries[4], 0.5f));
    CHECK(is_near(primaries[7], 1) && is_near(primaries[11], 0.5f) && is_near(primaries[14], 0.5f));
    CHECK_OK(srbf_primaries_of(primaries, 5, white, values));
    CHECK(is_near(values[0], 0.25f) && is_near(values[1], 0.625f) && is_near(values[2], 1) && is_near(values[4], 0.5f));
    CHECK_OK(srbf_primaries_of(primaries, 5, dark, values));
    CHECK(values[0] == 0 && is_near(values[1], 0.125f) && is_near(values[2], 0.5f) && is_near(values[3], 0));
    CHECK_OK(srbf_material_primaries(material, NULL, 0, NULL));
    CHECK_OK(srbf_primaries_of(NULL, 0, white, NULL));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_primaries(material, primaries, 5, primaries));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_primaries_of(primaries, 5, white, primaries + 14));
}

static void test_others(const srbf_material *material, int is_grey) {
    const float nm[3] = {450, 905, 1e6f}, colour[3] = {0.5f, 0.25f, 1};
    float primaries[9], values[3];
    CHECK_OK(srbf_material_primaries(material, nm, 3, primaries));
    CHECK_OK(srbf_primaries_of(primaries, 3, colour, values));
    for (int i = 0; i < 3; i++) {
        const float luminance = 0.2126f * colour[0] + 0.7152f * colour[1] + 0.0722f * colour[2];
        if (is_grey) CHECK(is_near(values[i], luminance));
        else CHECK(is_near(primaries[3 * i] + primaries[3 * i + 1] + primaries[3 * i + 2], 1));
    }
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    srbf_material *material;
    srbf_spectrum spectrum;
    CHECK_OK(srbf_material_load(arguments[1], &material));
    CHECK_OK(srbf_material_spectrum(material, &spectrum));
    if (spectrum.wavelengths == 3) {
        CHECK(spectrum.first == 450 && spectrum.last == 950 && spectrum.error == 0.125f && spectrum.is_grey == 0);
        test_map(material);
    } else {
        const int is_grey = spectrum.is_grey == 1;
        CHECK(spectrum.wavelengths == (size_t)is_grey && spectrum.first == (is_grey ? 905.0f : 0.0f));
        CHECK(spectrum.last == spectrum.first && spectrum.error == 0);
        test_others(material, is_grey);
    }
    srbf_material_free(material);
    printf("spectrum: passed\n");
    return 0;
}
