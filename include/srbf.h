/*
 * srbf: measured BRDFs as small mixtures of spherical Gaussian lobes: evaluate, integrate, importance-sample.
 * Generated from capi/src, do not edit. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * A material (`srbf_material`) holds lobes for every outgoing direction. `srbf_material_prepare` makes of it the mixture
 * (`srbf_mixture`) for one outgoing direction `wo`; the mixture evaluates, integrates and samples.
 *
 * Fifteen functions that are enough for most renderers; the others are for many hits, little memory, light and other surfaces
 *   A material          srbf_material_load, srbf_material_from_bytes, srbf_material_free, srbf_material_query
 *   One hit             srbf_material_sample, srbf_material_evaluate, srbf_material_pdf, srbf_material_evaluate_and_pdf,
 *                       srbf_material_sample_and_evaluate, srbf_material_albedo
 *   n hits              srbf_material_ask
 *   A fit               srbf_fit_table, srbf_material_save
 *   Errors, versions    srbf_last_message, srbf_version
 *
 * Words
 *   Directions are unit vectors, three floats, in the caller's shading frame, +z the surface normal. `wo` points towards
 *   the viewer and is fixed, `wi` points towards the light and is sampled. The value is `f cos`: the BRDF times the
 *   cosine of `wi`, in 1/sr, linear sRGB. A density (pdf) is per solid angle, 1/sr.
 *   Order of arguments: object, count, inputs, outputs; but the bytes of a file, raw storage and mixtures come before their size
 *   or stride.
 *
 * Status
 *   Calls that can fail return a `srbf_status`: 0 is success. A call that fails leaves its outputs as they were, unless its
 *   page says otherwise, and keeps a message for the thread: `srbf_last_message`. The message begins with the name of the argument
 *   that is wrong, where it is one. No call prints, exits or lets a panic out, but for a bug in the library: Rust prints a line about
 *   a panic to the standard error, the call returns `SRBF_STATUS_PANIC`, and its outputs are unspecified.
 *
 * Pointers
 *   The caller owns every buffer. A pointer is to as many readable or writable elements as its page says, or NULL; NULL and
 *   misaligned pointers are refused by a status. Inputs may overlap each other. In calls for one direction, outputs may
 *   overlap inputs, but not an object, the `.srbf` bytes of a material, or another output. In requests (`srbf_request`) an output
 *   that overlaps anything is refused; arrays of one stride may interleave, so that inputs and outputs can be members of one
 *   structure.
 *
 * Threads
 *   Every function may be called from every thread. Objects behind const pointers may be shared; the outputs of a call belong to
 *   that call alone until it returns.
 *
 * Without an operating system
 *   Built without `std` the library needs neither an operating system nor an allocator, and offers everything but files,
 *   fitting, messages and materials on the heap. Define SRBF_FREESTANDING before the header to hide those. A panic, a bug,
 *   stops the thread there for ever.
 *
 * Two libraries
 *   `srbf` has the functions of run time. `srbf_fit` has them too, and `srbf_fit_...` and `srbf_material_save` beside them: a
 *   program that calls those links `srbf_fit` in the place of `srbf`.
 */

#ifndef SRBF_H
#define SRBF_H

#include <stddef.h>
#include <stdint.h>

#if !defined(SRBF_FREESTANDING)
#define SRBF_HOSTED 1
#endif

/// Version of this header: `major * 10000 + minor * 100 + patch`.
///
/// Compare with `srbf_version()` to see whether header and library belong together.
#define SRBF_VERSION 100

/// Version of the `.srbf` bytes that are written. Every version from 1 to this one is read.
#define SRBF_FORMAT_VERSION 3

/// The best level of this processor and build.
#define SRBF_SIMD_AUTOMATIC 0

/// One number at a time: the reference for every other level.
#define SRBF_SIMD_SCALAR 1

/// SSE2, NEON, or the instructions that the whole library was compiled for.
#define SRBF_SIMD_PORTABLE 2

/// x86-64 with AVX2 and FMA.
#define SRBF_SIMD_AVX2 3

/// x86-64 with AVX-512 F, VL, DQ and BW.
#define SRBF_SIMD_AVX512 4

/// Alignment of the storage for a mixture, which is also what `malloc` gives on 64-bit platforms; 64 is a little faster.
#define SRBF_MIXTURE_ALIGNMENT 16

/// Bytes of storage for a mixture of at most 16 lobes.
#define SRBF_MIXTURE_SIZE_16 1280

/// Bytes of storage for a mixture of at most 32 lobes.
#define SRBF_MIXTURE_SIZE_32 2304

/// Bytes of storage for a mixture of at most 64 lobes, the most that there are.
#define SRBF_MIXTURE_SIZE_64 4352

/// The whole sphere: no fold.
#define SRBF_DOMAIN_SPHERE 0

/// The upper hemisphere: the part of a lobe below the horizon is mirrored back up.
#define SRBF_DOMAIN_HEMISPHERE 1

/// Bytes of storage for a material that `srbf_material_borrow` makes.
#define SRBF_MATERIAL_SIZE 128

/// Alignment of that storage.
#define SRBF_MATERIAL_ALIGNMENT 16

/// Alignment of the storage for an expanded material, which is also what `malloc` gives on 64-bit platforms.
#define SRBF_EXPANDED_ALIGNMENT 16

/// Rows at which the error of an expanded material is below 1e-3 of the largest value on every material that was tried.
#define SRBF_EXPANDED_DEFAULT_ROWS 1024

/// Bytes of storage for a sheet that `srbf_sheet_borrow` makes.
#define SRBF_SHEET_SIZE 768

/// Alignment of that storage.
#define SRBF_SHEET_ALIGNMENT 16

/// Most parts of a blend.
#define SRBF_MAX_BLEND 8

/// Alignment of the storage for an environment: that of a cache line.
#define SRBF_ENVIRONMENT_ALIGNMENT 64

/// Bytes of storage for an environment whose table lies elsewhere, see `srbf_environment_read`.
#define SRBF_ENVIRONMENT_HEAD_SIZE 64

/// Most candidates of `srbf_mixture_sample_product`.
#define SRBF_PRODUCT_MAX_CANDIDATES 32

/// Samples of the light in a block.
#define SRBF_LIGHT_BLOCK 16

/// Most directions of the lobes of `srbf_mixture_reflect`.
#define SRBF_MAX_REFLECT_RAYS 16

/// In place of a number of a fit: it is chosen by what turns out best.
#define SRBF_FIT_AUTOMATIC 65535

/// Bytes of the verdict of a fit, the zero at its end among them.
#define SRBF_FIT_VERDICT_SIZE 4096

/// Light from infinitely far away, a latitude-longitude map, in the caller's storage.
///
/// Row 0 of the map looks up, along +z. The centre of the map looks along +x. To the right in the map is to the right for an
/// observer inside, towards -y. Between the centres of pixels the radiance is interpolated; directions are drawn by its luminance.
///
/// It never changes, so any number of threads may use one at once. It needs no release. Its bytes may not be moved.
typedef struct srbf_environment srbf_environment;

/// A material made ready for speed: lobes for many angles of the outgoing direction, in the caller's storage.
///
/// It never changes, so any number of threads may use one at once. It needs no release. Its bytes may not be moved. The bytes of
/// the material that it was made from must live, and stay as they are, for as long as it is used.
typedef struct srbf_expanded srbf_expanded;

/// A material: the lobes of every view, read in place from `.srbf` bytes.
///
/// It never changes, so any number of threads may use one at once. Made by `srbf_material_borrow` in the caller's
/// storage, or on the heap by `srbf_material_from_bytes` and `srbf_material_load`, which `srbf_material_free` releases.
typedef struct srbf_material srbf_material;

/// The lobes of one outgoing direction, in the caller's storage.
///
/// Get its size from `srbf_mixture_size` or a constant `SRBF_MIXTURE_SIZE_...`, and the object by `srbf_mixture_init` or
/// `srbf_material_prepare_into`. It owns nothing: it needs no release, and its bytes may be copied within a process to
/// storage of the same size and alignment.
///
/// One that a material with factors has made, see `srbf_material_factor_nodes`, reads them from the material's bytes whenever it is
/// evaluated or sampled: the material must live, and its bytes stay as they are, for as long as the mixture or a copy of it is used. A
/// mixture of any other material, or of the caller's lobes, stands by itself.
typedef struct srbf_mixture srbf_mixture;

/// A sheet: reflection and transmission, seen from the front and from the back, read in place from `.srbf` bytes.
///
/// Directions are unit vectors in the frame of the sheet, whose front is +z; `wo` and `wi` may lie in front or behind. It never changes, so any
/// number of threads may use one at once.
typedef struct srbf_sheet srbf_sheet;

/// The result of a call: 0 if it succeeded, otherwise the reason. The numbers never change their meaning.
typedef int32_t srbf_status;

