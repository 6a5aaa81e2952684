// A path tracer in WebGL 2: balls or the teapot under a light, drawn from the lobes themselves. +z is up.
import { quartersOf, wordsOf } from "./words.js";
import { decoded, floats, integers, tree } from "./tree.js";

/** The last one is a map of the user's. */
export const LIGHTS = ["room", "sky", "sun", "lamps", "own"];
export const SHAPES = ["ball", "teapot"];
/** What is shown of a sheet: a side, and the light that it reflects, that comes through, or both. */
export const SIDES = ["front", "back"], PARTS = ["both", "reflected", "transmitted"];
const WIDTH = 1024; // texels in a row of a texture of numbers
const MOST = 2048; // pictures that are averaged
const GOAL = 90; // milliseconds that a picture is to take: coarser ones take less
const [FIRST_SCALE, LEAST_SCALE] = [0.4, 0.25]; // pixels of the sum to one of the canvas, along a side

/** In daylight colours are what they are. */
export const DAYLIGHT = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** Stops by which pictures are brightened, so that lights are about as bright as each other. */
const STOPS = [0.4, 0.9, 0.3, 0.5, 0];
const OWN_MEAN = 0.6; // the mean of a map of the user's is brightened to this
const CELLS = [128, 64]; // of a map of the user's, at most, among which directions are drawn
const LARGEST = 65504; // half floats end there

/** Where the camera stands, as in the scenes of `srbf render`. */
const STANDPOINTS = {
    ball: { target: [0, 0, 0], azimuth: -90, height: 5.71, distance: 6.03, view: 24 },
    teapot: { target: [0.15, 0, 1.25], azimuth: -70.2, height: 20.6, distance: 12.2, view: 27 },
};

const vertexShader = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

const head = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
`;

// Each light is a smooth part, which the lobes look at, and a bright one, which is drawn too: a disc, two panels, a round haze.
const lights = `
uniform int light;
uniform sampler2D own_map;
uniform sampler2D own_cells; // share that stays, cell that has the rest, density over the unit square
const int ROOM = 0, SKY = 1, SUNLIGHT = 2, LAMPS = 3, OWN = 4;
const float PI = 3.14159265;
const vec3 SUN = vec3(-0.62096, -0.48515, 0.61566);
const float SUN_COSINE = 0.99984770;
const float HAZE = 40.0;
const vec3 KEY = vec3(-0.63960, -0.63960, 0.42640);
const vec2 KEY_SIZE = vec2(0.38, 0.30);
const vec3 RIM = vec3(0.78810, 0.39405, 0.47286);
const vec2 RIM_SIZE = vec2(0.12, 0.55);
const float KEY_SHARE = 0.6;

// Where on a map a direction is, and the other way round: rows from the top.
vec2 on_map(vec3 d) { return vec2(fract(0.5 - atan(d.y, d.x) / (2.0 * PI)), acos(clamp(d.z, -1.0, 1.0)) / PI); }
vec3 from_map(vec2 at) {
    float turn = (0.5 - at.x) * 2.0 * PI;
    return vec3(sin(PI * at.y) * cos(turn), sin(PI * at.y) * sin(turn), cos(PI * at.y));
}

// A room: tiles, walls with a dado, a ceiling. Its window and its door are bright.
vec3 room_light(vec3 d) {
    if (d.z < -0.02) {
        vec2 tile = floor(d.xy / -d.z * 0.9);
        float is_dark = mod(tile.x + tile.y, 2.0);
        return mix(mix(vec3(0.34, 0.30, 0.25), vec3(0.08, 0.075, 0.07), is_dark), vec3(0.21, 0.19, 0.16), smoothstep(-0.25, -0.02, d.z));
    }
    vec3 wall = mix(vec3(0.20, 0.17, 0.15), vec3(0.30, 0.29, 0.28), smoothstep(0.06, 0.07, d.z));
    return mix(wall, vec3(0.46, 0.46, 0.45), smoothstep(0.70, 0.72, d.z));
}

vec3 smooth_light(vec3 d) {
    float up = max(d.z, 0.0);
    if (light == ROOM) { return room_light(d); }
    if (light == OWN) { return vec3(0.0); }
    if (light == SUNLIGHT) { return mix(vec3(0.16, 0.15, 0.14), mix(vec3(0.36, 0.40, 0.46), vec3(0.10, 0.16, 0.28), sqrt(up)), smoothstep(-0.08, 0.04, d.z)); }
    if (light == LAMPS) { return mix(vec3(0.05, 0.05, 0.055), vec3(0.13, 0.135, 0.15), 0.5 + 0.5 * d.z); }
    vec3 horizon = vec3(0.80, 0.86, 0.92);
    float h = 1.0 - up;
    vec3 above = mix(vec3(0.10, 0.24, 0.58), horizon, h * h * h * h);
    vec3 below = mix(vec3(0.30, 0.27, 0.23), horizon, exp(min(d.z, 0.0) / 0.05));
    return d.z < 0.0 ? below : above;
}

// Coordinates of a direction on a panel, which is at a distance of 1.
vec3 on_panel(vec3 axis, vec3 d) {
    vec3 right = normalize(vec3(axis.y, -axis.x, 0.0));
    vec3 up = cross(right, axis);
    float along = dot(axis, d);
    return vec3(dot(right, d) / max(along, 1e-6), dot(up, d) / max(along, 1e-6), along);
}

bool is_on(vec3 axis, vec2 size, vec3 d) {
    vec3 at = on_panel(axis, d);
    return at.z > 0.0 && abs(at.x) < size.x && abs(at.y) < size.y;
}

vec3 bright_light(vec3 d) {
    if (light == OWN) { return textureLod(own_map, on_map(d), 0.0).rgb; }
    if (light == ROOM) {
        vec2 pane = abs(fract(on_panel(KEY, d).xy / KEY_SIZE * vec2(1.5, 1.0) + vec2(0.5, 0.0)) - 0.5);
        vec3 sum = is_on(KEY, KEY_SIZE, d) && max(pane.x, pane.y) < 0.46 ? vec3(7.4, 8.2, 9.2) : vec3(0.0);
        return sum + (is_on(RIM, RIM_SIZE, d) ? vec3(4.6, 4.0, 3.2) : vec3(0.0));
    }
    if (light == SUNLIGHT) { return dot(d, SUN) > SUN_COSINE ? vec3(1.0, 0.93, 0.82) * 4200.0 : vec3(0.0); }
    if (light == LAMPS) {
        vec3 sum = vec3(0.0);
        if (is_on(KEY, KEY_SIZE, d)) { sum += vec3(9.0, 8.8, 8.4); }
        if (is_on(RIM, RIM_SIZE, d)) { sum += vec3(6.5, 7.2, 8.2); }
        return sum;
    }
    return vec3(1.0, 0.90, 0.74) * (9.0 * exp(HAZE * (dot(d, SUN) - 1.0)));
}

