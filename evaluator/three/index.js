// A .srbf file, a material's or a sheet's, as a material of three.js. README.md has an example.

import * as THREE from "three";
import text, { sheet } from "./text.js";
import { quartersOf, received, wordsOf } from "./words.js";

const WIDTH = 1024; // words in a row of the texture

/**
 * The words of a .srbf file as a texture; `userData.isSheet` says whether they are a sheet's.
 * @param {ArrayBuffer | Uint8Array} data the file
 * @param {string} name how errors call it
 */
export function parseSrbf(data, name = "the material") {
    const words = wordsOf(data, name, WIDTH);
    const texture = new THREE.DataTexture(words, WIDTH, words.length / WIDTH, THREE.RedIntegerFormat, THREE.UnsignedIntType);
    texture.internalFormat = "R32UI";
    texture.userData.isSheet = quartersOf(words) !== null;
    texture.needsUpdate = true;
    return texture;
}

/** Fetches a .srbf file; a texture, as parseSrbf gives it. */
export async function loadSrbf(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return parseSrbf(await received(answer, url), url);
}

const vertexShader = /* glsl */ `
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
out vec3 vViewPosition;
out vec3 srbfNormal;
#ifdef SRBF_TANGENTS
#ifndef USE_TANGENT
in vec4 tangent;
#endif
out vec4 srbfTangent;
#endif
void main() {
    #include <uv_vertex>
    #include <batching_vertex>
    #include <beginnormal_vertex>
    #include <morphnormal_vertex>
    #include <skinbase_vertex>
    #include <skinnormal_vertex>
    #include <defaultnormal_vertex>
    #include <begin_vertex>
    #include <morphtarget_vertex>
    #include <skinning_vertex>
    #include <project_vertex>
    #include <worldpos_vertex>
    #include <shadowmap_vertex>
    vViewPosition = -mvPosition.xyz;
    srbfNormal = transformedNormal;
#ifdef SRBF_TANGENTS
    srbfTangent = vec4((modelViewMatrix * vec4(tangent.xyz, 0.0)).xyz, tangent.w);
#endif
}
`;

/** What a hit of a material asks, and what one of a sheet does: it is seen from both sides, and has light on both. */
const MATERIAL = `
#define VIEW SrbfView
#define PREPARE(wo) srbf_prepare(srbf_material(0), wo)
#define TOWARDS(view, wi) srbf_evaluate(srbf_material(0), view, wi).value
#define DRAW(view, u) srbf_sample(srbf_material(0), view, u)
#define ALBEDO(view) srbf_albedo(srbf_material(0), view)
`;
const SHEET = `
${sheet}
#define VIEW SrbfSheetView
#define PREPARE(wo) srbf_sheet_prepare(srbf_sheet(0), wo)
#define TOWARDS(view, wi) srbf_sheet_evaluate(view, wi).value
#define DRAW(view, u) srbf_sheet_sample(view, u)
#define ALBEDO(view) (srbf_half_albedo(view.reflected) + srbf_half_albedo(view.transmitted))
`;