/// One spherical Gaussian lobe, `amplitude exp(sharpness (d . axis - 1))` over the whole sphere.
///
/// `srbf_mixture_from_lobes` makes a mixture of it, on `SRBF_DOMAIN_SPHERE` with the lobe's own values, integral, density and products.
/// It checks it: `SRBF_STATUS_AXIS`, `SRBF_STATUS_SHARPNESS`, `SRBF_STATUS_AMPLITUDE`.
typedef struct srbf_lobe {
    /// Where the lobe is highest; unit vector.
    float axis[3];
    /// How narrow the lobe is, in [0, 1e8]; 0 is constant over the sphere.
    float sharpness;
    /// Value at the axis, linear sRGB. A channel may be negative, the luminance not, and no channel beyond 32 times that.
    float amplitude[3];
} srbf_lobe;

/// Properties of a mixture.
typedef struct srbf_mixture_info {
    /// Number of lobes.
    size_t lobes;
    /// Number of lobes that see the squeezed direction; they come first.
    size_t squeezed_lobes;
    /// Most lobes that the storage has room for.
    size_t capacity;
    /// `SRBF_DOMAIN_SPHERE` or `SRBF_DOMAIN_HEMISPHERE`.
    uint32_t domain;
    /// The SIMD level that the mixture was made at.
    uint32_t simd_level;
    /// The squeeze c; 1 is no squeeze.
    float squeeze;
    /// Albedo of the diffuse term, `diffuse cos / pi` beside the lobes, linear sRGB.
    float diffuse[3];
    /// Integral of `f cos` over the domain, linear sRGB: for a material's mixture, the albedo. With factors, which
    /// leave it no closed form, a material stores for its views by how much they change it, and that is interpolated.
    float albedo[3];
    /// Luminance of the integral of lobes and diffuse term: what densities are normalised by, and the luminance of the weight of
    /// every sample. In a material with factors the latter is multiplied by its factor.
    float power;
} srbf_mixture_info;

/// Properties of a material.
typedef struct srbf_material_info {
    /// Number of views: outgoing directions at which lobes are stored.
    size_t views;
    /// Number of lobes of a mixture, for which it must have room.
    size_t lobes;
    /// Number of lobes that see the squeezed direction; they come first.
    size_t squeezed_lobes;
    /// Number of stored lobes that stand for two, one on either side of the plane of incidence; they come last. A view stores
    /// `lobes - mirrored_lobes` lobes.
    size_t mirrored_lobes;
    /// The `.srbf` bytes; they live as long as the material.
    const uint8_t *bytes;
    /// Number of bytes.
    size_t byte_count;
    /// Where the material comes from, as its maker wrote it: UTF-8 without a zero at the end, part of the bytes.
    const char *provenance;
    /// Length of the provenance in bytes.
    size_t provenance_length;
    /// Nodes of the table of factors along half angle, difference angle and azimuth, see `srbf_material_factor_node`; 0 without
    /// one.
    ///
    /// A mixture of a material with factors reads them from the material: see `srbf_mixture`.
    size_t factor_nodes[3];
    /// What no factor exceeds but for rounding, the largest of any node and channel; 1 without a table.
    ///
    /// The luminance of a sample's weight is at most the power of its mixture times this, where no channel of a lobe is negative.
    float largest_factor;
    /// 1 if nodes along the azimuth are from -1 to 1, so that factors are others where the two directions change places; else 0.
    uint32_t has_signed_factors;
} srbf_material_info;

/// An outgoing direction at which a material stores lobes.
typedef struct srbf_view {
    /// Angle from the normal in radians, [0, pi/2].
    float theta;
    /// Base-2 logarithm of the squeeze c: how many times as wide across the plane of incidence as along it.
    float log2_squeeze;
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term, `albedo cos / pi` beside the lobes; -126 for none.
    float log2_diffuse;
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`.
    float diffuse_color_differences[2];
} srbf_view;

/// A lobe as a view stores it: its axis in the plane of incidence, or off it if it is a mirrored one.
typedef struct srbf_plane_lobe {
    /// Angle of the axis from the normal in radians, within the plane of incidence, positive towards the mirror direction.
    float angle;
    /// Angle of the axis out of the plane of incidence in radians; 0 but for a mirrored lobe.
    float off_plane;
    /// Base-2 logarithm of the sharpness.
    float log2_sharpness;
    /// Base-2 logarithm of the luminance Y of the amplitude; -126 for none.
    float log2_luminance;
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`.
    float color_differences[2];
} srbf_plane_lobe;

/// n vectors to read.
///
/// Structure of arrays: three arrays and a stride of `sizeof(float)`, which is the fastest. Array of structures:
/// `{&v[0].x, &v[0].y, &v[0].z, sizeof v[0]}`.
typedef struct srbf_vectors {
    /// The first x.
    const float *x;
    /// The first y.
    const float *y;
    /// The first z.
    const float *z;
    /// Bytes from one number to the next of the same array; a multiple of 4, at least 4.
    size_t stride;
} srbf_vectors;

/// The map of a material from its colours to spectra.
typedef struct srbf_spectrum {
    /// Number of wavelengths that it has; 0 for a material without one, whose spectra are fixed smooth ones.
    size_t wavelengths;
    /// The first wavelength in nm; 0 without a map.
    float first;
    /// The last wavelength in nm; 0 without a map.
    float last;
    /// Relative L2 distance of the measured spectra from those of their colours; 0 without a map.
    float error;
    /// 1 if the spectrum is that of a luminance, as of one wavelength; else 0.
    uint32_t is_grey;
} srbf_spectrum;

/// A direction drawn from a mixture.
typedef struct srbf_sample {
    /// Incident direction, unit vector in the caller's shading frame.
    float direction[3];
    /// Density of the whole mixture at the direction; 1/sr. 0 where nothing was drawn, else above 0.
    float pdf;
    /// `f cos / pdf`, linear sRGB: the factor on the throughput of a path. 0 where the density is below 1.2e-38.
    float weight[3];
} srbf_sample;

/// n materials to read, by pointers to them.
typedef struct srbf_materials {
    /// The first pointer.
    const struct srbf_material *const *first;
    /// Bytes from one pointer to the next; a multiple of their alignment, at least their size.
    size_t stride;
} srbf_materials;

/// n vectors to write; laid out as `srbf_vectors`.
///
/// Colours are vectors too: red, green and blue in the place of x, y and z.
typedef struct srbf_vectors_out {
    /// The first x.
    float *x;
    /// The first y.
    float *y;
    /// The first z.
    float *z;
    /// Bytes from one number to the next of the same array; a multiple of 4, at least 4.
    size_t stride;
} srbf_vectors_out;

/// n numbers to write.
typedef struct srbf_numbers_out {
    /// The first number.
    float *values;
    /// Bytes from one number to the next; a multiple of 4, at least 4.
    size_t stride;
} srbf_numbers_out;

/// Where n samples go; see `srbf_sample`.
typedef struct srbf_samples_out {
    /// Incident directions, unit vectors in the caller's shading frame.
    struct srbf_vectors_out direction;
    /// Density of the whole mixture at the direction; 1/sr. 0 where nothing was drawn, else above 0.
    struct srbf_numbers_out pdf;
    /// `f cos / pdf`, linear sRGB.
    struct srbf_vectors_out weight;
} srbf_samples_out;

/// The inputs and the wanted outputs for each of n hits. Start from zeros, set `size`, the inputs and the wanted outputs.
///
/// `sizeof(srbf_request)` in `size` lets later versions ask for more. An output whose first pointer is NULL is not wanted:
/// `value.x`, `pdf.values`, `samples.direction.x`, `samples.pdf.values`, `samples.weight.x`. Inputs that no output needs are not
/// looked at. Each array has n elements; outputs are overwritten, and may overlap nothing, inputs may overlap each other.
///
/// A call checks the arrays that are asked for, and no others, before it writes anything. No pointer may be NULL or misaligned, and
/// arrays end within the address space. No number of an output may lie upon another output, an input, the request, the object or
/// its bytes. Numbers themselves are not looked at.
///
/// Where nothing is reflected, and for a `wo` that is no unit vector, values and densities are 0 and the normal is drawn with density
/// 0. A `wi` that is no unit vector gives an unspecified value, and so does a number `u` outside [0, 1); others are not touched by it.
///
/// Every call that takes one refuses by `SRBF_STATUS_SIZE` a size that is not `sizeof(srbf_request)`, by `SRBF_STATUS_ARGUMENT`
/// densities or weights of draws without directions. n = 0 looks at no pointer, and succeeds.
typedef struct srbf_request {
    /// `sizeof(srbf_request)`.
    size_t size;
    /// Materials, n; looked at by `srbf_material_ask` without a material.
    struct srbf_materials materials;
    /// Outgoing directions, n unit vectors; a mixture has its own, and does not look at them.
    struct srbf_vectors wo;
    /// Incident directions, n unit vectors; looked at if `value` or `pdf` is wanted.
    struct srbf_vectors wi;
    /// Three uniform numbers in [0, 1) a hit; looked at if directions are drawn.
    struct srbf_vectors u;
    /// `f cos` towards `wi`, linear sRGB; 1/sr.
    struct srbf_vectors_out value;
    /// Density of drawing `wi`; 1/sr.
    struct srbf_numbers_out pdf;
    /// Directions that are drawn, with densities and weights if they are wanted too.
    struct srbf_samples_out samples;
} srbf_request;

