/* Sizes and offsets of the structures, as capi/src/layout.rs asserts them in Rust: keep the two lists alike. */
#include <srbf.h>
#include <stddef.h>
#include <stdio.h>

#define SIZE(type, size) _Static_assert(sizeof(type) == (size), #type)
#define OFFSET(type, member, offset) _Static_assert(offsetof(type, member) == (offset), #type "." #member)

enum { P = sizeof(void *) };
_Static_assert(sizeof(size_t) == P, "sizes are as wide as pointers");

SIZE(srbf_status, 4);

SIZE(srbf_lobe, 28);
OFFSET(srbf_lobe, axis, 0);
OFFSET(srbf_lobe, sharpness, 12);
OFFSET(srbf_lobe, amplitude, 16);

SIZE(srbf_sample, 28);
OFFSET(srbf_sample, direction, 0);
OFFSET(srbf_sample, pdf, 12);
OFFSET(srbf_sample, weight, 16);

SIZE(srbf_light_sample, 28);
OFFSET(srbf_light_sample, direction, 0);
OFFSET(srbf_light_sample, pdf, 12);
OFFSET(srbf_light_sample, radiance, 16);

SIZE(srbf_environment_info, 3 * P);
OFFSET(srbf_environment_info, table, 0);
OFFSET(srbf_environment_info, table_size, P);
OFFSET(srbf_environment_info, power, 2 * P);

SIZE(srbf_product_sampling, 12);
OFFSET(srbf_product_sampling, candidates, 0);
OFFSET(srbf_product_sampling, lobe_share, 4);
OFFSET(srbf_product_sampling, kappa, 8);

SIZE(srbf_product_sample, 36);
OFFSET(srbf_product_sample, direction, 0);
OFFSET(srbf_product_sample, weight, 12);
OFFSET(srbf_product_sample, factor, 24);
SIZE(srbf_light_rows, 448);
OFFSET(srbf_light_rows, radiance, 192);
OFFSET(srbf_light_rows, pdf, 384);
SIZE(srbf_light_source, 3 * P);
OFFSET(srbf_light_source, sample, P);
OFFSET(srbf_light_source, evaluate, 2 * P);

SIZE(srbf_view, 20);
OFFSET(srbf_view, theta, 0);
OFFSET(srbf_view, log2_squeeze, 4);
OFFSET(srbf_view, log2_diffuse, 8);
OFFSET(srbf_view, diffuse_color_differences, 12);

SIZE(srbf_plane_lobe, 24);
OFFSET(srbf_plane_lobe, angle, 0);
OFFSET(srbf_plane_lobe, off_plane, 4);
OFFSET(srbf_plane_lobe, log2_sharpness, 8);
OFFSET(srbf_plane_lobe, log2_luminance, 12);
OFFSET(srbf_plane_lobe, color_differences, 16);

SIZE(srbf_vectors, 4 * P);
OFFSET(srbf_vectors, x, 0);
OFFSET(srbf_vectors, y, P);
OFFSET(srbf_vectors, z, 2 * P);
OFFSET(srbf_vectors, stride, 3 * P);

SIZE(srbf_vectors_out, 4 * P);
OFFSET(srbf_vectors_out, x, 0);
OFFSET(srbf_vectors_out, y, P);
OFFSET(srbf_vectors_out, z, 2 * P);
OFFSET(srbf_vectors_out, stride, 3 * P);

SIZE(srbf_numbers_out, 2 * P);
OFFSET(srbf_numbers_out, values, 0);
OFFSET(srbf_numbers_out, stride, P);

SIZE(srbf_samples_out, 10 * P);
OFFSET(srbf_samples_out, direction, 0);
OFFSET(srbf_samples_out, pdf, 4 * P);
OFFSET(srbf_samples_out, weight, 6 * P);

SIZE(srbf_request, 31 * P);
OFFSET(srbf_request, size, 0);
OFFSET(srbf_request, materials, P);
OFFSET(srbf_request, wo, 3 * P);
OFFSET(srbf_request, wi, 7 * P);
OFFSET(srbf_request, u, 11 * P);
OFFSET(srbf_request, value, 15 * P);
OFFSET(srbf_request, pdf, 19 * P);
OFFSET(srbf_request, samples, 21 * P);

SIZE(srbf_materials, 2 * P);
OFFSET(srbf_materials, first, 0);
OFFSET(srbf_materials, stride, P);

SIZE(srbf_material_info, (11 * P + 8 + P - 1) / P * P);
OFFSET(srbf_material_info, views, 0);
OFFSET(srbf_material_info, lobes, P);
OFFSET(srbf_material_info, squeezed_lobes, 2 * P);
OFFSET(srbf_material_info, mirrored_lobes, 3 * P);
OFFSET(srbf_material_info, bytes, 4 * P);
OFFSET(srbf_material_info, byte_count, 5 * P);
OFFSET(srbf_material_info, provenance, 6 * P);
OFFSET(srbf_material_info, provenance_length, 7 * P);
OFFSET(srbf_material_info, factor_nodes, 8 * P);
OFFSET(srbf_material_info, largest_factor, 11 * P);
OFFSET(srbf_material_info, has_signed_factors, 11 * P + 4);

SIZE(srbf_spectrum, (P + 16 + P - 1) / P * P);
OFFSET(srbf_spectrum, wavelengths, 0);
OFFSET(srbf_spectrum, first, P);
OFFSET(srbf_spectrum, last, P + 4);
OFFSET(srbf_spectrum, error, P + 8);
OFFSET(srbf_spectrum, is_grey, P + 12);

SIZE(srbf_mixture_info, (3 * P + 40 + P - 1) / P * P);
OFFSET(srbf_mixture_info, lobes, 0);
OFFSET(srbf_mixture_info, squeezed_lobes, P);
OFFSET(srbf_mixture_info, capacity, 2 * P);
OFFSET(srbf_mixture_info, domain, 3 * P);
OFFSET(srbf_mixture_info, simd_level, 3 * P + 4);
OFFSET(srbf_mixture_info, squeeze, 3 * P + 8);
OFFSET(srbf_mixture_info, diffuse, 3 * P + 12);
OFFSET(srbf_mixture_info, albedo, 3 * P + 24);
OFFSET(srbf_mixture_info, power, 3 * P + 36);

int main(void) {
    printf("layout: passed\n");
    return 0;
}