const fragmentShader = (isSheet) => /* glsl */ `
precision highp usampler2D;
#include <common>
#include <uv_pars_fragment>
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
#include <normalmap_pars_fragment>
uniform usampler2D srbfWords;
#ifdef SRBF_CUBE
uniform samplerCube environment;
#else
uniform sampler2D environment;
#endif
uniform mat3 environmentTurn;
uniform float environmentIntensity;
uniform int draws;
uniform uint frame;
uniform vec3 tint;
in vec3 vViewPosition;
in vec3 srbfNormal;
#ifdef SRBF_TANGENTS
in vec4 srbfTangent;
#endif

uint srbf_word(int data, int i) { return texelFetch(srbfWords, ivec2((data + i) & ${WIDTH - 1}, (data + i) / ${WIDTH}), 0).r; }
${text}${isSheet ? SHEET : MATERIAL}
// Numbers of a pixel, a frame and a draw (Jarzynski and Olano 2020).
uvec3 srbfRandom(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return v;
}

// The mean of the map over a solid angle round a direction, by the level whose pixels are as large.
vec3 srbfSurroundings(vec3 towards, float solidAngle) {
#ifdef SRBF_CUBE
    float side = float(textureSize(environment, 0).x);
#ifdef SRBF_PREFILTERED
    // Levels of PMREMGenerator are means over lobes of GGX; those of a roughness spread over 4 pi roughness^4.
    float roughness = min(sqrt(sqrt(solidAngle * 0.07957747)), 1.0);
    return textureLod(environment, towards, max(log2(side) - 3.0, 0.0) * roughness * (2.0 - roughness)).rgb;
#endif
    return textureLod(environment, towards, 0.5 * log2(max(solidAngle * side * side * 0.47746483, 1.0))).rgb;
#else
    vec2 size = vec2(textureSize(environment, 0));
    vec2 place = vec2(atan(towards.z, towards.x) * RECIPROCAL_PI2 + 0.5, asin(clamp(towards.y, -1.0, 1.0)) * RECIPROCAL_PI + 0.5);
    return textureLod(environment, place, 0.5 * log2(max(solidAngle * size.x * size.y * 0.05066059, 1.0))).rgb;
#endif
}

void main() {
    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 normal = normalize(srbfNormal)${isSheet ? "" : " * side"};
    vec3 view = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(vViewPosition);
#ifdef USE_NORMALMAP_TANGENTSPACE
#ifdef SRBF_TANGENTS
    vec3 along = normalize(srbfTangent.xyz);
    mat3 frameOfMap = mat3(along, cross(normal, along) * srbfTangent.w, normal);
#else
    mat3 frameOfMap = getTangentFrame(-vViewPosition, normal, vNormalMapUv);
#endif
    vec3 slope = texture2D(normalMap, vNormalMapUv).xyz * 2.0 - 1.0;
    normal = normalize(frameOfMap * vec3(slope.xy * normalScale, slope.z));
#endif
#ifdef SRBF_TANGENTS
    vec3 tangent = normalize(srbfTangent.xyz - normal * dot(normal, srbfTangent.xyz));
    vec3 bitangent = cross(normal, tangent) * srbfTangent.w;
#else
    vec3 tangent = normalize(abs(normal.x) < 0.8 ? cross(vec3(1.0, 0.0, 0.0), normal) : cross(vec3(0.0, 1.0, 0.0), normal));
    vec3 bitangent = cross(normal, tangent);
#endif
    mat3 frameOfSurface = mat3(tangent, bitangent, normal);
    vec3 wo = view * frameOfSurface;
    wo = normalize(vec3(wo.xy, ${isSheet ? "side * max(side * wo.z, 1e-3)" : "max(wo.z, 1e-3)"}));
    VIEW mixture = PREPARE(wo);
    vec3 light = vec3(0.0);
    // The lights and shadows of three.js, in its own loops.
    #define RE_Direct(lamp, a, b, c, d, e, f) light += lamp.color * TOWARDS(mixture, lamp.direction * frameOfSurface)
    #define RE_IndirectDiffuse
    #include <lights_fragment_begin>
    light += irradiance * ALBEDO(mixture) * RECIPROCAL_PI;
    vec3 reflected = vec3(0.0);
    for (int i = 0; i < draws; i++) {
        // In frame 0 the same even numbers at every pixel, and means of the map over the share of each; else random ones, and the map itself.
        vec3 u = vec3((float(i) + 0.5) / float(draws), fract(0.5 + float(i + 1) * vec2(0.75487767, 0.56984029)));
        if (frame > 0u) { u = vec3(srbfRandom(uvec3(gl_FragCoord.xy, frame * uint(draws) + uint(i))) >> 8u) * (1.0 / 16777216.0); }
        SrbfSample s = DRAW(mixture, u);
        vec3 towards = environmentTurn * normalize((vec4(frameOfSurface * s.wi, 0.0) * viewMatrix).xyz);
        reflected += s.weight * srbfSurroundings(towards, frame > 0u ? 0.0 : SPREAD / (float(draws) * max(s.pdf, 1e-6)));
    }
    light += reflected * (environmentIntensity / float(max(draws, 1)));
    gl_FragColor = vec4(tint * light, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
}
`;

/** Numbers of a picture, red, green, blue and one more a pixel; null where they are not in memory. */
function numbersOf({ image, type, colorSpace }) {
    const { data, width, height } = image ?? {};
    if (!data || data.length % (width * height) !== 0) return null;
    const perPixel = data.length / (width * height), isByte = data instanceof Uint8Array || data instanceof Uint8ClampedArray;
    const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    const ofBytes = Float32Array.from({ length: 256 }, (_, n) => (colorSpace === THREE.SRGBColorSpace ? linear(n / 255) : n / 255));
    const decoded = isByte ? (v) => ofBytes[v] : type === THREE.HalfFloatType ? THREE.DataUtils.fromHalfFloat : (v) => v;
    const numbers = new Float32Array(4 * width * height).fill(1);
    for (let i = 0; i < width * height; i++) {
        for (let c = 0; c < 3; c++) numbers[4 * i + c] = decoded(data[perPixel * i + Math.min(c, perPixel - 1)]);
    }
    return { numbers, width, height };
}