/// Properties of a sheet.
///
/// Its quarters are reflection and transmission seen from the front, then those seen from the back. Each is a material, which
/// `srbf_material_borrow` makes of its bytes; directions of the material lie above the horizon: of one behind the sheet the height changes
/// its sign.
typedef struct srbf_sheet_info {
    /// The `.srbf` bytes of each quarter, which live as long as the sheet; NULL of one that is black.
    const uint8_t *quarters[4];
    /// Number of bytes of each.
    size_t quarter_byte_counts[4];
    /// 1 if the back is like the front, whose quarters it has then; else 0.
    uint32_t is_symmetric;
    /// Most lobes of a quarter.
    size_t lobes;
    /// The `.srbf` bytes of the sheet.
    const uint8_t *bytes;
    /// Number of bytes.
    size_t byte_count;
    /// Where the sheet comes from: UTF-8 without a zero at the end.
    const char *provenance;
    /// Length of the provenance in bytes.
    size_t provenance_length;
} srbf_sheet_info;

/// A part of a blend: a material or a mixture, with its weight and a tint. Start from zeros.
///
/// A blend is an array of 1 to `SRBF_MAX_BLEND` parts: its value is the sum of their values, each times weight and tint. Weights need not sum
/// to 1. A part of weight 0, or of a black tint, costs nothing. Where one part is left, a hit is one on that part alone.
///
/// Every call that takes parts refuses by `SRBF_STATUS_ARGUMENT` none and too many. It refuses by
/// `SRBF_STATUS_WEIGHT` a weight, a tint or a coat out of its range, and weights of which none is above 0.
typedef struct srbf_blend_part {
    /// The material; or NULL.
    const struct srbf_material *material;
    /// Looked at without a material: a mixture that has the outgoing direction of the call, or one of the caller's lobes.
    const struct srbf_mixture *mixture;
    /// From 0 to 1000.
    float weight;
    /// By this the channels of its values are multiplied, linear sRGB, from 0 to 1000.
    float tint[3];
    /// Refractive index of a clear coat above it, from 1 to 10; 0 for none.
    ///
    /// Values are multiplied by its transmittance for both directions: 1 minus `srbf_fresnel` of each. Light that the coat reflects is
    /// a part of its own.
    float coat;
} srbf_blend_part;

/// What an environment holds.
typedef struct srbf_environment_info {
    /// The bytes that `srbf_environment_read` reads, for the caller to store: within the environment's storage, at a multiple of
    /// 64.
    const void *table;
    /// How many there are.
    size_t table_size;
    /// The integral of the luminance over the sphere: the luminance of every sample's radiance over its density.
    float power;
} srbf_environment_info;

/// A direction drawn from an environment.
typedef struct srbf_light_sample {
    /// Unit vector in the world, towards the light.
    float direction[3];
    /// Density at the direction; 1/sr.
    float pdf;
    /// Radiance from there, linear sRGB.
    float radiance[3];
} srbf_light_sample;

/// How light and material are sampled together.
typedef struct srbf_product_sampling {
    /// Candidates of a draw, 2 to 32. Variance falls with them where nothing is occluded, and time grows: 32 take about twice the
    /// time of 8.
    uint32_t candidates;
    /// The share of them that is drawn from the lobes, in [0, 1], rounded to whole candidates; 0.5 serves well. Where it rounds to
    /// none or to all, one of the two is never drawn from, and a weight has no bound. A sharp highlight may lie away from the
    /// light, or a small sun away from the highlight. The mean of tens of thousands of draws may then be half of the integral.
    float lobe_share;
    /// At least 1e-3: infinite where the candidates are to give all of the light; 4 serves well where the light along the path's
    /// own ray counts too, weighed by `srbf_product_ray_weight`.
    float kappa;
} srbf_product_sampling;

/// A direction drawn for light and material together.
typedef struct srbf_product_sample {
    /// Unit vector in the world, towards the light: where the shadow ray goes.
    float direction[3];
    /// The light that is reflected to the viewer if nothing is in the way, linear sRGB; all 0: nothing was drawn.
    float weight[3];
    /// `f cos` over the density of such a draw: the factor on the true radiance from there, where the light's is an estimate.
    float factor[3];
} srbf_product_sample;

/// Sixteen samples of an environment as rows: what `srbf_mixture_reflect` reads. A block at a multiple of 64 is the fastest.
///
/// Blocks are made before rendering, as many as the caller has memory for: a *tile* of some thousand, of the points of one evenly
/// spread sequence, serves all pixels. Where sample i of a pixel takes block i, or i with some bits flipped, the pixel's blocks
/// are evenly spread too.
typedef struct srbf_light_block {
    /// Unit vectors in the world, towards the light: x, y, z.
    float direction[3][16];
    /// Radiance from there over the density: red, green, blue; linear sRGB.
    float light[3][16];
    /// Densities; 1/sr.
    float pdf[16];
} srbf_light_block;

/// What light a surface reflects, but for two rays: see `srbf_mixture_reflect`.
typedef struct srbf_reflection {
    /// The path's own ray, drawn from the mixture; density 0 where that reflects nothing.
    struct srbf_sample ray;
    /// Unit vector in the world, towards the light: where the shadow ray goes; all 0 where none is needed.
    float shadow[3];
    /// What `f cos` towards the ray is multiplied by to be the light from there; linear sRGB.
    float ray_light[3];
    /// Likewise towards the shadow ray.
    float shadow_light[3];
    /// What radiance along the ray is multiplied by to be `ray_light`; sr.
    float ray_factor;
    /// Likewise of the shadow ray.
    float shadow_factor;
    /// `f cos` of the mixture towards the ray; 1/sr.
    float ray_value[3];
    /// Likewise towards the shadow ray.
    float shadow_value[3];
    /// The mean of all directions of the block, without shadows; linear sRGB, in the unit of the map.
    float block_sum[3];
    /// Likewise of the lobes.
    float ray_sum[3];
} srbf_reflection;

/// Up to sixteen directions of a light as rows, filled by the functions of a `srbf_light_source`.
typedef struct srbf_light_rows {
    /// Unit vectors in the world, towards the light: x, y, z.
    float direction[3][16];
    /// Estimates of the radiance from there: red, green, blue; linear sRGB, not negative.
    float radiance[3][16];
    /// Densities; 1/sr.
    float pdf[16];
} srbf_light_rows;

/// Light that can be drawn from, as two functions of the caller: one learnt from a renderer's own paths, or lamps that a surface sees.
///
/// The functions give the density of the draws, and an estimate of the radiance. A draw is multiplied by the renderer's own
/// radiance along the direction, so that the mean is right whatever the estimate is. Two things are asked for that: both functions give
/// the density that directions are drawn with, 0 for a draw that finds nothing; and the estimate is above 0 wherever the true radiance
/// may be, if only by little. A number that has no meaning, such as a density that is NaN, counts as no light.
///
/// A function gives 0. Any other number makes the call that asked it give `SRBF_STATUS_LIGHT`. It has to return, by no exception and no
/// jump; it may call this library. It is called in the thread of the call that asks it.
typedef struct srbf_light_source {
    /// Given to both functions as it is; may be NULL.
    void *user;
    /// Draws `count` directions, 1 to 16, each by itself with the density that it tells. Shapes: `u` [3][16], uniform numbers in [0, 1),
    /// of which the first `count` of each row count; `rows` overwritten, the first `count` of each row.
    srbf_status (*sample)(void *user, size_t count, const float *u, struct srbf_light_rows *rows);
    /// Gives estimates of the radiance, and the density of `sample`, of the first `count` directions of `rows`, 1 to 16.
    srbf_status (*evaluate)(void *user, size_t count, struct srbf_light_rows *rows);
} srbf_light_source;

/// How a material is fitted. `srbf_fit_settings_default` fills it in; a caller changes the fields that he cares about.
typedef struct srbf_fit_settings {
    /// Lobes of every view, 1 to 64; more fit better and cost more at run time. Default: 12.
    size_t lobes;
    /// How many of them are squeezed, or `SRBF_FIT_AUTOMATIC`, the default.
    size_t squeezed_lobes;
    /// Pairs of lobes that are mirrored in the plane of incidence, or `SRBF_FIT_AUTOMATIC`, the default.
    size_t mirrored_pairs;
    /// Views of the material, 2 to 256, or `SRBF_FIT_AUTOMATIC`, the default.
    size_t views;
    /// Nodes of the table of factors over half angle, difference angle and azimuth: 2 or more, 2 or more, 1 or more. All three
    /// `SRBF_FIT_AUTOMATIC`, the default, or all three 0 for a material without factors.
    size_t factor_nodes[3];
    /// Most bytes of the material, 200 to 1000000: they are spent on factors where that shows. Default: 8000.
    size_t bytes;
    /// Mean relative L2 error that the fewest lobes are to reach, at most `lobes` of them; 0, the default, for all of them.
    double error;
    /// Weight of the roughness from view to view, 1e-12 to 1000: smaller fits the samples better, larger the directions between
    /// them. Default: 5e-5.
    double smoothness;
    /// Starting points that are tried, 1 to 1000. A fit takes about as long as it has starting points. Default: 12.
    size_t starts;
    /// Most steps of the solver in the refinement, 1 to 100000. Default: 120.
    size_t steps;
    /// Most exchanges of lobes in a stage, 0 to 1000. Default: 15.
    size_t exchanges;
    /// 1 for nodes over the azimuth from -1 to 1, see `srbf_material_info`, where `factor_nodes` are given; else 0, the default.
    uint32_t has_signed_factors;
} srbf_fit_settings;

