// Values, densities and draws of the npm package beside those of the library on this machine: node values.mjs REFERENCE MATERIAL...
//
// REFERENCE is the program `reference` of srbf-evaluator's examples. Run in a folder where srbf-wasm is installed.

import { spawnSync } from "node:child_process";
import { readFile } from "node:fs/promises";
import { SrbfError, load } from "srbf-wasm";

const [reference, ...materials] = process.argv.slice(2);
const PAIRS = 2048;
// Bounds of isotropic materials; lab/differential.py has those of others. Of values and weights relative to their largest channel, or to
// density times power, where that is larger; of densities relative.
const BOUND = { value: 5e-6, density: 5e-6, direction: 3e-6, weight: 5e-5, albedo: 2e-6 };

let state = 12345;
function random() {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state >>> 8) / 16777216;
}

function direction() {
    const [z, turn] = [0.02 + 0.98 * random(), 2 * Math.PI * random()];
    const across = Math.sqrt(1 - z * z);
    return [across * Math.cos(turn), across * Math.sin(turn), z];
}

/** The rows of the library. */
function expected(file, pairs) {
    const rows = new Float32Array(9 * PAIRS);
    pairs.forEach(({ wo, wi, u }, i) => [...wo, ...wi, ...u].forEach((v, row) => { rows[row * PAIRS + i] = v; }));
    const run = spawnSync(reference, [file], { input: new Uint8Array(rows.buffer), maxBuffer: 1 << 26 });
    if (run.status !== 0) throw new Error(`${reference} ${file}: ${run.stderr}`);
    const out = new Float32Array(new Uint8Array(run.stdout).buffer);
    const numbers = (i, first, count) => Array.from({ length: count }, (_, c) => out[(first + c) * PAIRS + i]);
    return pairs.map((_, i) => ({ value: numbers(i, 0, 3), pdf: out[3 * PAIRS + i], direction: numbers(i, 4, 3), drawnPdf: out[7 * PAIRS + i], weight: numbers(i, 8, 3), albedo: numbers(i, 11, 3) }));
}

const far = (a, b) => Math.max(...a.map((v, i) => Math.abs(v - b[i])));
const most = (a) => Math.max(...a.map(Math.abs), 1e-30);
let isRight = true;
const expectThat = (holds, what) => {
    if (!holds) console.log(`FAILS: ${what}`);
    isRight &&= holds;
};

/** A sheet, with viewers and lights on both sides. */
function sheet(srbf, file, bytes, pairs) {
    pairs.forEach(({ wo, wi }, i) => {
        wo[2] *= i & 1 ? -1 : 1;
        wi[2] *= i & 2 ? -1 : 1;
    });
    const others = expected(file, pairs), own = srbf.sheet(bytes);
    const worst = { value: 0, density: 0, direction: 0, weight: 0, albedo: 0 };
    const note = (name, error) => { worst[name] = Math.max(worst[name], Number.isFinite(error) ? error : Infinity); };
    pairs.forEach(({ wo, wi, u }, i) => {
        const other = others[i], found = own.evaluate(wo, wi), drawn = own.sample(wo, u), { reflected, transmitted } = own.albedos(wo);
        const power = [reflected, transmitted].reduce((sum, [r, g, b]) => sum + 0.2126 * r + 0.7152 * g + 0.0722 * b, 0);
        note("value", far(found.value, other.value) / Math.max(most(other.value), other.pdf * power));
        note("density", other.pdf === 0 ? found.pdf : Math.abs(found.pdf / other.pdf - 1));
        note("direction", far(drawn.direction, other.direction));
        note("weight", far(drawn.weight, other.weight) / most(other.weight));
        note("albedo", far(wo[2] < 0 === wi[2] < 0 ? reflected : transmitted, other.albedo) / Math.max(most(other.albedo), 1e-3));
    });
    const text = Object.entries(worst).map(([name, error]) => `${name} ${error.toExponential(1)}`).join(", ");
    console.log(`  ${file.split("/").pop()}, a sheet: worst of ${PAIRS} pairs: ${text}`);
    for (const [name, error] of Object.entries(worst)) expectThat(error <= BOUND[name], `${file}: ${name} ${error}`);
    for (const broken of [bytes.subarray(0, 100), bytes.map((byte, at) => (at === 60 ? byte ^ 1 : byte))]) {
        try {
            srbf.sheet(broken);
            expectThat(false, "a damaged sheet is refused");
        } catch (error) {
            expectThat(error.message.startsWith("a sheet is expected"), error.message);
        }
    }
    own.free();
}

