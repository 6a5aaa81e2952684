//! Sizes and offsets of the structures, as tests/c/layout.c asserts them in C: keep the two lists alike.

use crate::environment::{
    srbf_environment_info, srbf_light_sample, srbf_product_sample, srbf_product_sampling,
};
use crate::lobe::srbf_lobe;
use crate::material::{srbf_material_info, srbf_plane_lobe, srbf_view};
use crate::mixture::srbf_mixture_info;
use crate::request::{srbf_materials, srbf_request};
use crate::single::srbf_sample;
use crate::status::srbf_status;
use crate::streams::{srbf_numbers_out, srbf_samples_out, srbf_vectors, srbf_vectors_out};
use core::mem::offset_of;

const P: usize = size_of::<usize>();

const _: () = {
    assert!(size_of::<srbf_status>() == 4);
    assert!(size_of::<srbf_lobe>() == 28);
    assert!(offset_of!(srbf_lobe, axis) == 0);
    assert!(offset_of!(srbf_lobe, sharpness) == 12);
    assert!(offset_of!(srbf_lobe, amplitude) == 16);
    assert!(size_of::<srbf_sample>() == 28);
    assert!(offset_of!(srbf_sample, direction) == 0);
    assert!(offset_of!(srbf_sample, pdf) == 12);
    assert!(offset_of!(srbf_sample, weight) == 16);
    assert!(size_of::<srbf_light_sample>() == 28);
    assert!(offset_of!(srbf_light_sample, direction) == 0);
    assert!(offset_of!(srbf_light_sample, pdf) == 12);
    assert!(offset_of!(srbf_light_sample, radiance) == 16);
    assert!(size_of::<srbf_environment_info>() == 3 * P);
    assert!(offset_of!(srbf_environment_info, table) == 0);
    assert!(offset_of!(srbf_environment_info, table_size) == P);
    assert!(offset_of!(srbf_environment_info, power) == 2 * P);
    assert!(size_of::<srbf_product_sampling>() == 12);
    assert!(offset_of!(srbf_product_sampling, candidates) == 0);
    assert!(offset_of!(srbf_product_sampling, lobe_share) == 4);
    assert!(offset_of!(srbf_product_sampling, kappa) == 8);
    assert!(size_of::<srbf_product_sample>() == 24);
    assert!(offset_of!(srbf_product_sample, direction) == 0);
    assert!(offset_of!(srbf_product_sample, weight) == 12);
    assert!(size_of::<srbf_view>() == 20);
    assert!(offset_of!(srbf_view, theta) == 0);
    assert!(offset_of!(srbf_view, log2_squeeze) == 4);
    assert!(offset_of!(srbf_view, log2_diffuse) == 8);
    assert!(offset_of!(srbf_view, diffuse_color_differences) == 12);
    assert!(size_of::<srbf_plane_lobe>() == 24);
    assert!(offset_of!(srbf_plane_lobe, angle) == 0);
    assert!(offset_of!(srbf_plane_lobe, off_plane) == 4);
    assert!(offset_of!(srbf_plane_lobe, log2_sharpness) == 8);
    assert!(
        offset_of!(srbf_plane_lobe, log2_luminance) == 12
            && offset_of!(srbf_plane_lobe, color_differences) == 16
    );
    assert!(size_of::<srbf_vectors>() == 4 * P);
    assert!(offset_of!(srbf_vectors, x) == 0);
    assert!(offset_of!(srbf_vectors, y) == P);
    assert!(offset_of!(srbf_vectors, z) == 2 * P);
    assert!(offset_of!(srbf_vectors, stride) == 3 * P);
    assert!(size_of::<srbf_vectors_out>() == 4 * P);
    assert!(offset_of!(srbf_vectors_out, x) == 0);
    assert!(offset_of!(srbf_vectors_out, y) == P);
    assert!(offset_of!(srbf_vectors_out, z) == 2 * P);
    assert!(offset_of!(srbf_vectors_out, stride) == 3 * P);
    assert!(size_of::<srbf_numbers_out>() == 2 * P);
    assert!(offset_of!(srbf_numbers_out, values) == 0);
    assert!(offset_of!(srbf_numbers_out, stride) == P);
    assert!(size_of::<srbf_samples_out>() == 10 * P);
    assert!(offset_of!(srbf_samples_out, direction) == 0);
    assert!(offset_of!(srbf_samples_out, pdf) == 4 * P);
    assert!(offset_of!(srbf_samples_out, weight) == 6 * P);
    assert!(size_of::<srbf_request>() == 31 * P);
    assert!(offset_of!(srbf_request, size) == 0);
    assert!(offset_of!(srbf_request, materials) == P);
    assert!(offset_of!(srbf_request, wo) == 3 * P);
    assert!(offset_of!(srbf_request, wi) == 7 * P);
    assert!(offset_of!(srbf_request, u) == 11 * P);
    assert!(offset_of!(srbf_request, value) == 15 * P);
    assert!(offset_of!(srbf_request, pdf) == 19 * P);
    assert!(offset_of!(srbf_request, samples) == 21 * P);
    assert!(size_of::<srbf_materials>() == 2 * P);
    assert!(offset_of!(srbf_materials, first) == 0);
    assert!(offset_of!(srbf_materials, stride) == P);
    assert!(size_of::<srbf_material_info>() == (11 * P + 8).next_multiple_of(P));
    assert!(offset_of!(srbf_material_info, views) == 0);
    assert!(offset_of!(srbf_material_info, lobes) == P);
    assert!(offset_of!(srbf_material_info, squeezed_lobes) == 2 * P);
    assert!(offset_of!(srbf_material_info, mirrored_lobes) == 3 * P);
    assert!(offset_of!(srbf_material_info, bytes) == 4 * P);
    assert!(offset_of!(srbf_material_info, byte_count) == 5 * P);
    assert!(offset_of!(srbf_material_info, provenance) == 6 * P);
    assert!(offset_of!(srbf_material_info, provenance_length) == 7 * P);
    assert!(offset_of!(srbf_material_info, factor_nodes) == 8 * P);
    assert!(offset_of!(srbf_material_info, largest_factor) == 11 * P);
    assert!(size_of::<srbf_mixture_info>() == (3 * P + 40).next_multiple_of(P));
    assert!(offset_of!(srbf_mixture_info, lobes) == 0);
    assert!(offset_of!(srbf_mixture_info, squeezed_lobes) == P);
    assert!(offset_of!(srbf_mixture_info, capacity) == 2 * P);
    assert!(offset_of!(srbf_mixture_info, domain) == 3 * P);
    assert!(offset_of!(srbf_mixture_info, simd_level) == 3 * P + 4);
    assert!(offset_of!(srbf_mixture_info, squeeze) == 3 * P + 8);
    assert!(offset_of!(srbf_mixture_info, diffuse) == 3 * P + 12);
    assert!(offset_of!(srbf_mixture_info, albedo) == 3 * P + 24);
    assert!(offset_of!(srbf_mixture_info, power) == 3 * P + 36);
};