/// How near a fitted material is to its data: numbers, and the verdict in words. Errors are relative: 0.05 is 5 %.
///
/// They are of views between the fitted ones where the BRDF can be evaluated there, and else of the fitted views. NaN stands for a
/// number that no view has: data that are black everywhere have no relative error.
typedef struct srbf_fit_report {
    /// Relative L2 error of `f cos`, the median of the views.
    double error;
    /// The largest of the views.
    double worst_error;
    /// Outgoing direction of the largest: its angle from the normal, radians.
    double worst_error_theta;
    /// Median relative error of the luminance farther than 15 degrees from the mirror direction, the median of the views.
    double luminance_error;
    /// Largest relative error of an albedo.
    double energy_error;
    /// Largest `f cos / pdf` over its mean: how much brighter than its surroundings a dot of noise may be.
    double largest_weight;
    /// Seconds that the fit took.
    double seconds;
    /// Criteria that are off, each with a line of the verdict that begins with `off`.
    size_t faults;
    /// The verdict, UTF-8 lines with a zero at the end. The first says whether to use the material, if that could be judged. The others
    /// begin with `good`, `fair`, `off`, or `try` for advice.
    char verdict[SRBF_FIT_VERDICT_SIZE];
} srbf_fit_report;

/// A BRDF of the caller: writes f (not times the cosine; linear sRGB, 1/sr) for two unit vectors with z > 0.
///
/// `wi`, `wo` and `f` are [3]; `user` is the pointer of the caller. It is called from threads of the library, several at once. It
/// must return: neither throw nor `longjmp` out. A value that is negative or not finite counts as 0.
typedef void (*srbf_brdf)(void *user, const float *wi, const float *wo, float *f);

/// The call succeeded.
#define SRBF_STATUS_OK 0

/// A pointer that must not be NULL is NULL.
#define SRBF_STATUS_NULL 1

/// A pointer is not aligned for its type.
#define SRBF_STATUS_MISALIGNED 2

/// An output overlaps an input or another output.
#define SRBF_STATUS_OVERLAP 3

/// A buffer is too small, or a count is so large that the address space ends before the buffer.
#define SRBF_STATUS_SIZE 4

/// A stride is not a multiple of the alignment, or smaller than one element: 0 too.
#define SRBF_STATUS_STRIDE 5

/// The memory does not hold the object: it was not made by this library, or its size does not fit.
#define SRBF_STATUS_OBJECT 6

/// An index is past the end.
#define SRBF_STATUS_INDEX 7

/// An argument has none of the values that it may have.
#define SRBF_STATUS_ARGUMENT 8

/// A direction is not a finite vector of length 1 within 1e-3.
#define SRBF_STATUS_DIRECTION 9

/// A uniform number is NaN or outside [0, 1).
#define SRBF_STATUS_UNIFORM 10

/// The axis of a lobe is not a finite vector of length 1 within 1e-3.
#define SRBF_STATUS_AXIS 11

/// A sharpness is NaN or outside [0, 1e8].
#define SRBF_STATUS_SHARPNESS 12

/// An amplitude is NaN or infinite, its luminance negative, or a channel beyond 32 times that; or an integral is infinite.
#define SRBF_STATUS_AMPLITUDE 13

/// A squeeze is NaN or outside [0.01, 2].
#define SRBF_STATUS_SQUEEZE 14

/// The mixture has room for fewer lobes than are needed.
#define SRBF_STATUS_CAPACITY 15

/// A mixture holds squeezed lobes, a diffuse term or factors, which have no product in closed form.
#define SRBF_STATUS_SQUEEZED 16

/// A weight, a tint or a coat of a blend is out of its range, or no weight is above 0.
#define SRBF_STATUS_WEIGHT 17

/// The bytes do not start like a `.srbf` file.
#define SRBF_STATUS_MAGIC 20

/// The `.srbf` version is one that this library does not read.
#define SRBF_STATUS_FORMAT_VERSION 21

/// The `.srbf` bytes end early, or more follow than they announce.
#define SRBF_STATUS_LENGTH 22

/// The checksum does not fit: the `.srbf` bytes are damaged.
#define SRBF_STATUS_CHECKSUM 23

/// A field of the `.srbf` bytes is out of range.
#define SRBF_STATUS_FIELD 24

/// A file could not be read or written.
#define SRBF_STATUS_FILE 30

/// A text is not UTF-8.
#define SRBF_STATUS_TEXT 31

/// A table is one that no material can be fitted to.
#define SRBF_STATUS_TABLE 32

/// This processor, or this build of the library, does not have the SIMD level.
#define SRBF_STATUS_SIMD_LEVEL 40

/// A function of the caller's light gave another status than 0.
#define SRBF_STATUS_LIGHT 41

/// A panic was caught inside the library: a bug in it. Outputs are unspecified.
#define SRBF_STATUS_PANIC 50

/// An error that this version of the C interface has no number for.
#define SRBF_STATUS_OTHER 51

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// Returns the version of the library: `major * 10000 + minor * 100 + patch`.
uint32_t srbf_version(void);

/// Returns a sentence for a status; never NULL, valid for ever.
///
/// Any number may be given; one that is no status has a text that says so.
const char *srbf_status_text(srbf_status status);

#if defined(SRBF_PLANTED_PANIC)
/// Panics inside, and returns `SRBF_STATUS_PANIC`. Only in a build for tests.
srbf_status srbf_status_panic(void);
#endif

#if defined(SRBF_HOSTED)
/// Returns the message of the last call that failed on this thread, "" if none did.
///
/// UTF-8, one line of visible characters (a control character, in the name of a file for example, is spelled out as `\u{1b}`),
/// never NULL. Valid until the next call that fails on this thread, or its end.
const char *srbf_last_message(void);
#endif

/// Returns the level that mixtures prepared from now on use: `SRBF_SIMD_SCALAR` to `SRBF_SIMD_AVX512`.
uint32_t srbf_simd_level(void);

/// Chooses the level of every mixture prepared from now on, in all threads; for tests and comparisons.
///
/// A mixture keeps the level that it was prepared at. `SRBF_SIMD_AUTOMATIC` goes back to the best.
/// Status: `SRBF_STATUS_SIMD_LEVEL` if the processor or the build lacks the level; nothing changes then.
srbf_status srbf_simd_set_level(uint32_t level);

/// Integrates the product of two mixtures of round lobes over the domain that they share.
///
/// For a material's mixture and one of lobes of radiance: the radiance that is reflected towards the viewer.
/// Shapes: `integral` [3], overwritten. Status: `SRBF_STATUS_SQUEEZED`; `SRBF_STATUS_AMPLITUDE` where floats overflow.
srbf_status srbf_mixture_inner_product(const struct srbf_mixture *a,
                                       const struct srbf_mixture *b,
                                       float *integral);

/// Multiplies two mixtures of round lobes, lobe by lobe.
///
/// A folded lobe counts as two, itself and its mirror image. The products are lobes of the caller's shading frame, not
/// folded; they stand for the product on the domain that the mixtures share. Sharpness may reach 2e8,
/// which no call takes, and an amplitude infinity, where two multiply to more than a float holds.
/// Shapes: `lobes` [capacity], of which the first `*count` are overwritten; `lobes` may be NULL with capacity 0, to ask
/// for the count alone. Status: `SRBF_STATUS_SIZE` if the capacity is too small, `*count` gives the capacity needed;
/// `SRBF_STATUS_SQUEEZED`.
srbf_status srbf_mixture_product(const struct srbf_mixture *a,
                                 const struct srbf_mixture *b,
                                 size_t capacity,
                                 struct srbf_lobe *lobes,
                                 size_t *count);

/// Returns the bytes of storage that a mixture of this number of lobes needs; 0 if there is no such mixture (more than 64).
size_t srbf_mixture_size(size_t lobes);

/// Makes an empty mixture in the caller's storage, with room for as many lobes as fit: 16, 32 or 64.
///
/// Shapes: `storage` [storage_size], at least `SRBF_MIXTURE_SIZE_16`, aligned to `SRBF_MIXTURE_ALIGNMENT`; `mixture`
/// one pointer outside the storage, which is set to the same address. It needs no release.
srbf_status srbf_mixture_init(void *storage,
                              size_t storage_size,
                              struct srbf_mixture **mixture);

