/** Three numbers: a unit vector in the shading frame, +z the normal, or a colour in linear sRGB. */
export type Vector = [number, number, number];

export interface Value {
    /** `f cos`, 1/sr. */
    value: Vector;
    /** Density of `sample` there, 1/sr. */
    pdf: number;
}

export interface Sample {
    direction: Vector;
    /** 0 where nothing is reflected. */
    pdf: number;
    /** `f cos / pdf`. */
    weight: Vector;
}

export interface Samples {
    /** x, y, z of each. */
    directions: Float32Array;
    pdfs: Float32Array;
    /** Red, green, blue of each. */
    weights: Float32Array;
}

/** The lobes of one outgoing direction. It lives until it or its material is freed. */
export class Mixture {
    readonly albedo: Vector;
    readonly lobes: number;
    evaluate(wi: ArrayLike<number>): Value;
    sample(u: ArrayLike<number>): Sample;
    /** Of n directions, x, y, z of each. */
    evaluateMany(directions: Float32Array): { values: Float32Array; pdfs: Float32Array };
    /** Of n times three uniform numbers in [0, 1). */
    sampleMany(numbers: Float32Array): Samples;
    free(): void;
}

/** A material. Its memory is WebAssembly's, which is not collected: `free` gives it back, with its mixtures. */
export class Material {
    readonly views: number;
    readonly lobes: number;
    readonly size: number;
    readonly provenance: string;
    /** The mixture of an outgoing direction, towards the viewer; `into` is overwritten, if it is given. */
    prepare(wo: ArrayLike<number>, into?: Mixture): Mixture;
    /** One pair of directions: the mixture is made for it. */
    evaluate(wo: ArrayLike<number>, wi: ArrayLike<number>): Value;
    sample(wo: ArrayLike<number>, u: ArrayLike<number>): Sample;
    free(): void;
}

/**
 * A thin surface that reflects light and lets some through. Directions are in the frame of the sheet, whose front is +z, and may lie in front
 * or behind.
 */
export class Sheet {
    /** Whether the back is like the front. */
    readonly isSymmetric: boolean;
    /** The materials, null for one that is black; their directions lie above the horizon. */
    readonly quarters: Record<"front-reflection" | "front-transmission" | "back-reflection" | "back-transmission", Material | null>;
    evaluate(wo: ArrayLike<number>, wi: ArrayLike<number>): Value;
    /** The first number chooses between reflection and transmission. */
    sample(wo: ArrayLike<number>, u: ArrayLike<number>): Sample;
    /** Shares of the light that are reflected and transmitted, linear sRGB. */
    albedos(wo: ArrayLike<number>): { reflected: Vector; transmitted: Vector };
    /** Share of the draws that are reflected. */
    reflectedShare(wo: ArrayLike<number>): number;
    free(): void;
}

/** An error of the library, by its status in `srbf.h`. */
export class SrbfError extends Error {
    readonly status: number;
}

export interface Srbf {
    /** Checks the bytes of a .srbf file; throws an `SrbfError` for others. */
    material(bytes: ArrayBuffer | Uint8Array): Material;
    /** The same of a sheet, whose head is checked here. */
    sheet(bytes: ArrayBuffer | Uint8Array): Sheet;
    /** The functions of `srbf.h`, `srbf_allocate`, `srbf_free` and `memory`. */
    readonly exports: WebAssembly.Exports;
    readonly isSimd: boolean;
}

export interface LoadOptions {
    /** The module, if it is not beside this file. */
    url?: string | URL;
    bytes?: BufferSource;
    /** Whether to take the module of simd128; what the engine has, if it is not said. */
    isSimd?: boolean;
}

export function load(options?: LoadOptions): Promise<Srbf>;
