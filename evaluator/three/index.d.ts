import type { Camera, Color, ColorRepresentation, DataTexture, Scene, ShaderMaterial, ShaderMaterialParameters, Texture, Vector2, WebGLRenderer, WebGLRenderTarget } from "three";

/** The words of a .srbf file, a material's or a sheet's, as a texture; throws an error that names what is wrong with them. `name` is how errors call the file. */
export function parseSrbf(data: ArrayBuffer | Uint8Array, name?: string): DataTexture;

/** Fetches a .srbf file; a texture, as parseSrbf gives it. */
export function loadSrbf(url: string): Promise<DataTexture>;

export interface SrbfMaterialParameters extends ShaderMaterialParameters {
    /** A texture of loadSrbf or parseSrbf. */
    srbf: DataTexture;
    /** An equirectangular map of light, linear, such as HDRLoader gives, or a cube; null for that of the scene. */
    environment?: Texture | null;
    environmentIntensity?: number;
    /** Random directions of the lobes, a picture of Mean and pixel, that look into the map. */
    draws?: number;
    /** Directions that are the same at every pixel, in a picture of the renderer. */
    even?: number;
    /** Slopes of the surface, as in MeshStandardMaterial. */
    normalMap?: Texture | null;
    normalScale?: Vector2;
    /** A colour that multiplies the value. */
    tint?: ColorRepresentation;
    /** Whether the geometry has an attribute `tangent`: the x axis of an anisotropic material. */
    tangents?: boolean;
}

/**
 * A measured surface, or a sheet with both its sides, under lights of three.js but area lights, with shadows, and a map of light.
 */
export class SrbfMaterial extends ShaderMaterial {
    constructor(parameters: SrbfMaterialParameters);
    readonly isSrbfMaterial: true;
    /** The number of the picture: its draws are its own. 0 is the one without noise. */
    frame: number;
    environment: Texture | null;
    environmentIntensity: number;
    draws: number;
    even: number;
    normalMap: Texture | null;
    readonly normalScale: Vector2;
    readonly tint: Color;
}

/** The mean of pictures of a scene, linear: the noise of draws falls with the root of their number. */
export class Mean {
    constructor(width: number, height: number);
    readonly count: number;
    readonly target: WebGLRenderTarget;
    /** Begins again, as when the camera has moved. */
    reset(): void;
    /** Adds a picture; materials draw anew. */
    add(renderer: WebGLRenderer, scene: Scene, camera: Camera): void;
    /** Draws the mean to the canvas, by the renderer's tone mapping and colour space. */
    draw(renderer: WebGLRenderer): void;
}