/// Makes a mixture of the caller's lobes, in a mixture that has been initialised; overwrites it.
///
/// The first `squeezed_lobes` see the direction squeezed along y by c = `squeeze` in [0.01, 2]; give 0 and 1 for round
/// lobes alone.
/// Shapes: `lobes` [lobe_count]; `diffuse` [3], the albedo of a diffuse term on the hemisphere, or NULL.
/// Status: `SRBF_STATUS_CAPACITY`; the status of a lobe that is refused; `SRBF_STATUS_AMPLITUDE` also if integral or value could
/// be infinite, and for a diffuse term on `SRBF_DOMAIN_SPHERE`. On failure the mixture stays as it was.
srbf_status srbf_mixture_from_lobes(uint32_t domain,
                                    float squeeze,
                                    size_t squeezed_lobes,
                                    size_t lobe_count,
                                    const struct srbf_lobe *lobes,
                                    const float *diffuse,
                                    struct srbf_mixture *mixture);

/// Gives the properties of a mixture, its closed-form integral included.
srbf_status srbf_mixture_query(const struct srbf_mixture *mixture, struct srbf_mixture_info *info);

/// Gives lobe `index` of a mixture, in the frame of its view. Status: `SRBF_STATUS_INDEX` past the end.
srbf_status srbf_mixture_lobe(const struct srbf_mixture *mixture, size_t index, struct srbf_lobe *lobe);

/// Makes a material of `.srbf` bytes where they are, of any alignment: nothing is copied, nothing allocated.
///
/// The bytes must stay as they are for as long as the material is used. It needs no release.
/// Shapes: `bytes` [byte_count]; `storage` [storage_size], at least `SRBF_MATERIAL_SIZE`, aligned to
/// `SRBF_MATERIAL_ALIGNMENT`; `material` one pointer, which is set to the storage. None of the three may overlap another.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a material.
srbf_status srbf_material_borrow(const uint8_t *bytes,
                                 size_t byte_count,
                                 void *storage,
                                 size_t storage_size,
                                 struct srbf_material **material);

/// Gives the properties of a material.
srbf_status srbf_material_query(const struct srbf_material *material, struct srbf_material_info *info);

/// Says at which outgoing direction a view is. Status: `SRBF_STATUS_INDEX` past the end, and for every view of an anisotropic
/// material, which these numbers do not describe.
srbf_status srbf_material_view(const struct srbf_material *material,
                               size_t view,
                               struct srbf_view *out);

/// Gives a lobe as a view stores it. Status: `SRBF_STATUS_INDEX` past either end, and for an anisotropic material.
srbf_status srbf_material_view_lobe(const struct srbf_material *material,
                                    size_t view,
                                    size_t index,
                                    struct srbf_plane_lobe *lobe);

/// Integrates `f cos` over all incident directions: how much of the light that goes back along `wo` is reflected.
///
/// Shapes: `wo` [3], unit vector towards the viewer, below the horizon 0; `albedo` [3], linear sRGB, overwritten.
srbf_status srbf_material_albedo(const struct srbf_material *material,
                                 const float *wo,
                                 float *albedo);

/// Makes the mixture of lobes for an outgoing direction, in a mixture that the caller has initialised; overwrites it.
///
/// The mixture takes and gives directions in the shading frame that `wo` is given in. Below the horizon (z < 0) nothing
/// is reflected: the mixture is empty. Of a material with factors the mixture reads them from the material, which must outlive it.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
/// Status: `SRBF_STATUS_CAPACITY` if the mixture has room for fewer lobes than the material has. On failure the mixture stays as
/// it was.
srbf_status srbf_material_prepare(const struct srbf_material *material,
                                  const float *wo,
                                  struct srbf_mixture *mixture);

/// `srbf_material_prepare`, leaving out what matters less than a bound: fewer lobes to evaluate, at an error that is bounded.
///
/// Range: shares within [0, 1]. `lobes`: a lobe is dropped if its share of the luminance of the albedo is below this.
/// `folds`: the part of a lobe below the horizon is not mirrored up if it is at most this share of the lobe.
/// `srbf_material_prepare` takes 0 and 1e-7.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
/// Status: `SRBF_STATUS_ARGUMENT` for a share out of range; otherwise as `srbf_material_prepare`.
srbf_status srbf_material_prepare_leaving_out(const struct srbf_material *material,
                                              const float *wo,
                                              float lobes,
                                              float folds,
                                              struct srbf_mixture *mixture);

/// Makes the mixtures for n outgoing directions, in raw storage; no `srbf_mixture_init` is needed.
///
/// Mixture i is at `(srbf_mixture *)((char *)storage + i * stride)`.
/// Shapes: `wo` n unit vectors; `storage` [n * stride], aligned to `SRBF_MIXTURE_ALIGNMENT`; `stride` a multiple of
/// that, at least `srbf_mixture_size(lobes of the material)`. The storage may overlap neither `wo` nor the material.
/// Status: `SRBF_STATUS_DIRECTION` if some `wo` is not a unit vector: its mixture is empty, the others are made.
srbf_status srbf_material_prepare_into(const struct srbf_material *material,
                                       size_t n,
                                       const struct srbf_vectors *wo,
                                       void *storage,
                                       size_t stride);

/// Gives the factor of a node. Status: `SRBF_STATUS_INDEX` past any end, and without a table.
///
/// Nodes are evenly spaced from 0 to 1 in `(1 - h.z)^(1/4)`, in `(1 - h.wo)^(1/2)`, and in the squared cosine of an azimuth. It is
/// that of `wi` round `h = (wi + wo) / |wi + wo|`, and the squared cosine is 1 in the plane of incidence. Signed factors have it with
/// the sign of the cosine, from -1 on. Shapes: `factor` [3], linear sRGB, overwritten.
srbf_status srbf_material_factor_node(const struct srbf_material *material,
                                      size_t half,
                                      size_t difference,
                                      size_t azimuth,
                                      float *factor);

/// Evaluates the factor on the value of the lobes for a pair of directions above the horizon; 1 without a table.
///
/// `srbf_mixture_evaluate` and all that gives values or weights has multiplied already; densities and draws are the lobes' alone.
/// Shapes: `wo` and `wi` [3], unit vectors, which may be exchanged unless factors are signed; `factor` [3], linear sRGB, overwritten.
srbf_status srbf_material_factor(const struct srbf_material *material,
                                 const float *wo,
                                 const float *wi,
                                 float *factor);

/// Gives the change of the albedo of a view by the factors, relative to the luminance of the lobes' own, as it is stored. Status:
/// `SRBF_STATUS_INDEX` past the end, and without a table.
///
/// `srbf_material_albedo` and the `albedo` of `srbf_mixture_info` have it in them.
/// Shapes: `difference` [3], linear sRGB, overwritten.
srbf_status srbf_material_view_albedo_difference(const struct srbf_material *material,
                                                 size_t view,
                                                 float *difference);

/// Says which spectra the colours of a material have.
srbf_status srbf_material_spectrum(const struct srbf_material *material, struct srbf_spectrum *spectrum);

/// Gives the columns of a material at some wavelengths, once for a path; `srbf_primaries_of` takes a colour to values by them.
///
/// Between the material's wavelengths columns are linear, beyond them constant. A material without a map has the smooth primaries of
/// sRGB, which are 1 together. Densities and draws are those of the colours.
/// Shapes: `wavelengths` [count], nm; `primaries` [count][3], overwritten, not where the wavelengths are.
srbf_status srbf_material_primaries(const struct srbf_material *material,
                                    const float *wavelengths,
                                    size_t count,
                                    float *primaries);

/// Gives the values of a colour at the wavelengths of primaries: of a value, a weight or an albedo. None is below 0.
///
/// Shapes: `primaries` [count][3]; `rgb` [3]; `values` [count], overwritten, not where the primaries are.
srbf_status srbf_primaries_of(const float *primaries,
                              size_t count,
                              const float *rgb,
                              float *values);

#if defined(SRBF_HOSTED)
/// Makes a material of `.srbf` bytes, which are copied. Release it with `srbf_material_free`.
///
/// Shapes: `bytes` [byte_count]; `material` one pointer, overwritten.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a material; `SRBF_STATUS_OTHER` if there is no memory
/// for the copy.
srbf_status srbf_material_from_bytes(const uint8_t *bytes,
                                     size_t byte_count,
                                     struct srbf_material **material);
#endif

#if defined(SRBF_HOSTED)
/// Reads a material from a `.srbf` file. Release it with `srbf_material_free`.
///
/// No more is read than the head of the file announces, and nothing behind a head that is no material's.
/// `path` is UTF-8 with a zero at the end, of a regular file. Status: `SRBF_STATUS_FILE` if it cannot be read, with the reason in
/// `srbf_last_message`; `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if it holds no material. Every message names the file.
srbf_status srbf_material_load(const char *path,
                               struct srbf_material **material);
#endif

#if defined(SRBF_HOSTED)
/// Releases a material; NULL is allowed and does nothing.
///
/// A material that `srbf_material_borrow` made is only marked as none. Nobody may use the material during or after the
/// call, nor, if it has factors, a mixture that it has made.
/// Status: `SRBF_STATUS_OBJECT` if it is not a material.
srbf_status srbf_material_free(struct srbf_material *material);
#endif