for (const isSimd of [false, true]) {
    const srbf = await load({ isSimd });
    console.log(`${isSimd ? "simd128" : "scalar"}: ${WebAssembly.Module.imports(new WebAssembly.Module(await readFile(new URL(isSimd ? "srbf-simd.wasm" : "srbf.wasm", import.meta.resolve("srbf-wasm"))))).length} imports`);
    for (const file of materials) {
        const pairs = Array.from({ length: PAIRS }, () => ({ wo: direction(), wi: direction(), u: [random(), random(), random()] }));
        if ((await readFile(file))[12] === 2) {
            sheet(srbf, file, await readFile(file), pairs);
            continue;
        }
        const others = expected(file, pairs);
        const bytes = await readFile(file);
        const material = srbf.material(bytes);
        const worst = { value: 0, density: 0, direction: 0, weight: 0, albedo: 0 };
        const note = (name, error) => { worst[name] = Math.max(worst[name], Number.isFinite(error) ? error : Infinity); };
        let mixture;
        pairs.forEach(({ wo, wi, u }, i) => {
            mixture = material.prepare(wo, mixture);
            const other = others[i];
            const found = mixture.evaluate(wi), drawn = mixture.sample(u), { albedo } = mixture;
            const power = 0.2126 * albedo[0] + 0.7152 * albedo[1] + 0.0722 * albedo[2];
            note("value", far(found.value, other.value) / Math.max(most(other.value), other.pdf * power));
            note("density", Math.abs(found.pdf / other.pdf - 1));
            note("direction", far(drawn.direction, other.direction));
            note("weight", far(drawn.weight, other.weight) / most(other.weight));
            note("albedo", far(albedo, other.albedo) / most(other.albedo));
            const alone = material.evaluate(wo, wi);
            note("value", far(alone.value, other.value) / Math.max(most(other.value), other.pdf * power));
            note("direction", far(material.sample(wo, u).direction, other.direction));
        });
        // Many at once are as each of them.
        const { wo } = pairs[0];
        material.prepare(wo, mixture);
        const many = mixture.evaluateMany(Float32Array.from(pairs.flatMap((pair) => pair.wi)));
        const draws = mixture.sampleMany(Float32Array.from(pairs.flatMap((pair) => pair.u)));
        pairs.forEach(({ wi, u }, i) => {
            const [one, drawn] = [mixture.evaluate(wi), mixture.sample(u)];
            note("value", far([...many.values.subarray(3 * i, 3 * i + 3)], one.value) / Math.max(most(one.value), one.pdf));
            note("density", Math.abs(many.pdfs[i] / one.pdf - 1));
            note("direction", far([...draws.directions.subarray(3 * i, 3 * i + 3)], drawn.direction));
            note("weight", far([...draws.weights.subarray(3 * i, 3 * i + 3)], drawn.weight) / most(drawn.weight));
        });
        const text = Object.entries(worst).map(([name, error]) => `${name} ${error.toExponential(1)}`).join(", ");
        console.log(`  ${file.split("/").pop()}: worst of ${PAIRS} pairs: ${text}`);
        for (const [name, error] of Object.entries(worst)) expectThat(error <= BOUND[name], `${file}: ${name} ${error}`);
        material.free();
    }
    // Faults are named, and memory is given back.
    const bytes = new Uint8Array(await readFile(materials[0]));
    const refused = (call, word) => {
        try {
            call();
            expectThat(false, `no error that says ${word}`);
        } catch (error) {
            expectThat(error instanceof SrbfError && error.message.includes(word), `${error} names ${word}`);
        }
    };
    refused(() => srbf.material(bytes.with(100, bytes[100] ^ 1)), "damaged");
    refused(() => srbf.material(bytes.slice(0, 100)), "length");
    refused(() => srbf.material(new Uint8Array(3)), ".srbf");
    const material = srbf.material(bytes);
    refused(() => material.prepare([0, 0, 2]), "unit vector");
    refused(() => material.sample([0, 0, 1], [1, 0, 0]), "uniform");
    material.free();
    const before = srbf.exports.memory.buffer.byteLength;
    for (let i = 0; i < 2000; i++) {
        const again = srbf.material(bytes);
        again.prepare([0, 0, 1]);
        again.free();
    }
    expectThat(srbf.exports.memory.buffer.byteLength === before, "memory is given back");
}
process.exit(isRight ? 0 : 1);
