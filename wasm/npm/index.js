// The C interface of srbf in WebAssembly, with objects. README.md has an example.

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