/// Evaluates `f cos`, the BRDF times the incident cosine, towards a direction; 1/sr.
///
/// 0 below the horizon of a hemisphere.
/// Shapes: `wi` [3], unit vector; `value` [3], linear sRGB, overwritten.
srbf_status srbf_mixture_evaluate(const struct srbf_mixture *mixture, const float *wi, float *value);

/// Evaluates the density of `srbf_mixture_sample` at a direction; 1/sr, per solid angle.
///
/// Shapes: `wi` [3], unit vector; `pdf` one number, overwritten.
srbf_status srbf_mixture_pdf(const struct srbf_mixture *mixture, const float *wi, float *pdf);

/// Evaluates value and density in one pass, for multiple importance sampling.
///
/// Shapes: `wi` [3], unit vector; `value` [3], `f cos` in linear sRGB; `pdf` one number; both overwritten.
srbf_status srbf_mixture_evaluate_and_pdf(const struct srbf_mixture *mixture,
                                          const float *wi,
                                          float *value,
                                          float *pdf);

/// Draws an incident direction from the density of a mixture; no sample is wasted below the horizon.
///
/// A mixture that reflects nothing gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `u` [3], uniform numbers in [0, 1): the first chooses the lobe, the others the direction in it.
srbf_status srbf_mixture_sample(const struct srbf_mixture *mixture,
                                const float *u,
                                struct srbf_sample *sample);

/// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every hit.
///
/// Shapes: `u` and `sample` as in `srbf_mixture_sample`; `wi`, `value` and `pdf` as in `srbf_mixture_evaluate_and_pdf`.
srbf_status srbf_mixture_sample_and_evaluate(const struct srbf_mixture *mixture,
                                             const float *u,
                                             struct srbf_sample *sample,
                                             const float *wi,
                                             float *value,
                                             float *pdf);

/// Evaluates `f cos` for an outgoing and an incident direction; 1/sr.
///
/// The values of `srbf_material_prepare` and `srbf_mixture_evaluate` but for rounding, without a mixture: for a few incident
/// directions of one `wo` it takes less time. An outgoing direction below the horizon reflects nothing.
/// Shapes: `wo` and `wi` [3], unit vectors in the shading frame; `value` [3], linear sRGB, overwritten.
srbf_status srbf_material_evaluate(const struct srbf_material *material,
                                   const float *wo,
                                   const float *wi,
                                   float *value);

/// Evaluates the density of `srbf_material_sample` at an incident direction; 1/sr.
///
/// Shapes: `wo` and `wi` as in `srbf_material_evaluate`; `pdf` one number, overwritten.
srbf_status srbf_material_pdf(const struct srbf_material *material,
                              const float *wo,
                              const float *wi,
                              float *pdf);

/// Evaluates value and density in one pass, for multiple importance sampling.
///
/// Shapes: `wo` and `wi` as in `srbf_material_evaluate`; `value` [3], linear sRGB, and `pdf`, one number; both overwritten.
srbf_status srbf_material_evaluate_and_pdf(const struct srbf_material *material,
                                           const float *wo,
                                           const float *wi,
                                           float *value,
                                           float *pdf);

/// Draws an incident direction for an outgoing one; no sample is wasted below the horizon.
///
/// Where nothing is reflected it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the lobe, the others the direction in it.
srbf_status srbf_material_sample(const struct srbf_material *material,
                                 const float *wo,
                                 const float *u,
                                 struct srbf_sample *sample);

/// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every hit.
///
/// Shapes: `wo`, `u` and `sample` as in `srbf_material_sample`; `wi`, `value` and `pdf` as in `srbf_material_evaluate_and_pdf`.
srbf_status srbf_material_sample_and_evaluate(const struct srbf_material *material,
                                              const float *wo,
                                              const float *u,
                                              struct srbf_sample *sample,
                                              const float *wi,
                                              float *value,
                                              float *pdf);

/// Draws an incident direction: with probability `share` one of the cosine, else one of the mixture.
///
/// For a renderer that keeps another function as the truth, a measured table for example, and samples it by the mixture: where the
/// mixture misses the table, the weight is at most `pi / share` times the BRDF. A `share` of 0.02 to 0.05 serves well. A mixture on
/// the whole sphere has a uniform direction in place of one of the cosine.
/// To combine techniques A and B, of `n` samples each with density `p`, A's sample weighs `n_a p_a / (n_a p_a + n_b p_b)` (the
/// balance heuristic), or the same of the squares (the power heuristic, for techniques of which one is much the better).
/// Shapes: `u` and `sample` as in `srbf_mixture_sample`; the density is the whole one, the weight the mixture's value over it.
/// Status: `SRBF_STATUS_ARGUMENT` for a share outside [0, 1].
srbf_status srbf_mixture_sample_defensive(const struct srbf_mixture *mixture,
                                          float share,
                                          const float *u,
                                          struct srbf_sample *sample);

/// Evaluates the density of `srbf_mixture_sample_defensive` at a direction; 1/sr.
///
/// Shapes: `wi` [3], unit vector; `pdf` one number, overwritten. Status as there.
srbf_status srbf_mixture_pdf_defensive(const struct srbf_mixture *mixture,
                                       float share,
                                       const float *wi,
                                       float *pdf);

/// Gives the bytes of storage that an expanded material of `rows` rows needs: 448 a row, or 512 if lobes are mirrored, for up to
/// sixteen lobes, and as much for each sixteen lobes more.
///
/// Range: `rows` at least 2, at most 16384; `SRBF_EXPANDED_DEFAULT_ROWS` is a good number.
/// Status: `SRBF_STATUS_SIZE` if the bytes are more than the address space has.
srbf_status srbf_expanded_size(const struct srbf_material *material,
                               size_t rows,
                               size_t *size);

/// Expands a material in the caller's storage: prepares it exactly at `rows` angles of the outgoing direction.
///
/// Its values differ from those of `srbf_material_prepare` by an error that falls with the square of the number of rows.
/// Shapes: `storage` [storage_size], at least what `srbf_expanded_size` says, aligned to `SRBF_EXPANDED_ALIGNMENT`; `expanded` one
/// pointer, which is set to the storage. Neither may overlap the other, nor the material.
/// Status: `SRBF_STATUS_ARGUMENT` for an anisotropic material and for a number of rows out of range.
srbf_status srbf_expanded_make(const struct srbf_material *material,
                               size_t rows,
                               void *storage,
                               size_t storage_size,
                               struct srbf_expanded **expanded);

/// Makes the mixture of lobes for an outgoing direction, in a mixture that the caller has initialised; overwrites it.
///
/// As `srbf_material_prepare`, from the rows of an expanded material. Status as there.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
srbf_status srbf_expanded_prepare(const struct srbf_expanded *expanded,
                                  const float *wo,
                                  struct srbf_mixture *mixture);

/// Draws and evaluates for n hits of mixtures: outputs that are given are wanted.
///
/// Mixture i is at `(const srbf_mixture *)((const char *)mixtures + i * mixture_stride)`; with a stride of 0 all hits are of the
/// one mixture. The answers of `srbf_mixture_sample_and_evaluate` within rounding, in less time.
/// Shapes: `mixtures` [n], `mixture_stride` bytes apart: 0, or a multiple of `SRBF_MIXTURE_ALIGNMENT` and at least
/// `SRBF_MIXTURE_SIZE_16`. Status: `SRBF_STATUS_OBJECT` if one of them is no mixture; outputs are unspecified then.
srbf_status srbf_mixture_ask(const struct srbf_mixture *mixtures,
                             size_t mixture_stride,
                             size_t n,
                             const struct srbf_request *request);

/// Draws and evaluates for n hits of a material, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The answers of `srbf_material_sample_and_evaluate` within rounding, in less time.
/// Shapes: `material` one for all hits; or NULL, and each hit has its own in `materials` of the request. They need not be sorted.
/// An output may lie between their pointers, but not upon one.
srbf_status srbf_material_ask(const struct srbf_material *material,
                              size_t n,
                              const struct srbf_request *request);

/// Draws and evaluates for n hits of an expanded material, each with an outgoing direction of its own: outputs that are given are
/// wanted. The answers of `srbf_material_ask` within the error of the rows.
srbf_status srbf_expanded_ask(const struct srbf_expanded *expanded,
                              size_t n,
                              const struct srbf_request *request);

/// Makes a sheet of `.srbf` bytes where they are, of any alignment: nothing is copied, nothing allocated.
///
/// The bytes must stay as they are for as long as the sheet is used. It needs no release.
/// Shapes: `bytes` [byte_count]; `storage` [storage_size], at least `SRBF_SHEET_SIZE`, aligned to `SRBF_SHEET_ALIGNMENT`; `sheet` one pointer,
/// which is set to the storage. None of the three may overlap another.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a sheet.
srbf_status srbf_sheet_borrow(const uint8_t *bytes,
                              size_t byte_count,
                              void *storage,
                              size_t storage_size,
                              struct srbf_sheet **sheet);