float panel_density(vec3 axis, vec2 size, vec3 d) {
    vec3 at = on_panel(axis, d);
    float r2 = 1.0 + at.x * at.x + at.y * at.y;
    return is_on(axis, size, d) ? r2 * sqrt(r2) / (4.0 * size.x * size.y) : 0.0;
}

// The density of bright_draw, 1/sr.
float bright_density(vec3 d) {
    if (light == OWN) {
        ivec2 size = textureSize(own_cells, 0), cell = min(ivec2(on_map(d) * vec2(size)), size - 1);
        return texelFetch(own_cells, cell, 0).z / max(2.0 * PI * PI * sqrt(max(1.0 - d.z * d.z, 0.0)), 1e-4);
    }
    if (light == SUNLIGHT) { return dot(d, SUN) > SUN_COSINE ? 1.0 / (2.0 * PI * (1.0 - SUN_COSINE)) : 0.0; }
    if (light == LAMPS || light == ROOM) { return KEY_SHARE * panel_density(KEY, KEY_SIZE, d) + (1.0 - KEY_SHARE) * panel_density(RIM, RIM_SIZE, d); }
    return HAZE * exp(HAZE * (dot(d, SUN) - 1.0)) / (2.0 * PI);
}

vec3 facing(vec3 axis, vec3 d) {
    vec3 right = normalize(vec3(axis.y, -axis.x, 0.0));
    return right * d.x + cross(right, axis) * d.y + axis * d.z;
}

vec3 bright_draw(vec3 u) {
    if (light == OWN) {
        ivec2 size = textureSize(own_cells, 0);
        int cell = min(int(u.z * float(size.x * size.y)), size.x * size.y - 1);
        vec2 row = texelFetch(own_cells, ivec2(cell % size.x, cell / size.x), 0).xy;
        // The number that chooses between both is spread over the chosen one again.
        bool stays = u.x < row.x;
        float across = stays ? u.x / row.x : (u.x - row.x) / (1.0 - row.x);
        if (!stays) { cell = int(row.y); }
        return from_map((vec2(ivec2(cell % size.x, cell / size.x)) + vec2(across, u.y)) / vec2(size));
    }
    if (light == LAMPS || light == ROOM) {
        bool is_key = u.z < KEY_SHARE;
        vec2 at = (2.0 * u.xy - 1.0) * (is_key ? KEY_SIZE : RIM_SIZE);
        return facing(is_key ? KEY : RIM, normalize(vec3(at, 1.0)));
    }
    float c = light == SUNLIGHT ? 1.0 - u.x * (1.0 - SUN_COSINE) : max(1.0 + log(max(1.0 - u.x, 1e-30)) / HAZE, -1.0);
    float s = sqrt(max(1.0 - c * c, 0.0));
    return facing(SUN, vec3(s * cos(2.0 * PI * u.y), s * sin(2.0 * PI * u.y), c));
}
`;

const words = (text) => `
uniform usampler2D material_words;
uniform int place; // of the material in the words: of a sheet it is a quarter
uint srbf_word(int data, int i) { return texelFetch(material_words, ivec2((data + i) & ${WIDTH - 1}, (data + i) / ${WIDTH}), 0).r; }
${text}`;

const balls = `
const int BOUNCES = 1;
uniform vec3 apart; // from the middle to the second ball; 0 where there is one ball
Hit nearest(vec3 o, vec3 d, int bounce) {
    Hit h;
    h.distance = -1.0;
    h.is_ground = false;
    h.is_second = false;
    if (bounce > 0) { return h; }
    for (int ball = 0; ball < 2; ball++) {
        vec3 from = o + (ball == 0 ? apart : -apart);
        float along = dot(from, d);
        vec3 near = from - d * along;
        float half_chord = 1.0 - dot(near, near);
        float distance = -along - sqrt(max(half_chord, 0.0));
        if (half_chord < 0.0 || (h.distance > 0.0 && h.distance <= distance)) { continue; }
        h.distance = distance;
        h.is_second = ball == 1;
        h.flat_normal = normalize(from + d * distance);
    }
    h.normal = h.flat_normal;
    return h;
}
bool is_clear(vec3 o, vec3 d) { return true; }
`;

const meshes = `
const int BOUNCES = 3;
uniform sampler2D nodes;
uniform sampler2D corners;
uniform int node_count;
const float GROUND = -1e-3;
const vec2 GROUND_RADII = vec2(2.4, 6.5);
vec4 node_texel(int i) { return texelFetch(nodes, ivec2(i & ${WIDTH - 1}, i / ${WIDTH}), 0); }
vec3 corner(int i) { return texelFetch(corners, ivec2(i & ${WIDTH - 1}, i / ${WIDTH}), 0).xyz; }

// The nearest triangle, and where on it; -1 without one.
vec4 walk(vec3 o, vec3 d, bool is_any) {
    vec3 inverse = 1.0 / mix(vec3(1e-12), d, greaterThan(abs(d), vec3(1e-12)));
    vec4 best = vec4(1e30, 0.0, 0.0, -1.0);
    int i = 0;
    while (i < node_count) {
        vec4 low = node_texel(2 * i);
        vec4 high = node_texel(2 * i + 1);
        vec3 a = (low.xyz - o) * inverse;
        vec3 b = (high.xyz - o) * inverse;
        vec3 first = min(a, b);
        vec3 last = max(a, b);
        float enter = max(max(first.x, first.y), first.z);
        float leave = min(min(last.x, last.y), min(last.z, best.x));
        if (enter > leave || leave < 0.0) { i = int(low.w); continue; }
        if (high.w < 0.0) { i++; continue; }
        int code = int(high.w);
        for (int t = code / 8; t < code / 8 + (code & 7); t++) {
            vec3 e = corner(6 * t + 1);
            vec3 f = corner(6 * t + 2);
            vec3 p = cross(d, f);
            float determinant = dot(e, p);
            if (abs(determinant) < 1e-12) { continue; }
            vec3 s = o - corner(6 * t);
            float u = dot(s, p) / determinant;
            vec3 q = cross(s, e);
            float v = dot(d, q) / determinant;
            float distance = dot(f, q) / determinant;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 1e-4 && distance < best.x) {
                best = vec4(distance, u, v, float(t));
                if (is_any) { return best; }
            }
        }
        i = int(low.w);
    }
    return best;
}

