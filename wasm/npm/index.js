// The C interface of srbf in WebAssembly, with objects. README.md has an example.

import { QUARTERS, quartersOf, wordsOf } from "./words.js";

const FLOAT = 4;
const ROOM = 64; // numbers of a call's own
// Bytes of structures of srbf.h, with pointers of 32 bits.
const MATERIAL_SIZE = 128, INFO_SIZE = 64;

/** An error of the library, by its status in srbf.h. */
export class SrbfError extends Error {
    constructor(status, text) {
        super(text);
        this.name = "SrbfError";
        this.status = status;
    }
}

/** Whether the engine has simd128: a module of one instruction of it. */
function hasSimd() {
    return WebAssembly.validate(Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11));
}

async function fetched(url) {
    if (url.protocol === "file:") return (await import("node:fs/promises")).readFile(url);
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
}

/** Loads the module; `url`, `bytes` and `isSimd` choose it. */
export async function load({ url, bytes, isSimd = hasSimd() } = {}) {
    const file = isSimd ? new URL("./srbf-simd.wasm", import.meta.url) : new URL("./srbf.wasm", import.meta.url);
    const source = bytes ?? (await fetched(url ? new URL(url, import.meta.url) : file));
    const { instance } = await WebAssembly.instantiate(source, {});
    return new Srbf(instance.exports, isSimd);
}

class Srbf {
    constructor(exports, isSimd) {
        [this.exports, this.isSimd] = [exports, isSimd];
        this.room = this.allocate(ROOM * FLOAT);
    }

    /** Memory of WebAssembly. */
    allocate(size) {
        const place = this.exports.srbf_allocate(size);
        if (place === 0) throw new Error(`${size} bytes of memory are not there`);
        return place;
    }

    check(status) {
        if (status !== 0) throw new SrbfError(status, this.text(this.exports.srbf_status_text(status)));
    }

    text(place, length = null) {
        const all = new Uint8Array(this.exports.memory.buffer);
        return new TextDecoder().decode(all.slice(place, length === null ? all.indexOf(0, place) : place + length));
    }

    floats(place, count) { return new Float32Array(this.exports.memory.buffer, place, count); }

    words(place, count) { return new Uint32Array(this.exports.memory.buffer, place, count); }

    /** Three numbers of the caller, at an offset of the room. */
    vector(numbers, offset) {
        const place = this.room + offset * FLOAT;
        this.floats(place, 3).set([numbers[0], numbers[1], numbers[2]]);
        return place;
    }

    material(bytes) {
        return new Material(this, bytes instanceof ArrayBuffer ? new Uint8Array(bytes) : bytes);
    }

    sheet(bytes) {
        return new Sheet(this, bytes instanceof ArrayBuffer ? new Uint8Array(bytes) : bytes);
    }
}

/** A material in memory of WebAssembly. */
export class Material {
    constructor(srbf, bytes) {
        this.srbf = srbf;
        this.mixtures = new Set();
        this.bytes = srbf.allocate(bytes.length);
        new Uint8Array(srbf.exports.memory.buffer, this.bytes, bytes.length).set(bytes);
        this.storage = srbf.allocate(MATERIAL_SIZE);
        try {
            srbf.check(srbf.exports.srbf_material_borrow(this.bytes, bytes.length, this.storage, MATERIAL_SIZE, srbf.room));
        } catch (error) {
            this.free();
            throw error;
        }
        [this.place] = srbf.words(srbf.room, 1);
        const info = srbf.allocate(INFO_SIZE);
        srbf.check(srbf.exports.srbf_material_query(this.place, info));
        const [views, lobes, , , , size, provenance, length] = srbf.words(info, 8);
        Object.assign(this, { views, lobes, size, provenance: srbf.text(provenance, length) });
        srbf.exports.srbf_free(info);
    }

    prepare(wo, into = new Mixture(this)) {
        const { srbf } = this;
        srbf.check(srbf.exports.srbf_material_prepare(this.place, srbf.vector(wo, 0), into.place));
        return into;
    }

    evaluate(wo, wi) { return this.prepare(wo, this.own).evaluate(wi); }