#if defined(SRBF_HOSTED)
/// Reads a sheet from a `.srbf` file. Release it with `srbf_sheet_free`.
///
/// `path` is UTF-8 with a zero at the end, of a regular file. Status: `SRBF_STATUS_FILE` if it cannot be read, with the reason in
/// `srbf_last_message`; `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if it holds no sheet. Every message names the file.
srbf_status srbf_sheet_load(const char *path,
                            struct srbf_sheet **sheet);
#endif

#if defined(SRBF_HOSTED)
/// Releases a sheet; NULL is allowed and does nothing.
///
/// A sheet that `srbf_sheet_borrow` made is only marked as none. Nobody may use the sheet during or after the call.
/// Status: `SRBF_STATUS_OBJECT` if it is not a sheet.
srbf_status srbf_sheet_free(struct srbf_sheet *sheet);
#endif

/// Gives the properties of a sheet.
srbf_status srbf_sheet_query(const struct srbf_sheet *sheet, struct srbf_sheet_info *info);

/// Integrates `f |cos|` over all incident directions: how much of the light that goes back along `wo` is reflected, and how much is
/// transmitted.
///
/// Shapes: `wo` [3], unit vector towards the viewer; `reflected` and `transmitted` [3], linear sRGB, overwritten.
srbf_status srbf_sheet_albedos(const struct srbf_sheet *sheet,
                               const float *wo,
                               float *reflected,
                               float *transmitted);

/// Evaluates `f |cos|` and the density of `srbf_sheet_sample` in one pass; 1/sr.
///
/// Shapes: `wo` and `wi` [3], unit vectors in the frame of the sheet; `value` [3], linear sRGB, and `pdf`, one number; both overwritten.
srbf_status srbf_sheet_evaluate_and_pdf(const struct srbf_sheet *sheet,
                                        const float *wo,
                                        const float *wi,
                                        float *value,
                                        float *pdf);

/// Draws an incident direction, on either side of the sheet.
///
/// Where nothing is reflected or transmitted it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the side and the lobe, the others the direction in it.
srbf_status srbf_sheet_sample(const struct srbf_sheet *sheet,
                              const float *wo,
                              const float *u,
                              struct srbf_sample *sample);

/// Draws and evaluates for n hits of a sheet, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The answers of `srbf_sheet_sample` and `srbf_sheet_evaluate_and_pdf` within rounding, in less time.
srbf_status srbf_sheet_ask(const struct srbf_sheet *sheet,
                           size_t n,
                           const struct srbf_request *request);

/// Share of the light that the smooth face of a dielectric reflects, of unpolarised light from outside, by Fresnel's equations.
///
/// `index`: its refractive index, from 1; `cosine`: of the direction from the normal. Any other numbers give an unspecified one.
float srbf_fresnel(float index,
                   float cosine);

/// Integrates `f cos` of a blend over all incident directions, in closed form; below a coat it is a bound from above.
///
/// Shapes: `parts` [part_count]; `wo` [3], unit vector in the shading frame; `albedo` [3], linear sRGB, overwritten.
srbf_status srbf_blend_albedo(const struct srbf_blend_part *parts,
                              size_t part_count,
                              const float *wo,
                              float *albedo);

/// Evaluates `f cos` of a blend and the density of `srbf_blend_sample` in one pass; 1/sr.
///
/// Shapes: `parts` [part_count]; `wo` and `wi` [3], unit vectors in the shading frame; `value` [3], linear sRGB, and `pdf`, one number; both
/// overwritten.
srbf_status srbf_blend_evaluate_and_pdf(const struct srbf_blend_part *parts,
                                        size_t part_count,
                                        const float *wo,
                                        const float *wi,
                                        float *value,
                                        float *pdf);

/// Draws an incident direction of a blend: a part by weight, tint and power, then of that part.
///
/// Where nothing is reflected it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `parts` [part_count]; `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the part and the lobe, the others the
/// direction in it.
srbf_status srbf_blend_sample(const struct srbf_blend_part *parts,
                              size_t part_count,
                              const float *wo,
                              const float *u,
                              struct srbf_sample *sample);

/// Draws an incident direction of a blend, and evaluates value and density towards another one: what next-event estimation needs at every
/// hit.
///
/// Shapes: `parts`, `wo`, `u` and `sample` as in `srbf_blend_sample`; `wi`, `value` and `pdf` as in `srbf_blend_evaluate_and_pdf`.
srbf_status srbf_blend_sample_and_evaluate(const struct srbf_blend_part *parts,
                                           size_t part_count,
                                           const float *wo,
                                           const float *u,
                                           struct srbf_sample *sample,
                                           const float *wi,
                                           float *value,
                                           float *pdf);

/// Chooses one part of a blend at random, and tells the number that is left of `u` for its draw.
///
/// A blend of that part alone has the values of the whole in the mean, at the cost of one hit. Its densities are its own.
/// All that is asked at a hit has to be asked of the one part that was chosen for it.
/// Shapes: `parts` [part_count]; `u` one uniform number in [0, 1); `part` one part and `left` one number in [0, 1), both overwritten.
srbf_status srbf_blend_choose(const struct srbf_blend_part *parts,
                              size_t part_count,
                              float u,
                              struct srbf_blend_part *part,
                              float *left);

/// Draws and evaluates for n hits of blends, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The parts of hit i begin at `(const char *)parts + i * stride`; with a stride of 0 all hits have the same. The answers of
/// `srbf_blend_sample_and_evaluate` within rounding, in less time.
/// Shapes: `parts` [n][part_count], `stride` bytes from one hit to the next: 0, or a multiple of their alignment and at least their size.
srbf_status srbf_blend_ask(const struct srbf_blend_part *parts,
                           size_t part_count,
                           size_t stride,
                           size_t n,
                           const struct srbf_request *request);

/// Says how many bytes of storage the environment of a map needs: 64 a pixel, those of one row more, and a little.
///
/// Status: `SRBF_STATUS_ARGUMENT` for a size that no map may have: width or height 0 or above 65535, or more than 2^25 pixels;
/// `SRBF_STATUS_SIZE` if the bytes are more than the address space has.
srbf_status srbf_environment_size(size_t width,
                                  size_t height,
                                  size_t *size);

/// Makes an environment of a map of radiance in the caller's storage; takes about 0.1 us a pixel.
///
/// Shapes: `radiance` [height][width][3], linear sRGB, the top row first, each number in [0, 1e30]; `turn` the angle that the map
/// is turned by round +z, anticlockwise seen from above, radians; `storage` [storage_size], at least what `srbf_environment_size`
/// says, aligned to `SRBF_ENVIRONMENT_ALIGNMENT`; `environment` one pointer, which is set to the storage. None may overlap another.
/// Status: `SRBF_STATUS_ARGUMENT` for a size that no map may have, a number out of range, NaN too, or a map that is black all over.
srbf_status srbf_environment_make(size_t width,
                                  size_t height,
                                  const float *radiance,
                                  float turn,
                                  void *storage,
                                  size_t storage_size,
                                  struct srbf_environment **environment);

/// Says what an environment holds.
srbf_status srbf_environment_query(const struct srbf_environment *environment,
                                   struct srbf_environment_info *info);

/// Takes a table that `srbf_environment_query` gave, on a processor of the same byte order, after checking it once. Nothing is
/// copied: the table must live, and stay as it is, for as long as the environment is used.
///
/// Shapes: `table` [table_size] bytes, aligned to 4; 64 is the fastest; `turn` as in `srbf_environment_make`; `storage`
/// [storage_size], at least `SRBF_ENVIRONMENT_HEAD_SIZE`, aligned to `SRBF_ENVIRONMENT_ALIGNMENT`; `environment` one pointer,
/// which is set to the storage. Status: `SRBF_STATUS_OBJECT` for a table that is none, or damaged.
srbf_status srbf_environment_read(const void *table,
                                  size_t table_size,
                                  float turn,
                                  void *storage,
                                  size_t storage_size,
                                  struct srbf_environment **environment);

/// Looks up the radiance from a direction, and the density of `srbf_environment_sample` towards it; 1/sr.
///
/// Shapes: `direction` [3], unit vector in the world; `radiance` [3], linear sRGB, and `pdf`, one number, overwritten; NULL for
/// one that is not wanted.
srbf_status srbf_environment_evaluate(const struct srbf_environment *environment,
                                      const float *direction,
                                      float *radiance,
                                      float *pdf);

/// Draws a direction by the luminance of its radiance.
///
/// Shapes: `u` [3], uniform numbers in [0, 1), of which all digits count; `sample` one, overwritten.
srbf_status srbf_environment_sample(const struct srbf_environment *environment,
                                    const float *u,
                                    struct srbf_light_sample *sample);

