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
out vec3 srbfPosition;
out vec3 srbfNormal;
#ifdef SRBF_TANGENTS
in vec4 tangent;
out vec4 srbfTangent;
#endif
void main() {
    vec4 place = modelViewMatrix * vec4(position, 1.0);
    srbfPosition = place.xyz;
    srbfNormal = normalMatrix * normal;
#ifdef SRBF_TANGENTS
    srbfTangent = vec4((modelViewMatrix * vec4(tangent.xyz, 0.0)).xyz, tangent.w);
#endif
    gl_Position = projectionMatrix * place;
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
#include <lights_pars_begin>
uniform usampler2D srbfWords;
uniform sampler2D environment;
uniform float environmentIntensity;
uniform int draws;
uniform uint frame;
uniform vec3 tint;
in vec3 srbfPosition;
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

void main() {
    vec3 normal = normalize(srbfNormal)${isSheet ? "" : " * (gl_FrontFacing ? 1.0 : -1.0)"};
    vec3 view = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(-srbfPosition);
#ifdef SRBF_TANGENTS
    vec3 tangent = normalize(srbfTangent.xyz - normal * dot(normal, srbfTangent.xyz));
    vec3 bitangent = cross(normal, tangent) * srbfTangent.w;
#else
    vec3 tangent = normalize(abs(normal.x) < 0.8 ? cross(vec3(1.0, 0.0, 0.0), normal) : cross(vec3(0.0, 1.0, 0.0), normal));
    vec3 bitangent = cross(normal, tangent);
#endif
    mat3 frameOfSurface = mat3(tangent, bitangent, normal);
    vec3 wo = view * frameOfSurface;
    wo = normalize(vec3(wo.xy, ${isSheet ? "gl_FrontFacing ? max(wo.z, 1e-3) : min(wo.z, -1e-3)" : "max(wo.z, 1e-3)"}));
    VIEW mixture = PREPARE(wo);
    vec3 light = ambientLightColor * ALBEDO(mixture) * RECIPROCAL_PI;
    IncidentLight incident;
#if NUM_DIR_LIGHTS > 0
    for (int i = 0; i < NUM_DIR_LIGHTS; i++) {
        getDirectionalLightInfo(directionalLights[i], incident);
        light += incident.color * TOWARDS(mixture, incident.direction * frameOfSurface);
    }
#endif
#if NUM_POINT_LIGHTS > 0
    for (int i = 0; i < NUM_POINT_LIGHTS; i++) {
        getPointLightInfo(pointLights[i], srbfPosition, incident);
        light += incident.color * TOWARDS(mixture, incident.direction * frameOfSurface);
    }
#endif
#if NUM_SPOT_LIGHTS > 0
    for (int i = 0; i < NUM_SPOT_LIGHTS; i++) {
        getSpotLightInfo(spotLights[i], srbfPosition, incident);
        light += incident.color * TOWARDS(mixture, incident.direction * frameOfSurface);
    }
#endif
    vec3 reflected = vec3(0.0);
    for (int i = 0; i < draws; i++) {
        uvec3 bits = srbfRandom(uvec3(gl_FragCoord.xy, frame * uint(draws) + uint(i)));
        SrbfSample s = DRAW(mixture, vec3(bits >> 8u) * (1.0 / 16777216.0));
        vec3 towards = inverseTransformDirection(frameOfSurface * s.wi, viewMatrix);
        vec2 place = vec2(atan(towards.z, towards.x) * RECIPROCAL_PI2 + 0.5, asin(clamp(towards.y, -1.0, 1.0)) * RECIPROCAL_PI + 0.5);
        reflected += s.weight * textureLod(environment, place, 0.0).rgb;
    }
    light += reflected * (environmentIntensity / float(max(draws, 1)));
    gl_FragColor = vec4(tint * light, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
}
`;

/**
 * A measured surface: directional, point and spot lights, ambient light by its albedo, and an equirectangular map of light, of which every
 * frame takes `draws` directions of the lobes. A sheet is seen from both sides, and by light on both; its front is that of the geometry. Shadows
 * and lights of other kinds are not seen.
 */
export class SrbfMaterial extends THREE.ShaderMaterial {
    constructor({ srbf, environment = null, environmentIntensity = 1, draws = 4, tint = 0xffffff, tangents = false, ...others } = {}) {
        if (!srbf?.isTexture) throw new Error("srbf: a texture of loadSrbf or parseSrbf is expected");
        if (environment) environment.wrapS = THREE.RepeatWrapping;
        super({
            lights: true,
            defines: tangents ? { SRBF_TANGENTS: 1 } : {},
            uniforms: THREE.UniformsUtils.merge([THREE.UniformsLib.lights]),
            vertexShader,
            fragmentShader: fragmentShader(srbf.userData.isSheet === true),
            ...(srbf.userData.isSheet ? { side: THREE.DoubleSide } : {}),
            ...others,
        });
        // Not merged: textures are not copied.
        Object.assign(this.uniforms, {
            srbfWords: { value: srbf },
            environment: { value: environment ?? new THREE.DataTexture(new Uint8Array(4), 1, 1) },
            environmentIntensity: { value: environment ? environmentIntensity : 0 },
            draws: { value: environment ? draws : 0 },
            frame: { value: 0 },
            tint: { value: new THREE.Color(tint) },
        });
        this.isSrbfMaterial = true;
    }

    /** The number of the picture: its draws are its own. */
    get frame() { return this.uniforms.frame.value; }
    set frame(number) { this.uniforms.frame.value = number; }

    /** A colour that multiplies the value. */
    get tint() { return this.uniforms.tint.value; }
}

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
        scene.traverse((object) => { if (object.material?.isSrbfMaterial) object.material.frame += 1; });
        const before = renderer.getRenderTarget();
        renderer.setRenderTarget(this.picture);
        renderer.render(scene, camera);
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