Hit nearest(vec3 o, vec3 d, int bounce) {
    Hit h;
    h.distance = -1.0;
    h.is_ground = false;
    h.is_second = false;
    vec4 found = walk(o, d, false);
    float down = (GROUND - o.z) / (d.z == 0.0 ? -1e-12 : d.z);
    vec2 at = o.xy + d.xy * down;
    if (down > 1e-4 && down < found.x && dot(at, at) < GROUND_RADII.y * GROUND_RADII.y) {
        h.distance = down;
        h.is_ground = true;
        h.normal = vec3(0.0, 0.0, 1.0);
        h.flat_normal = h.normal;
        h.cover = 1.0 - smoothstep(GROUND_RADII.x, GROUND_RADII.y, length(at - vec2(0.15, 0.0)));
        return h;
    }
    if (found.w < 0.0) { return h; }
    int t = int(found.w);
    h.distance = found.x;
    h.cover = 1.0;
    h.flat_normal = normalize(cross(corner(6 * t + 1), corner(6 * t + 2)));
    h.normal = normalize(corner(6 * t + 3) * (1.0 - found.y - found.z) + corner(6 * t + 4) * found.y + corner(6 * t + 5) * found.z);
    if (dot(h.flat_normal, d) > 0.0) { h.flat_normal = -h.flat_normal; }
    if (dot(h.normal, h.flat_normal) < 0.0) { h.normal = -h.normal; }
    return h;
}
bool is_clear(vec3 o, vec3 d) { return walk(o, d, true).w < 0.0; }
`;

// The material of a place: of a palette it is found by maps, once round the vertical, as those of `srbf render --palette`.
const palettes = `
uniform int palette; // its materials, 0 without one
uniform usampler2D places; // of each in the words
uniform bvec3 has_map;
uniform sampler2D index_map; // the numbers of two materials
uniform sampler2D weight_map;
uniform sampler2D tint_map;
uniform float share; // of the second material, without a map of it
uniform vec4 wrap; // middle, lowest and highest of the shape

int place_at(vec3 point, float choice, out vec3 tint) {
    vec2 at = vec2(atan(point.y - wrap.y, point.x - wrap.x) / (2.0 * PI) + 0.5, (wrap.w - point.z) / (wrap.w - wrap.z));
    ivec2 two = ivec2(0, 1);
    if (has_map.x) { two = ivec2(textureLod(index_map, at, 0.0).rg * 255.0 + 0.5); }
    float weight = has_map.y ? textureLod(weight_map, at, 0.0).r : share;
    tint = has_map.z ? textureLod(tint_map, at, 0.0).rgb : vec3(1.0);
    return int(texelFetch(places, ivec2(min(choice < weight ? two.y : two.x, palette - 1), 0), 0).r);
}
`;

const paths = (text, shape) => `${head}
struct Hit { float distance; vec3 normal; vec3 flat_normal; bool is_ground; bool is_second; float cover; };
${lights}
${words(text)}
uniform sampler2D before;
uniform vec3 eye;
uniform vec3 forward;
uniform vec3 right;
uniform vec3 up;
uniform vec2 middle;
uniform uint frame;
uniform vec4 shifts[3];
uniform mat3 seen;
uniform vec2 turned;
uniform float side_of_light; // -1 where it comes through
uniform float covered; // 0 where a pass adds light to another one's
uniform bool has_surroundings; // the light is seen behind
uniform int beside; // the material of the second ball in the words
const vec3 GROUND_ALBEDO = vec3(0.52, 0.51, 0.50);
out vec4 sum;
${palettes}
${shape === "ball" ? balls : meshes}
// Four numbers of a pixel (Jarzynski and Olano 2020).
vec4 random(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
    return vec4(v >> 8u) * (1.0 / 16777216.0);
}

// Of the first hit numbers are spread evenly over the pictures; those of later ones are random.
vec4 numbers(int bounce, int part) {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    if (bounce == 0) { return fract(random(uvec4(pixel, 7u, uint(part))) + shifts[part]); }
    return random(uvec4(pixel, frame, uint(3 * bounce + part)));
}