    sample(wo, u) { return this.prepare(wo, this.own).sample(u); }

    /** The mixture of calls without one. */
    get own() {
        this.ownMixture ??= new Mixture(this);
        return this.ownMixture;
    }

    free() {
        for (const mixture of this.mixtures) mixture.free();
        this.srbf.exports.srbf_free(this.storage);
        this.srbf.exports.srbf_free(this.bytes);
        this.storage = this.bytes = this.place = 0;
    }
}

/** How many vectors an array holds. */
function countOf(numbers) {
    if (numbers.length % 3 !== 0) throw new Error("three numbers for each are expected");
    return numbers.length / 3;
}

/** Value and density, four numbers. */
function valueAt(srbf, place) {
    const [r, g, b, pdf] = srbf.floats(place, 4);
    return { value: [r, g, b], pdf };
}

/** A sample, seven numbers. */
function sampleAt(srbf, place) {
    const [x, y, z, pdf, r, g, b] = srbf.floats(place, 7);
    return { direction: [x, y, z], pdf, weight: [r, g, b] };
}

/** The lobes of one outgoing direction, in memory of WebAssembly. */
export class Mixture {
    constructor(material) {
        this.material = material;
        this.srbf = material.srbf;
        const size = this.srbf.exports.srbf_mixture_size(material.lobes);
        this.place = this.srbf.allocate(size);
        this.srbf.check(this.srbf.exports.srbf_mixture_init(this.place, size, this.srbf.room));
        material.mixtures.add(this);
    }

    /** Number of lobes. */
    get lobes() { return this.info(0, 1, "words")[0]; }

    /** How much is reflected, linear sRGB. */
    get albedo() { return [...this.info(9, 3, "floats")]; }

    /** Some of the words of srbf_mixture_info. */
    info(first, count, kind) {
        const { srbf } = this;
        srbf.check(srbf.exports.srbf_mixture_query(this.place, srbf.room));
        return srbf[kind](srbf.room + 4 * first, count);
    }

    evaluate(wi) {
        const { srbf } = this;
        const [value, pdf] = [srbf.room + 8 * FLOAT, srbf.room + 11 * FLOAT];
        srbf.check(srbf.exports.srbf_mixture_evaluate_and_pdf(this.place, srbf.vector(wi, 0), value, pdf));
        return valueAt(srbf, value);
    }

    sample(u) {
        const { srbf } = this;
        const sample = srbf.room + 8 * FLOAT;
        srbf.check(srbf.exports.srbf_mixture_sample(this.place, srbf.vector(u, 0), sample));
        return sampleAt(srbf, sample);
    }

    evaluateMany(directions) {
        const { srbf, place } = this;
        const n = countOf(directions), values = new Float32Array(3 * n), pdfs = new Float32Array(n);
        const { srbf_mixture_evaluate_and_pdf: call } = srbf.exports;
        const [from, to, room] = [srbf.room, srbf.room + 8 * FLOAT, srbf.floats(srbf.room, ROOM)];
        for (let i = 0; i < n; i++) {
            for (let c = 0; c < 3; c++) room[c] = directions[3 * i + c];
            srbf.check(call(place, from, to, to + 3 * FLOAT));
            for (let c = 0; c < 3; c++) values[3 * i + c] = room[8 + c];
            pdfs[i] = room[11];
        }
        return { values, pdfs };
    }

    sampleMany(numbers) {
        const { srbf, place } = this;
        const n = countOf(numbers), directions = new Float32Array(3 * n), pdfs = new Float32Array(n), weights = new Float32Array(3 * n);
        const { srbf_mixture_sample: call } = srbf.exports;
        const [from, to, room] = [srbf.room, srbf.room + 8 * FLOAT, srbf.floats(srbf.room, ROOM)];
        for (let i = 0; i < n; i++) {
            for (let c = 0; c < 3; c++) room[c] = numbers[3 * i + c];
            srbf.check(call(place, from, to));
            for (let c = 0; c < 3; c++) [directions[3 * i + c], weights[3 * i + c]] = [room[8 + c], room[12 + c]];
            pdfs[i] = room[11];
        }
        return { directions, pdfs, weights };
    }