/** A picture of half the side; rows of a latitude-longitude map have the weight of their solid angle. */
function halved({ numbers, width, height }) {
    const [w, h] = [width, height].map((n) => Math.max(n >> 1, 1)), out = new Float32Array(4 * w * h);
    for (let y = 0; y < h; y++) {
        const rows = [2 * y, 2 * y + 1].map((row) => Math.min(row, height - 1));
        const weights = rows.map((row) => Math.sin((Math.PI * (row + 0.5)) / height)), all = 2 * (weights[0] + weights[1]);
        for (let x = 0; x < w; x++) {
            const [left, right] = [2 * x, Math.min(2 * x + 1, width - 1)];
            for (let c = 0; c < 4; c++) {
                const of = (n) => weights[n] * (numbers[4 * (rows[n] * width + left) + c] + numbers[4 * (rows[n] * width + right) + c]);
                out[4 * (y * w + x) + c] = (of(0) + of(1)) / all;
            }
        }
    }
    return { numbers: out, width: w, height: h };
}

const WIDEST = 2048; // pixels of a row of a map
const LARGEST = 65504; // the largest half float
const known = new WeakMap(); // maps with levels, by the map that they are of

/** A latitude-longitude map with its means over 2, 4, 8 ... pixels; a map whose numbers are not in memory as it is. */
function withLevels(map) {
    const made = known.get(map);
    if (made?.version === map.version) return made.texture;
    made?.texture.dispose();
    let level = numbersOf(map);
    if (!level) return map;
    while (level.width > WIDEST) level = halved(level);
    const levels = [level];
    while (level.width > 1 || level.height > 1) levels.push((level = halved(level)));
    const half = (v) => THREE.DataUtils.toHalfFloat(Math.min(Math.max(v, -LARGEST), LARGEST));
    const mipmaps = levels.map(({ numbers, width, height }) => ({ data: Uint16Array.from(numbers, half), width, height }));
    const [{ data, width, height }] = mipmaps;
    const texture = new THREE.DataTexture(data, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
    Object.assign(texture, { mipmaps, flipY: map.flipY, wrapS: THREE.RepeatWrapping, magFilter: THREE.LinearFilter, minFilter: THREE.LinearMipmapLinearFilter, needsUpdate: true });
    known.set(map, { version: map.version, texture });
    return texture;
}

const CUBE_UV = 306; // the mapping of a cube that is laid out in a plane
const black = new THREE.DataTexture(new Uint8Array(4), 1, 1);
const turn = new THREE.Matrix4();

/**
 * A measured surface: lights and shadows of three.js, ambient light by its albedo, a normal map, and a map of light: `environment`, or without
 * it that of the scene. A picture of `renderer.render` takes `even` directions of the lobes, the same at every pixel, and has no noise;
 * one of `Mean` takes `draws` random ones. A sheet is seen from both sides, and by light on both; its front is that of the geometry. Area
 * lights are not seen.
 */
export class SrbfMaterial extends THREE.ShaderMaterial {
    constructor({ srbf, environment = null, environmentIntensity = 1, draws = 4, even = 64, tint = 0xffffff, tangents = false, normalMap = null, normalScale = new THREE.Vector2(1, 1), ...others } = {}) {
        if (!srbf?.isTexture) throw new Error("srbf: a texture of loadSrbf or parseSrbf is expected");
        super({
            lights: true,
            // Means overlap, so that steps between directions are not seen.
            defines: { SPREAD: "1.0", ...(tangents ? { SRBF_TANGENTS: 1 } : {}) },
            uniforms: THREE.UniformsUtils.merge([THREE.UniformsLib.lights]),
            vertexShader,
            fragmentShader: fragmentShader(srbf.userData.isSheet === true),
            ...(srbf.userData.isSheet ? { side: THREE.DoubleSide } : {}),
            ...others,
        });
        // Not merged: textures are not copied.
        Object.assign(this.uniforms, {
            srbfWords: { value: srbf },
            environment: { value: black },
            environmentTurn: { value: new THREE.Matrix3() },
            environmentIntensity: { value: 0 },
            draws: { value: 0 },
            frame: { value: 0 },
            tint: { value: new THREE.Color(tint) },
            normalMap: { value: normalMap },
            normalMapTransform: { value: new THREE.Matrix3() },
            normalScale: { value: normalScale },
        });
        Object.assign(this, { isSrbfMaterial: true, normalMapType: THREE.TangentSpaceNormalMap, environment, environmentIntensity, draws, even });
    }

    /** The number of the picture: its draws are its own. 0 is the one without noise. */
    get frame() { return this.uniforms.frame.value; }
    set frame(number) { this.uniforms.frame.value = number; }

    /** A colour that multiplies the value. */
    get tint() { return this.uniforms.tint.value; }

    /** Slopes of the surface in its tangent frame, as those of MeshStandardMaterial; the geometry has an attribute `uv`. */
    get normalMap() { return this.uniforms.normalMap?.value ?? null; }
    set normalMap(map) {
        if (!map !== !this.normalMap) this.needsUpdate = true;
        this.uniforms.normalMap.value = map;
    }

    /** Two factors of the slopes of the normal map. */
    get normalScale() { return this.uniforms.normalScale.value; }

    /** Called by three.js before an object is drawn: finds the map of the scene. */
    onBeforeRender(renderer, scene) {
        const { uniforms, defines } = this;
        const map = this.environment ?? scene?.environment ?? null, isCube = map?.isCubeTexture === true;
        if (map?.mapping === CUBE_UV) throw new Error("environment: an equirectangular map or a cube is expected, and this is one of PMREMGenerator before r187");
        for (const [name, is] of [["SRBF_CUBE", isCube], ["SRBF_PREFILTERED", isCube && map.isPMREMTexture === true]]) {
            if (is === name in defines) continue;
            if (is) defines[name] = 1;
            else delete defines[name];
            this.needsUpdate = true;
        }
        uniforms.environment.value = !map ? black : isCube ? map : withLevels(map);
        uniforms.environmentIntensity.value = this.environmentIntensity * (this.environment ? 1 : (scene?.environmentIntensity ?? 1));
        uniforms.draws.value = !map ? 0 : this.frame > 0 ? this.draws : this.even;
        const { value } = uniforms.environmentTurn;
        value.identity();
        if (!this.environment && scene?.environmentRotation) value.setFromMatrix4(turn.makeRotationFromEuler(scene.environmentRotation)).transpose();
        // Cubes of pictures are seen from outside.
        if (isCube && map.isRenderTargetTexture !== true) for (const i of [0, 3, 6]) value.elements[i] *= -1;
        if (this.normalMap) {
            this.normalMap.updateMatrix();
            uniforms.normalMapTransform.value.copy(this.normalMap.matrix);
        }
        this.uniformsNeedUpdate = true;
    }
}

let pictures = 0; // that were drawn with random numbers

/** The mean of pictures of a scene, linear, in a target of floats: noise of draws falls with their number. */
export class Mean {
    constructor(width, height) {
        const target = () => new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter });
        [this.target, this.last, this.picture] = [target(), target(), target()];
        this.count = 0;
        const uniforms = { last: { value: null }, picture: { value: null }, share: { value: 1 } };
        const vertexShader = "void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }";
        const mix = "uniform sampler2D last; uniform sampler2D picture; uniform float share; void main() { ivec2 p = ivec2(gl_FragCoord.xy); gl_FragColor = mix(texelFetch(last, p, 0), texelFetch(picture, p, 0), share); }";
        const shown = "uniform sampler2D picture; void main() { gl_FragColor = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);\n#include <tonemapping_fragment>\n#include <colorspace_fragment>\n}";
        const material = (fragmentShader) => new THREE.ShaderMaterial({ uniforms, vertexShader, fragmentShader, depthTest: false, depthWrite: false });
        [this.mix, this.show] = [material(mix), material(shown)];
        this.square = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.mix);
        this.square.frustumCulled = false;
        this.camera = new THREE.Camera();
    }

    /** Begins again, as when the camera has moved. */
    reset() { this.count = 0; }

    /** Adds a picture; materials draw anew. */
    add(renderer, scene, camera) {
        const materials = new Set();
        scene.traverse(({ material }) => [material].flat().forEach((one) => { if (one?.isSrbfMaterial) materials.add(one); }));
        pictures += 1;
        materials.forEach((material) => { material.frame = pictures; });
        const before = renderer.getRenderTarget();
        renderer.setRenderTarget(this.picture);
        renderer.render(scene, camera);
        materials.forEach((material) => { material.frame = 0; });
        this.count += 1;
        [this.target, this.last] = [this.last, this.target];
        const { last, picture, share } = this.mix.uniforms;
        [last.value, picture.value, share.value] = [this.last.texture, this.picture.texture, 1 / this.count];
        this.square.material = this.mix;
        renderer.setRenderTarget(this.target);
        renderer.render(this.square, this.camera);
        renderer.setRenderTarget(before);
    }

    /** Draws the mean to the canvas, by the renderer's tone mapping and colour space. */
    draw(renderer) {
        this.show.uniforms.picture.value = this.target.texture;
        this.square.material = this.show;
        renderer.render(this.square, this.camera);
    }
}
