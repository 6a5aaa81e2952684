/*
 * srbf: measured BRDFs as small mixtures of spherical Gaussian lobes. Generated from capi/src; do not edit.
 */

#ifndef SRBF_H
#define SRBF_H

#include <stddef.h>
#include <stdint.h>

#if !defined(SRBF_FREESTANDING)
#define SRBF_HOSTED 1
#endif

/**
 * Version of this header: `major * 10000 + minor * 100 + patch`.
 *
 * Compare with `srbf_version()` to see whether header and library belong together.
 */
#define SRBF_VERSION 100

/**
 * Version of the `.srbf` bytes that are read and written.
 */
#define SRBF_FORMAT_VERSION 1

/**
 * What a call returns: 0 if it succeeded, otherwise why not. The numbers never change their meaning.
 */
typedef int32_t srbf_status;

/**
 * The call succeeded.
 */
#define SRBF_STATUS_OK 0

/**
 * A pointer that must not be NULL is NULL.
 */
#define SRBF_STATUS_NULL 1

/**
 * A pointer is not aligned for what it points to.
 */
#define SRBF_STATUS_MISALIGNED 2

/**
 * An output overlaps an input or another output.
 */
#define SRBF_STATUS_OVERLAP 3

/**
 * A buffer is too small, or a count is so large that the address space ends before the buffer.
 */
#define SRBF_STATUS_SIZE 4

/**
 * A stride is not a multiple of the alignment, or smaller than one element.
 */
#define SRBF_STATUS_STRIDE 5

/**
 * The memory does not hold the object: it was not made by this library, or its size does not fit.
 */
#define SRBF_STATUS_OBJECT 6

/**
 * An index is past the end.
 */
#define SRBF_STATUS_INDEX 7

/**
 * An argument has none of the values that it may have.
 */
#define SRBF_STATUS_ARGUMENT 8

/**
 * A direction is not a finite vector of length 1 within 1e-3.
 */
#define SRBF_STATUS_DIRECTION 9

/**
 * A uniform number is NaN or outside [0, 1).
 */
#define SRBF_STATUS_UNIFORM 10

/**
 * The axis of a lobe is not a finite vector of length 1 within 1e-3.
 */
#define SRBF_STATUS_AXIS 11

/**
 * A sharpness is NaN or outside [0, 1e8].
 */
#define SRBF_STATUS_SHARPNESS 12

/**
 * An amplitude is NaN, negative or infinite.
 */
#define SRBF_STATUS_AMPLITUDE 13

/**
 * A squeeze is NaN or outside [0.01, 2].
 */
#define SRBF_STATUS_SQUEEZE 14

/**
 * The mixture has room for fewer lobes than are needed.
 */
#define SRBF_STATUS_CAPACITY 15

/**
 * The bytes do not start like a `.srbf` file.
 */
#define SRBF_STATUS_MAGIC 20

/**
 * The `.srbf` version is one that this library does not read.
 */
#define SRBF_STATUS_FORMAT_VERSION 21

/**
 * The `.srbf` bytes end early, or more follow than they announce.
 */
#define SRBF_STATUS_LENGTH 22

/**
 * The checksum does not fit: the `.srbf` bytes are damaged.
 */
#define SRBF_STATUS_CHECKSUM 23

/**
 * A field of the `.srbf` bytes is out of range.
 */
#define SRBF_STATUS_FIELD 24

/**
 * A file could not be read or written.
 */
#define SRBF_STATUS_FILE 30

/**
 * A text is not UTF-8.
 */
#define SRBF_STATUS_TEXT 31

/**
 * A table is one that no material can be fitted to.
 */
#define SRBF_STATUS_TABLE 32

/**
 * This processor, or this build of the library, does not have the SIMD level.
 */
#define SRBF_STATUS_SIMD_LEVEL 40

/**
 * A panic was caught inside the library: a bug in it. Outputs are unspecified.
 */
#define SRBF_STATUS_PANIC 50

/**
 * An error that this version of the C interface has no number for.
 */
#define SRBF_STATUS_OTHER 51

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the version of the library: `major * 10000 + minor * 100 + patch`.
 */
uint32_t srbf_version(void);

/**
 * Returns the version of the library as text, such as "0.1.0"; never NULL, valid for ever.
 */
const char *srbf_version_text(void);

/**
 * Returns a sentence for a status; never NULL, valid for ever.
 *
 * Any number may be given; one that is no status has a text that says so.
 */
const char *srbf_status_text(srbf_status status);

#if defined(SRBF_PLANTED_PANIC)
/**
 * Panics inside, and returns `SRBF_STATUS_PANIC`. Only in a build for tests.
 */
srbf_status srbf_status_panic(void);
#endif

/**
 * Returns the message of the last call that failed on this thread, "" if none did.
 *
 * UTF-8, one line, never NULL. Valid until the next call that fails on this thread, or its end.
 */
const char *srbf_last_message(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SRBF_H */