void main() {
    vec4 jitter = numbers(0, 0);
    vec2 at = floor(gl_FragCoord.xy) + jitter.xy - middle;
    vec3 o = eye;
    vec3 d = normalize(forward + right * at.x + up * at.y);
    vec3 seen_along = d;
    SrbfMaterial material = srbf_material(place);
    vec3 tint = vec3(1.0);
    vec3 carried = vec3(1.0);
    vec3 light_sum = vec3(0.0);
    float cover = 1.0;
    float density = 0.0;
    for (int bounce = 0; bounce <= BOUNCES; bounce++) {
        Hit h = nearest(o, d, bounce);
        if (h.distance < 0.0) {
            if (bounce == 0) { cover = 0.0; break; }
            light_sum += carried * (smooth_light(d) + bright_light(d) * (density / (density + bright_density(d))));
            break;
        }
        if (bounce == BOUNCES) { break; }
        if (bounce == 0 && h.is_ground) { cover = h.cover; }
        vec3 side = normalize(abs(h.normal.z) < 0.99 ? cross(vec3(0.0, 0.0, 1.0), h.normal) : vec3(1.0, 0.0, 0.0));
        vec3 across = cross(h.normal, side);
        mat3 surface = mat3(side * turned.x + across * turned.y, across * turned.x - side * turned.y, h.normal);
        vec3 wo = -d * surface;
        wo = normalize(vec3(wo.xy, max(wo.z, 1e-3)));
        vec3 point = o + d * h.distance + h.flat_normal * 2e-4;
        SrbfView mixture;
        if (!h.is_ground) {
            if (h.is_second) { material = srbf_material(beside); } else if (palette > 0) { material = srbf_material(place_at(point, bounce == 0 ? jitter.z : numbers(bounce, 0).z, tint)); }
            mixture = srbf_prepare(material, wo);
        }
        vec4 first = numbers(bounce, 1);
        vec4 second = numbers(bounce, 2);
        // Towards the bright part of the light.
        vec3 towards = bright_draw(vec3(first.w, second.xy));
        vec3 wi = towards * surface * vec3(1.0, 1.0, side_of_light);
        if (wi.z > 0.0 && dot(towards, h.flat_normal) * side_of_light > 0.0 && is_clear(point, towards)) {
            SrbfValue f;
            f.value = GROUND_ALBEDO * (wi.z / PI);
            f.pdf = wi.z / PI;
            if (!h.is_ground) { f = srbf_evaluate(material, mixture, wi); f.value = tint * (seen * f.value); }
            light_sum += carried * bright_light(towards) * f.value / (bright_density(towards) + f.pdf);
        }
        // A direction of the lobes.
        SrbfSample s;
        if (h.is_ground) {
            float r = sqrt(first.y);
            s.wi = vec3(r * cos(2.0 * PI * first.z), r * sin(2.0 * PI * first.z), sqrt(1.0 - first.y));
            s.pdf = s.wi.z / PI;
            s.weight = GROUND_ALBEDO;
        } else {
            s = srbf_sample(material, mixture, first.xyz);
            s.weight = tint * (seen * s.weight);
        }
        d = normalize(surface * vec3(s.wi.xy, s.wi.z * side_of_light));
        if (s.pdf <= 0.0 || dot(d, h.flat_normal) * side_of_light <= 0.0) { break; }
        carried *= s.weight;
        density = s.pdf;
        o = point;
    }
    // A number that is not one would stay in the sum for ever.
    if (any(isnan(light_sum)) || any(isinf(light_sum))) { light_sum = vec3(0.0); }
    vec4 added = vec4(light_sum * cover, cover * covered);
    if (has_surroundings && cover < 1.0 && covered > 0.0) { added += vec4(smooth_light(seen_along) + min(bright_light(seen_along), 64.0), 1.0) * (1.0 - cover); }
    sum = texelFetch(before, ivec2(gl_FragCoord.xy), 0) + added;
}`;

// The tone map of the pictures of `srbf render`: "PBR Neutral" (Khronos 2024).
const display = `${head}
uniform sampler2D picture;
uniform float scale;
uniform float exposure;
uniform vec2 size;
out vec4 colour;
vec3 tone(vec3 radiance) {
    float low = min(radiance.r, min(radiance.g, radiance.b));
    vec3 mapped = radiance - (low < 0.08 ? low - 6.25 * low * low : 0.04);
    float peak = max(mapped.r, max(mapped.g, mapped.b));
    float room = 1.0 - 0.76;
    if (peak < 0.76) { return mapped; }
    float lower = 1.0 - room * room / (peak + room - 0.76);
    float white = 1.0 - 1.0 / (0.15 * (peak - lower) + 1.0);
    return mix(mapped * (lower / peak), vec3(lower), white);
}
void main() {
    vec2 pixel = gl_FragCoord.xy / size * vec2(textureSize(picture, 0));
    // Between pixels linear: float textures are not always filtered.
    vec2 at = pixel - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 t = at - vec2(low);
    ivec2 end = textureSize(picture, 0) - 1;
    vec4 a = texelFetch(picture, clamp(low, ivec2(0), end), 0);
    vec4 b = texelFetch(picture, clamp(low + ivec2(1, 0), ivec2(0), end), 0);
    vec4 c = texelFetch(picture, clamp(low + ivec2(0, 1), ivec2(0), end), 0);
    vec4 d = texelFetch(picture, clamp(low + ivec2(1, 1), ivec2(0), end), 0);
    vec4 sum = mix(mix(a, b, t.x), mix(c, d, t.x), t.y) * scale;
    vec3 linear = sum.a > 0.0 ? max(sum.rgb / sum.a, 0.0) * exposure : vec3(0.0);
    vec3 mapped = clamp(tone(linear), 0.0, 1.0);
    vec3 encoded = mix(12.92 * mapped, 1.055 * pow(mapped, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), mapped));
    colour = vec4(encoded * sum.a, sum.a);
}`;

// Rows of f cos over the plane of incidence: of all, of each lobe, and of the diffuse term; luminance, red, green, blue.
const curves = (text) => `${head}
${words(text)}
uniform float theta;
uniform vec2 turned;
uniform int columns;
out vec4 value;
void main() {
    SrbfMaterial m = srbf_material(place);
    // The frame turns with the sample, and the plane of incidence stays.
    vec2 plane = vec2(turned.x, -turned.y);
    SrbfView v = srbf_prepare(m, vec3(-sin(theta) * plane, cos(theta)));
    float angle = (float(int(gl_FragCoord.x)) / float(columns - 1) - 0.5) * 3.14159265;
    vec3 wi = vec3(sin(angle) * plane, max(cos(angle), 0.0));
    vec3 factor = srbf_factor(m, v.wo, wi);
    int row = int(gl_FragCoord.y);
    vec3 f = srbf_evaluate(m, v, wi).value;
    if (row == m.lobes + m.mirrored + 1) { f = v.diffuse * (wi.z * 0.318309886) * factor; }
    if (row > 0 && row <= m.lobes + m.mirrored) {
        float c = v.turn_x * v.tilt_x - v.turn_y * v.tilt_y;
        float s = v.turn_y * v.tilt_x + v.turn_x * v.tilt_y;
        vec3 d = vec3(wi.x * c + wi.y * s, wi.y * c - wi.x * s, wi.z);
        vec3 u = d * v.squeeze;
        float length2 = dot(u, u);
        float length1 = sqrt(length2);
        bool is_squeezed = row - 1 < m.squeezed;
        SrbfLobe lobe = srbf_lobe(m, v, row - 1);
        vec3 e = is_squeezed ? u - lobe.axis * length1 : d - lobe.axis;
        float t = -0.72134752 * lobe.sharpness * dot(e, e) * (is_squeezed ? 1.0 / length2 : 1.0);
        float below = -2.88539008 * lobe.sharpness * wi.z * lobe.axis.z * (is_squeezed ? 1.0 / length1 : 1.0);
        float g = lobe.y * exp2(t) * (1.0 + exp2(below)) * (is_squeezed ? v.squeeze.x * v.squeeze.y / (length2 * length1) : 1.0);
        f = lobe.colour * g * factor;
    }
    value = vec4(dot(f, vec3(0.2126, 0.7152, 0.0722)), f);
}`;

// Light from everywhere, as a material shows it: luminance, red, green, blue.
const albedos = (text) => `${head}
${words(text)}
uniform float theta;
uniform vec2 turned;
out vec4 value;
void main() {
    SrbfMaterial m = srbf_material(place);
    vec3 albedo = srbf_albedo(m, srbf_prepare(m, vec3(-sin(theta) * vec2(turned.x, -turned.y), cos(theta))));
    value = vec4(dot(albedo, vec3(0.2126, 0.7152, 0.0722)), albedo);
}`;

// A light as a latitude-longitude map, as `srbf render` reads one: rows from the top.
const maps = `${head}
${lights}
uniform vec2 size;
out vec4 radiance;
void main() {
    vec3 d = from_map(gl_FragCoord.xy / size);
    radiance = vec4(smooth_light(d) + bright_light(d), 1.0);
}`;

/**
 * Cells of a map with their shares of its light, from which a cell is drawn by one number (Walker 1977): share that stays, cell that has the
 * rest, density over the unit square.
 */
function cellsOf({ width, height, numbers }) {
    const [w, h] = [Math.min(width, CELLS[0]), Math.min(height, CELLS[1])], count = w * h;
    const light = new Float64Array(count);
    for (let y = 0; y < height; y++) {
        const weight = Math.sin((Math.PI * (y + 0.5)) / height);
        for (let x = 0; x < width; x++) {
            const i = 4 * (y * width + x);
            light[Math.floor((y * h) / height) * w + Math.floor((x * w) / width)] += weight * (0.2126 * numbers[i] + 0.7152 * numbers[i + 1] + 0.0722 * numbers[i + 2]);
        }
    }
    const sum = light.reduce((a, b) => a + b, 0);
    // A tenth goes everywhere, so that no light is missed between cells.
    const shares = Array.from(light, (value, i) => (sum > 0 ? (0.9 * value * count) / sum : 0.9) + 0.1);
    const cells = new Float32Array(4 * count), rest = [...shares];
    const [few, many] = [[], []];
    rest.forEach((share, i) => (share < 1 ? few : many).push(i));
    while (few.length > 0 && many.length > 0) {
        const [i, j] = [few.pop(), many.pop()];
        cells.set([rest[i], j], 4 * i);
        rest[j] -= 1 - rest[i];
        (rest[j] < 1 ? few : many).push(j);
    }
    for (const i of [...few, ...many]) cells.set([1, i], 4 * i);
    shares.forEach((share, i) => { cells[4 * i + 2] = share; });
    return { width: w, height: h, numbers: cells, mean: sum / height / width / (2 / Math.PI) };
}

/** Where maps are wrapped round a mesh: its middle in x and y, and its lowest and highest point. */
function wrapped(positions) {
    const bounds = [0, 1, 2].map((axis) => {
        let [low, high] = [Infinity, -Infinity];
        for (let i = axis; i < positions.length; i += 3) [low, high] = [Math.min(low, positions[i]), Math.max(high, positions[i])];
        return [low, high];
    });
    return [...bounds.slice(0, 2).map(([low, high]) => 0.5 * (low + high)), ...bounds[2]];
}

/** A tracer on a canvas. Throws an error where WebGL 2 or pictures of floating-point numbers are not there. */
export class Tracer {
    constructor(canvas, data) {
        this.canvas = canvas;
        this.data = data;
        const gl = canvas.getContext("webgl2", { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true });
        if (!gl) throw new Error("this browser has no WebGL 2");
        if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("this browser draws no floating-point pictures");
        this.gl = gl;
        this.programs = new Map();
        this.scales = { ball: FIRST_SCALE, teapot: FIRST_SCALE };
        this.fixedScale = null;
        [this.shape, this.light, this.exposure] = ["ball", 0, 0];
        this.surroundings = true; // whether the light is seen behind
        this.beside = null; // words of the material of a second ball
        this.stops = [...STOPS];
        this.seen = DAYLIGHT; // the colours of the material's red, green and blue; of a sheet four of them
        [this.side, this.part] = [SIDES[0], PARTS[0]];
        this.others = []; // materials of a palette beside the first, as words
        [this.maps, this.share] = [{}, 0.5]; // textures by name: index, weight, tint; and the second's share without a map
        this.turned = [1, 0]; // cosine and sine of the turn of the sample about its normal
        this.turns = Object.fromEntries(SHAPES.map((shape) => [shape, { ...STANDPOINTS[shape] }]));
        this.targets = [];
        this.count = 0;
        this.first = 0;
        this.isMoving = false;
        gl.bindVertexArray(gl.createVertexArray());
    }

    /** A texture of numbers, in rows of `WIDTH`. */
    texture(kind, numbers, perTexel) {
        const { gl } = this;
        const rows = Math.max(Math.ceil(numbers.length / perTexel / WIDTH), 1);
        const padded = new numbers.constructor(rows * WIDTH * perTexel);
        padded.set(numbers);
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        const [inside, format, type] = kind === "words" ? [gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT] : [gl.RGBA32F, gl.RGBA, gl.FLOAT];
        gl.texImage2D(gl.TEXTURE_2D, 0, inside, WIDTH, rows, 0, format, type, padded);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        return texture;
    }

    /** A program by name; it is compiled when it is first used. */
    program(name) {
        const known = this.programs.get(name);
        if (known) return known;
        const { gl } = this;
        const texts = { ball: () => paths(this.data.evaluator, "ball"), teapot: () => paths(this.data.evaluator, "teapot"), shown: () => display, curves: () => curves(this.data.evaluator), albedos: () => albedos(this.data.evaluator), maps: () => maps };
        const program = gl.createProgram();
        for (const [kind, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, texts[name]()]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
        const places = new Map();
        const place = (uniform) => {
            if (!places.has(uniform)) places.set(uniform, gl.getUniformLocation(program, uniform));
            return places.get(uniform);
        };
        const made = { program, place };
        this.programs.set(name, made);
        return made;
    }

    /** A picture of floating-point numbers. */
    target(width, height) {
        const { gl } = this;
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        const frame = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        return { texture, frame, width, height };
    }

    release(target) {
        this.gl.deleteFramebuffer(target.frame);
        this.gl.deleteTexture(target.texture);
    }

    bind(unit, texture, uniform) {
        const { gl } = this;
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.uniform1i(uniform, unit);
    }

    /** Takes a material or a sheet; throws an error that names it if it is none. */
    setMaterial(bytes, name) {
        const words = wordsOf(bytes, name, WIDTH);
        this.all = words;
        this.quarters = quartersOf(words);
        this.load();
        this.seen = this.quarters ? this.quarters.map(() => DAYLIGHT) : DAYLIGHT;
        if (this.quarters) this.shape = SHAPES[0];
        this.reset();
    }

    /** Takes the materials of a palette beside the first: bytes and names. Throws an error that names a sheet. */
    setPalette(others) {
        this.others = others.map(({ bytes, name }) => {
            const words = wordsOf(bytes, name, WIDTH);
            if (quartersOf(words)) throw new Error(`${name}: a palette is of materials, and this is a sheet`);
            return words;
        });
        this.load();
        this.reset();
    }

    /** Loads what is shown, and behind it the others of the palette. A sheet has none. */
    load() {
        if (!this.all) return;
        const parts = this.quarters ? [this.all] : [this.all, ...this.others, ...(this.beside ? [this.beside] : [])];
        const words = new Uint32Array(parts.reduce((sum, part) => sum + part.length, 0));
        const places = parts.map((part, n) => parts.slice(0, n).reduce((sum, before) => sum + before.length, 0));
        parts.forEach((part, n) => words.set(part, places[n]));
        for (const old of [this.words, this.places]) if (old) this.gl.deleteTexture(old);
        this.words = this.texture("words", words, 1);
        this.places = this.texture("words", Uint32Array.from(places), 1);
    }

    /** Takes a material for a second ball: bytes and name, or null. Throws an error that names a sheet. */
    setBeside(other) {
        const words = other && wordsOf(other.bytes, other.name, WIDTH);
        if (words && quartersOf(words)) throw new Error(`${other.name}: a material is expected beside another one, and this is a sheet`);
        this.beside = words;
        this.load();
        this.reset();
    }

    /** Whether there are two balls. */
    get isPair() { return this.beside !== null && this.shape === "ball" && !this.quarters; }

    /** Takes a map of light: width, height and numbers, four a pixel, rows from the top. */
    setOwn(map) {
        const { gl } = this, most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
        if (Math.max(map.width, map.height) > most) throw new Error(`${most} pixels at most along a side are expected`);
        const cells = cellsOf(map);
        if (!(cells.mean > 0)) throw new Error("a picture with some light is expected");
        const texture = ({ width, height, numbers }, inside, filter) => {
            const made = gl.createTexture();
            gl.activeTexture(gl.TEXTURE0 + 9);
            gl.bindTexture(gl.TEXTURE_2D, made);
            gl.texImage2D(gl.TEXTURE_2D, 0, inside, width, height, 0, gl.RGBA, gl.FLOAT, numbers);
            for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, filter);
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
            return made;
        };
        Object.values(this.own ?? {}).forEach((old) => gl.deleteTexture(old));
        this.own = { map: texture({ ...map, numbers: map.numbers.map((v) => Math.min(v, LARGEST)) }, gl.RGBA16F, gl.LINEAR), cells: texture(cells, gl.RGBA32F, gl.NEAREST) };
        this.stops[LIGHTS.indexOf("own")] = Math.log2(OWN_MEAN / cells.mean);
        this.set({ light: LIGHTS.indexOf("own") });
    }

    /** Binds the map of the user's; where there is none, a texture of its kind. */
    bindOwn(place, other) {
        this.bind(9, this.own?.map ?? other, place("own_map"));
        this.bind(10, this.own?.cells ?? other, place("own_cells"));
    }

    /** Materials of the palette; 0 where maps have nothing to do. */
    get palette() {
        return this.quarters || (this.others.length === 0 && !this.maps.tint) ? 0 : 1 + this.others.length;
    }

    /** Takes a map of the palette, "index", "weight" or "tint", from a picture; without one it is no more. */
    setMap(name, picture) {
        const { gl } = this;
        if (this.maps[name]) gl.deleteTexture(this.maps[name]);
        delete this.maps[name];
        if (picture) {
            const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
            if (Math.max(picture.width, picture.height) > most) throw new Error(`a picture of ${most} pixels at most along a side is expected`);
            const texture = gl.createTexture();
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, name === "tint" ? gl.SRGB8_ALPHA8 : gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, picture);
            const filter = name === "index" ? gl.NEAREST : gl.LINEAR;
            for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, filter);
            for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, key, gl.REPEAT);
            this.maps[name] = texture;
        }
        this.reset();
    }

    /** Quarters of the sheet that are shown and not black, by number. */
    get halves() {
        const first = 2 * SIDES.indexOf(this.side);
        const wanted = this.part === "both" ? [first, first + 1] : [first + PARTS.indexOf(this.part) - 1];
        return wanted.filter((quarter) => this.quarters[quarter] > 0);
    }

    /** Words before the material that is plotted: of a sheet the first quarter that is shown. */
    get place() {
        return this.quarters ? this.quarters[this.halves[0] ?? this.quarters.findIndex((at) => at > 0)] : 0;
    }

    /** Numbers of its head. */
    get numbers() {
        const own = this.all.subarray(this.place);
        return { lobes: own[6], mirrored: own[3] === 0 ? own[own[2] === 2 ? 9 : 8] : 0, angles: own[5], kind: own[3] };
    }

    set(settings) {
        Object.assign(this, settings);
        if (Object.keys(settings).some((name) => name !== "exposure")) this.reset();
    }

    /** Turns the camera by degrees, and draws it nearer. */
    turn(right, up, nearer = 1) {
        const at = this.turns[this.shape];
        at.azimuth -= right;
        at.height = Math.min(Math.max(at.height + up, this.shape === "ball" ? -85 : 2), 85);
        at.distance = Math.min(Math.max(at.distance / nearer, STANDPOINTS[this.shape].distance / 2.5), STANDPOINTS[this.shape].distance * 2);
        this.reset();
    }

    /** Back to where the camera stood. */
    home() {
        this.turns[this.shape] = { ...STANDPOINTS[this.shape] };
        this.reset();
    }

    /** Begins the picture again. */
    reset() { this.count = 0; }

    camera(width, height, shape, isPair) {
        const { target, azimuth, height: above, distance: own, view } = this.turns[shape];
        const distance = own * (isPair ? 1.9 : 1);
        const [a, h] = [azimuth, above].map((degrees) => (degrees * Math.PI) / 180);
        const outward = [Math.cos(h) * Math.cos(a), Math.cos(h) * Math.sin(a), Math.sin(h)];
        const forward = outward.map((v) => -v);
        const right = [-Math.sin(a), Math.cos(a), 0];
        const up = [right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2], right[0] * forward[1] - right[1] * forward[0]];
        const pixel = (2 * Math.tan((view * Math.PI) / 360)) / Math.min(width, height);
        return { eye: target.map((v, i) => v + distance * outward[i]), forward, right: right.map((v) => v * pixel), up: up.map((v) => v * pixel) };
    }

    /** Adds a picture to the sum in `targets`: of a sheet the light of each part. */
    add(targets, count, words = this.words, shape = this.shape) {
        const isSheet = this.quarters && words === this.words;
        const halves = isSheet ? this.halves : [];
        if (halves.length === 0) return this.pass(targets, count, words, shape, { covered: 1, isBlack: isSheet });
        halves.forEach((quarter, n) => this.pass(targets, count + n, words, shape, {
            place: this.quarters[quarter],
            side: quarter % 2 === 0 ? 1 : -1,
            covered: n === 0 ? 1 : 0,
            seen: this.seen[quarter],
            number: count,
        }));
    }

    /** Adds the light of one material. */
    pass(targets, count, words, shape, { place: start = 0, side = 1, covered = 1, seen = this.seen, number: picture = count, isBlack = false }) {
        const { gl } = this;
        const { program, place } = this.program(shape);
        const [from, to] = targets;
        gl.useProgram(program);
        gl.bindFramebuffer(gl.FRAMEBUFFER, to.frame);
        gl.viewport(0, 0, to.width, to.height);
        this.bind(0, words, place("material_words"));
        if (count === 0) {
            gl.bindFramebuffer(gl.FRAMEBUFFER, from.frame);
            gl.clearColor(0, 0, 0, 0);
            gl.clear(gl.COLOR_BUFFER_BIT);
            gl.bindFramebuffer(gl.FRAMEBUFFER, to.frame);
        }
        this.bind(1, from.texture, place("before"));
        if (shape === "teapot") {
            if (!this.mesh) {
                const { positions, normals, triangles } = this.data.teapot;
                const made = tree(floats(positions), floats(normals), integers(triangles));
                this.mesh = { nodes: this.texture("numbers", made.nodes, 4), corners: this.texture("numbers", made.corners, 4), count: made.nodes.length / 8, wrap: wrapped(floats(positions)) };
                gl.useProgram(program);
                this.bind(0, words, place("material_words"));
                this.bind(1, from.texture, place("before"));
            }
            this.bind(2, this.mesh.nodes, place("nodes"));
            this.bind(3, this.mesh.corners, place("corners"));
            gl.uniform1i(place("node_count"), this.mesh.count);
        }
        this.bindPalette(place, words === this.words ? this.palette : 0, from, shape === "teapot" ? this.mesh.wrap : [0, 0, -1, 1]);
        const isPair = this.isPair && words === this.words;
        const { eye, forward, right, up } = this.camera(to.width, to.height, shape, isPair);
        for (const [name, vector] of Object.entries({ eye, forward, right, up })) gl.uniform3fv(place(name), vector);
        const length = Math.hypot(...right);
        gl.uniform3fv(place("apart"), right.map((v) => (isPair ? (1.1 * v) / length : 0)));
        gl.uniform1i(place("beside"), isPair ? this.all.length + this.others.reduce((sum, other) => sum + other.length, 0) : 0);
        gl.uniform1i(place("has_surroundings"), this.surroundings && words === this.words ? 1 : 0);
        this.bindOwn(place, from.texture);
        gl.uniform2f(place("middle"), to.width / 2, to.height / 2);
        gl.uniform1i(place("light"), this.light);
        gl.uniformMatrix3fv(place("seen"), false, isBlack ? new Array(9).fill(0) : seen);
        gl.uniform2fv(place("turned"), this.turned);
        gl.uniform1i(place("place"), isBlack ? this.place : start);
        gl.uniform1f(place("side_of_light"), side);
        gl.uniform1f(place("covered"), covered);
        const number = this.first + picture;
        gl.uniform1ui(place("frame"), number);
        // Multiples of powers of a root: points that fill a cube of twelve dimensions evenly (Roberts 2018).
        const root = 1.05705; // of x^13 = x + 1
        gl.uniform4fv(place("shifts"), Array.from({ length: 12 }, (_, i) => (number * root ** -(i + 1)) % 1));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        targets.reverse();
    }

    /** Samplers that nothing is read from need textures of their kinds too. */
    bindPalette(place, palette, from, wrap) {
        const { gl, maps } = this;
        const names = ["index", "weight", "tint"];
        this.bind(5, this.places, place("places"));
        names.forEach((name, i) => this.bind(6 + i, maps[name] ?? from.texture, place(`${name}_map`)));
        gl.uniform1i(place("palette"), palette);
        gl.uniform3iv(place("has_map"), names.map((name) => (maps[name] ? 1 : 0)));
        // A map of two materials without one of shares shows the first.
        gl.uniform1f(place("share"), maps.index || palette < 2 ? 0 : this.share);
        gl.uniform4fv(place("wrap"), wrap);
    }

    /** Draws a sum to a frame, null for the canvas. */
    show(sum, count, frame, width, height) {
        const { gl } = this;
        const { program, place } = this.program("shown");
        gl.useProgram(program);
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        gl.viewport(0, 0, width, height);
        this.bind(0, sum.texture, place("picture"));
        gl.uniform1f(place("scale"), 1 / count);
        gl.uniform1f(place("exposure"), 2 ** (this.exposure + this.stops[this.light]));
        gl.uniform2f(place("size"), width, height);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    /** One step of the picture on the canvas, as far as the last one is done. Says whether there is more to do. */
    step() {
        const { gl, canvas } = this;
        if (!this.words || gl.isContextLost()) return false;
        if (this.sync) {
            const state = gl.clientWaitSync(this.sync, gl.SYNC_FLUSH_COMMANDS_BIT, 0);
            if (state === gl.TIMEOUT_EXPIRED) return true;
            gl.deleteSync(this.sync);
            this.sync = null;
            // A program that is new takes longer than it will.
            if (!this.isFresh && !this.isMoving) this.adapt(performance.now() - this.began);
        }
        const scale = this.fixedScale ?? this.scales[this.shape] * (this.isMoving ? 0.6 : 1);
        const size = [canvas.width, canvas.height].map((n) => Math.max(Math.round(n * scale), 8));
        const isOther = this.targets.length === 0 || this.targets[0].width !== size[0] || this.targets[0].height !== size[1];
        if (isOther) {
            this.targets.forEach((target) => this.release(target));
            this.targets = [this.target(...size), this.target(...size)];
            this.count = 0;
        }
        if (this.count >= (this.most ?? MOST)) {
            this.show(this.targets[0], this.count, null, canvas.width, canvas.height);
            return false;
        }
        this.isFresh = !this.programs.has(this.shape);
        this.began = performance.now();
        this.add(this.targets, this.count);
        this.count += 1;
        this.show(this.targets[0], this.count, null, canvas.width, canvas.height);
        this.sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        return true;
    }

    /** Makes pictures finer or coarser, as long as they take; once they are fine enough they stay so. */
    adapt(took) {
        const now = this.scales[this.shape];
        const better = Math.min(Math.max(now * Math.sqrt(GOAL / Math.max(took, 1)), LEAST_SCALE, 0.5 * now), 1, 2.5 * now);
        const isFine = better < 1.35 * now && better > now / 1.6;
        if (this.fixedScale !== null || isFine || this.count > 8) return;
        this.scales[this.shape] = better;
        this.count = 0;
    }

    /** The mean of pictures of some size: numbers, rows from the bottom. */
    rendered(width, height, pictures, first = 0) {
        const { gl } = this;
        const targets = [this.target(width, height), this.target(width, height)];
        const before = this.first;
        this.first = first;
        for (let i = 0; i < pictures; i++) this.add(targets, i);
        this.first = before;
        const pixels = new Float32Array(4 * width * height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, targets[0].frame);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
        targets.forEach((target) => this.release(target));
        return pixels.map((v) => v / pictures);
    }

    /** A small picture of a material, as a canvas. */
    thumbnail(bytes, size, pictures) {
        const { gl } = this;
        const words = this.texture("words", wordsOf(bytes, "a preset", WIDTH), 1);
        const targets = [this.target(size, size), this.target(size, size)];
        const [light, turn, seen] = [this.light, this.turns.ball, this.seen];
        this.light = LIGHTS.indexOf("sky");
        this.seen = DAYLIGHT;
        this.turns.ball = { ...STANDPOINTS.ball, distance: 5.2 };
        for (let i = 0; i < pictures; i++) this.add(targets, i, words, "ball");
        this.light = light;
        this.turns.ball = turn;
        this.seen = seen;
        const texture = gl.createTexture();
        gl.activeTexture(gl.TEXTURE4);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, size, size);
        const frame = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        this.show(targets[0], pictures, frame, size, size);
        const pixels = new Uint8ClampedArray(4 * size * size);
        gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        gl.deleteFramebuffer(frame);
        [texture, words].forEach((of) => gl.deleteTexture(of));
        targets.forEach((target) => this.release(target));
        const canvas = document.createElement("canvas");
        canvas.width = canvas.height = size;
        const image = new ImageData(size, size);
        for (let y = 0; y < size; y++) {
            for (let x = 0; x < size; x++) {
                const [at, to] = [4 * ((size - 1 - y) * size + x), 4 * (y * size + x)];
                const alpha = pixels[at + 3];
                for (let c = 0; c < 3; c++) image.data[to + c] = alpha > 0 ? (255 * pixels[at + c]) / alpha : 0;
                image.data[to + 3] = alpha;
            }
        }
        canvas.getContext("2d").putImageData(image, 0, 0);
        return canvas;
    }

    /** Rows of numbers from a program without inputs but uniforms. */
    table(name, width, height, prepare) {
        const { gl } = this;
        const { program, place } = this.program(name);
        const target = this.target(width, height);
        gl.useProgram(program);
        gl.viewport(0, 0, width, height);
        prepare(gl, place);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        const values = new Float32Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
        this.release(target);
        return values;
    }

    /** `f cos` over the plane of incidence, -90 to 90 degrees: of all, of each lobe and of the diffuse term, luminance first. */
    curves(degrees, columns) {
        const { lobes, mirrored } = this.numbers, rows = lobes + mirrored + 2;
        const values = this.table("curves", columns, rows, (gl, place) => {
            this.bind(0, this.words, place("material_words"));
            gl.uniform1f(place("theta"), (degrees * Math.PI) / 180);
            gl.uniform1i(place("place"), this.place);
            gl.uniform2fv(place("turned"), this.turned);
            gl.uniform1i(place("columns"), columns);
        });
        return Array.from({ length: rows }, (_, row) => values.subarray(4 * row * columns, 4 * (row + 1) * columns));
    }

    /** Reflected and transmitted share of light from everywhere, luminance: of the side of the sheet that is shown. */
    shares(degrees) {
        const first = 2 * SIDES.indexOf(this.side);
        return [first, first + 1].map((quarter) => this.quarters[quarter] && this.table("albedos", 1, 1, (gl, place) => {
            this.bind(0, this.words, place("material_words"));
            gl.uniform1i(place("place"), this.quarters[quarter]);
            gl.uniform1f(place("theta"), (degrees * Math.PI) / 180);
            gl.uniform2fv(place("turned"), this.turned);
        })[0]);
    }

    /** A light as a map: numbers, rows from the top. */
    map(light, width, height) {
        const none = this.target(1, 1);
        const values = this.table("maps", width, height, (gl, place) => {
            this.bindOwn(place, none.texture);
            gl.uniform1i(place("light"), light);
            gl.uniform2f(place("size"), width, height);
        });
        this.release(none);
        return values;
    }

    /**
     * How a material looks, seen in daylight: its colours under light from everywhere, seen along the normal and at 75 degrees, and at 45
     * degrees the width of the highlight, how many times it is as bright as the light beside it, and about its share of the light.
     */
    look() {
        const albedo = (degrees) => this.table("albedos", 1, 1, (gl, place) => {
            this.bind(0, this.words, place("material_words"));
            gl.uniform1i(place("place"), this.place);
            gl.uniform1f(place("theta"), (degrees * Math.PI) / 180);
            gl.uniform2fv(place("turned"), this.turned);
        });
        const columns = 721, row = this.curves(45, columns)[0];
        // The BRDF, without the cosine of the light.
        const values = Array.from({ length: columns }, (_, i) => row[4 * i] / Math.max(Math.cos((Math.PI * i) / (columns - 1) - Math.PI / 2), 0.05)).slice(20, -20);
        const most = Math.max(...values), at = values.indexOf(most), base = [...values].sort((a, b) => a - b)[Math.floor(columns / 4)];
        let [from, to] = [at, at];
        const isHigh = (i) => values[i] > 0.5 * (most + base);
        while (isHigh(from - 1)) from -= 1;
        while (isHigh(to + 1)) to += 1;
        const width = (180 * (to - from + 1)) / (columns - 1);
        return { along: albedo(0), grazing: albedo(75), width, contrast: most / Math.max(base, 1e-9), share: most * Math.SQRT1_2 * Math.PI * ((width * Math.PI) / 360) ** 2 };
    }
}