    free() {
        this.srbf.exports.srbf_free(this.place);
        this.place = 0;
        this.material.mixtures.delete(this);
    }
}

const HEIGHTS = 16; // for which the share of draws is stored

/** The bytes of the quarters of a sheet, null for one that is black, and the shares of draws. What is checked here is all but the materials. */
function partsOf(bytes) {
    const name = "a sheet is expected";
    const words = wordsOf(bytes, name, 1, () => {}), places = quartersOf(words);
    if (!places) throw new Error(`${name}: the file holds a material`);
    const isSymmetric = words[5] === 1;
    const quarters = places.map((place) => (place > 0 ? bytes.subarray(4 * place, 4 * place + words[place + 4]) : null));
    return { quarters, isSymmetric, shares: [48, isSymmetric ? 48 : 64].map((at) => bytes.slice(at, at + HEIGHTS)) };
}

/** A thin surface: up to four materials in memory of WebAssembly, and the share of draws between them. */
export class Sheet {
    constructor(srbf, bytes) {
        const { quarters, isSymmetric, shares } = partsOf(bytes);
        Object.assign(this, { isSymmetric, shares, materials: [] });
        try {
            quarters.forEach((own, quarter) => {
                this.materials.push(isSymmetric && quarter > 1 ? this.materials[quarter - 2] : own && new Material(srbf, own));
            });
        } catch (error) {
            this.free();
            throw error;
        }
        this.quarters = Object.fromEntries(QUARTERS.map((name, n) => [name, this.materials[n]]));
    }

    /** The material of a half that an outgoing direction sees, or null. */
    half(wo, isTransmission) { return this.materials[(wo[2] < 0 ? 2 : 0) + (isTransmission ? 1 : 0)]; }

    reflectedShare(wo) {
        const [reflection, transmission] = [this.half(wo, false), this.half(wo, true)];
        if (!reflection || !transmission) return transmission ? 0 : 1;
        const codes = this.shares[wo[2] < 0 ? 1 : 0];
        const place = Math.min(Math.abs(wo[2]) * (HEIGHTS - 1), HEIGHTS - 1), below = Math.min(Math.floor(place), HEIGHTS - 2);
        return (codes[below] + (codes[below + 1] - codes[below]) * (place - below)) / 255;
    }

    /** The share of draws of a half. */
    share(wo, isTransmission) {
        const reflected = this.reflectedShare(wo);
        return isTransmission ? 1 - reflected : reflected;
    }

    evaluate(wo, wi) {
        const isTransmission = wo[2] < 0 !== wi[2] < 0;
        const found = this.half(wo, isTransmission)?.evaluate(upward(wo), upward(wi)) ?? { value: [0, 0, 0], pdf: 0 };
        return { value: found.value, pdf: found.pdf * this.share(wo, isTransmission) };
    }

    sample(wo, u) {
        const reflected = this.reflectedShare(wo), isTransmission = !(u[0] < reflected);
        const share = isTransmission ? 1 - reflected : reflected;
        const first = Math.min((isTransmission ? u[0] - reflected : u[0]) / share, 0.99999994);
        const drawn = this.half(wo, isTransmission)?.sample(upward(wo), [first, u[1], u[2]]) ?? { direction: [0, 0, 1], pdf: 0, weight: [0, 0, 0] };
        const { direction: [x, y, z], pdf, weight } = drawn;
        const direction = [x, y, wo[2] < 0 !== isTransmission ? -z : z];
        return { direction, pdf: pdf * share, weight: weight.map((v) => v / share) };
    }

    albedos(wo) {
        const of = (isTransmission) => {
            const material = this.half(wo, isTransmission);
            return material ? material.prepare(upward(wo), material.own).albedo : [0, 0, 0];
        };
        return { reflected: of(false), transmitted: of(true) };
    }

    free() {
        new Set(this.materials).forEach((material) => material?.free());
        this.materials = [];
    }
}

/** A direction as a quarter has it. */
const upward = ([x, y, z]) => [x, y, Math.abs(z)];