/// Draws a direction for the light of an environment and a mixture together: direct light by one shadow ray.
///
/// The mean of `weight` over all draws is the integral of radiance times `f cos`, times one minus `srbf_product_ray_weight`.
/// Without occlusion its variance is that of multiple importance sampling with as many directions as there are candidates.
/// Shapes: `frame` [9], tangent, bitangent and normal of the shading frame in the world, unit vectors at right angles; `u`
/// [3][candidates], uniform numbers in [0, 1): the first of all candidates, then the second, then the third; `choice` one more;
/// `sample` one, overwritten, with the normal, weight and factor 0 where no candidate brings light.
/// Status: `SRBF_STATUS_ARGUMENT` for a `sampling` out of range.
srbf_status srbf_mixture_sample_product(const struct srbf_mixture *mixture,
                                        const struct srbf_environment *environment,
                                        const float *frame,
                                        const struct srbf_product_sampling *sampling,
                                        const float *u,
                                        float choice,
                                        struct srbf_product_sample *sample);

/// Gives the factor on the light that a path meets along its own ray. The path drew the ray from its mixture with density `pdf`;
/// the environment has the density `environment_pdf` there.
///
/// Shapes: `weight` one number in [0, 1], overwritten, whatever the densities are: 0 for an infinite kappa; a density that is
/// negative or NaN counts as 0, an infinite one as the largest number. Status: `SRBF_STATUS_ARGUMENT` for a `sampling` out of
/// range.
srbf_status srbf_product_ray_weight(const struct srbf_product_sampling *sampling,
                                    float pdf,
                                    float environment_pdf,
                                    float *weight);

/// Draws a block of samples of the light.
///
/// Shapes: `u` [3][16], uniform numbers in [0, 1): the first of all samples, then the second, then the third; `block` one,
/// overwritten.
srbf_status srbf_light_block_draw(const struct srbf_environment *environment,
                                  const float *u,
                                  struct srbf_light_block *block);

/// Draws the ray that a path goes on along, and a shadow ray, for the light of an environment: where nothing is in the way the
/// reflected light is a sum over all directions of the block and all of `u`; with evenly spread numbers it is nearly exact.
///
/// `srbf_reflection_light` gives the light when both rays have been followed. Its mean is the integral of radiance times `f cos`
/// over directions that are not hidden; block, `u` and `choice` have to be independent of each other. Most of the light has to be
/// in sight for it to be faster than one sample of lobes and light each. Shapes: `block` from `srbf_light_block_draw`; `frame`
/// [9], tangent, bitangent and normal of the shading frame in the world, unit vectors at right angles; `flat` [3], the unit normal
/// of the surface itself, below which light counts nothing; `u` [3][count], `count` from 1 to 16, 8 serve well, uniform numbers in
/// [0, 1): the first of all directions of the lobes, then the second, then the third; the first direction is the path's own ray,
/// the others may be its shifts along a lattice; `choice` one more; `reflection` one, overwritten. Status: `SRBF_STATUS_ARGUMENT`
/// for a count out of range; `SRBF_STATUS_AMPLITUDE` where floats overflow.
srbf_status srbf_mixture_reflect(const struct srbf_mixture *mixture,
                                 const struct srbf_environment *environment,
                                 const struct srbf_light_block *block,
                                 const float *frame,
                                 const float *flat,
                                 size_t count,
                                 const float *u,
                                 float choice,
                                 struct srbf_reflection *reflection);

/// The light that is reflected to the viewer, direct light by both rays: whether the path's own ray escapes to the environment, and
/// whether the shadow ray does, 0 or 1. The light that the path meets further on is added to it; of the environment, nothing is.
///
/// Shapes: `reflection` from `srbf_mixture_reflect`; `values` [2][3], for a caller who renders another function than the mixture:
/// its `f cos` towards the ray and towards the shadow ray, or NULL; `light` [3], linear sRGB, overwritten. Single estimates may be
/// below 0.
srbf_status srbf_reflection_light(const struct srbf_reflection *reflection,
                                  int32_t ray_escapes,
                                  int32_t shadow_is_clear,
                                  const float *values,
                                  float *light);

/// Draws a direction for any light and a mixture together, as `srbf_mixture_sample_product` does for an environment.
///
/// The light that reaches the viewer is the sample's `factor` times the radiance that the caller finds along its direction. Its mean is
/// the integral of that radiance times `f cos`, times one minus `srbf_product_ray_weight`, whatever the light's estimates are. `weight` is
/// of the estimate. The light is asked to evaluate the candidates of the mixture, and to draw the others.
/// Shapes: as there. Status: `SRBF_STATUS_NULL` for a function that is NULL too; `SRBF_STATUS_LIGHT`.
srbf_status srbf_mixture_sample_product_from(const struct srbf_mixture *mixture,
                                             const struct srbf_light_source *light,
                                             const float *frame,
                                             const struct srbf_product_sampling *sampling,
                                             const float *u,
                                             float choice,
                                             struct srbf_product_sample *sample);

/// Draws a block of samples of any light, as `srbf_light_block_draw` does of an environment; their light is the estimate.
///
/// Shapes: as there. Status: `SRBF_STATUS_NULL` for a function that is NULL too; `SRBF_STATUS_LIGHT`.
srbf_status srbf_light_block_draw_from(const struct srbf_light_source *light,
                                       const float *u,
                                       struct srbf_light_block *block);

/// Draws the ray that a path goes on along, and a shadow ray, for any light, as `srbf_mixture_reflect` does for an environment. The
/// sums are of the light's estimates; `srbf_reflection_light_from` corrects them by the radiance that the caller finds.
///
/// Shapes: as there; `block` from `srbf_light_block_draw_from`. Status: `SRBF_STATUS_NULL` for a function that is NULL too;
/// `SRBF_STATUS_LIGHT`.
srbf_status srbf_mixture_reflect_from(const struct srbf_mixture *mixture,
                                      const struct srbf_light_source *light,
                                      const struct srbf_light_block *block,
                                      const float *frame,
                                      const float *flat,
                                      size_t count,
                                      const float *u,
                                      float choice,
                                      struct srbf_reflection *reflection);

/// The light that is reflected to the viewer, of any light: of the radiance that the caller finds along the path's ray and along the
/// shadow ray, 0 where nothing comes from there.
///
/// Shapes: `reflection` from `srbf_mixture_reflect_from`; `radiance` [2][3], linear sRGB, that along the ray first; that of a ray which does
/// not exist may be anything; `light` [3], linear sRGB, overwritten. Single estimates may be below 0.
srbf_status srbf_reflection_light_from(const struct srbf_reflection *reflection,
                                       const float *radiance,
                                       float *light);

#if defined(SRBF_HOSTED)
/// Gives the settings that NULL stands for.
srbf_status srbf_fit_settings_default(struct srbf_fit_settings *settings);
#endif

#if defined(SRBF_HOSTED)
/// Fits a material to n samples of an isotropic BRDF. Release it with `srbf_material_free`. Takes seconds, on all processors.
///
/// Outgoing directions whose angles from the normal agree within 1e-3 are one view. Any number of samples is taken; with fewer
/// than a few hundred a view, values between them are badly known. No surface reflects more than it receives: where the albedo of
/// the samples of a view is above 0.95, the fit is held to 0.95, and is darker than the samples. Shapes: `wo` and `wi` n unit
/// vectors, `wo` above the horizon; samples whose `wi` is not are left out; `f` n colours, linear sRGB, of which negative channels
/// count as 0; `settings` one, or NULL; `material` one pointer, overwritten; `report` one, overwritten, or NULL.
/// Status, with the reason in `srbf_last_message`:
/// `SRBF_STATUS_DIRECTION` for a vector that is no unit vector; `SRBF_STATUS_TABLE`; `SRBF_STATUS_ARGUMENT` for a setting;
/// `SRBF_STATUS_OTHER` if the system gives no threads to fit on, or there is no memory for the samples.
///
/// A child that was forked may fit, whether or not its parent has fitted or is fitting: it starts threads of its own. But a child
/// that was forked within a `srbf_brdf` gets `SRBF_STATUS_OTHER`.
srbf_status srbf_fit_table(const struct srbf_fit_settings *settings,
                           size_t n,
                           const struct srbf_vectors *wo,
                           const struct srbf_vectors *wi,
                           const struct srbf_vectors *f,
                           struct srbf_material **material,
                           struct srbf_fit_report *report);
#endif

#if defined(SRBF_HOSTED)
/// Fits a material to an isotropic BRDF that can be evaluated. Release it with `srbf_material_free`.
///
/// Shapes, status and time as in `srbf_fit_table`.
srbf_status srbf_fit_brdf(const struct srbf_fit_settings *settings,
                          srbf_brdf brdf,
                          void *user,
                          struct srbf_material **material,
                          struct srbf_fit_report *report);
#endif

#if defined(SRBF_HOSTED)
/// Writes a material to a `.srbf` file, whole or not at all; folders that are missing are made.
///
/// The bytes are written under another name in the same folder, which is then renamed. A symbolic link stays, and its target is
/// replaced; a file that is there gives its mode to the new one. Where a folder, a device, a pipe or a socket is there, nothing is
/// written. `path` is UTF-8 with a zero at the end. Status: `SRBF_STATUS_FILE`, with the reason in `srbf_last_message`.
srbf_status srbf_material_save(const struct srbf_material *material,
                               const char *path);
#endif

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SRBF_H */
