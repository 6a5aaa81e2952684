// Answers of the npm package to many pairs of directions, by the protocol of evaluator/examples/reference.rs, for lab/differential.py.
//
//     node rows.mjs scalar|simd128 FILE.srbf < in > out
//
// Run in a folder where srbf-wasm is installed.

import { readFileSync, writeSync } from "node:fs";
import { load } from "srbf-wasm";

const [level, file] = process.argv.slice(2);
const input = readFileSync(0), bytes = readFileSync(file);
const given = new Float32Array(new Uint8Array(input).buffer);
const n = given.length / 9, answers = new Float32Array(14 * n);
const srbf = await load({ isSimd: level === "simd128" });
const isSheet = bytes[12] === 2;
const surface = isSheet ? srbf.sheet(bytes) : srbf.material(bytes);
const vector = (first, i) => [0, 1, 2].map((c) => given[(first + c) * n + i]);
let mixture;
for (let i = 0; i < n; i++) {
    const [wo, wi, u] = [vector(0, i), vector(3, i), vector(6, i)];
    let at, drawn, albedo;
    if (isSheet) {
        const { reflected, transmitted } = surface.albedos(wo);
        [at, drawn, albedo] = [surface.evaluate(wo, wi), surface.sample(wo, u), wo[2] < 0 === wi[2] < 0 ? reflected : transmitted];
    } else {
        mixture = surface.prepare(wo, mixture);
        [at, drawn, albedo] = [mixture.evaluate(wi), mixture.sample(u), mixture.albedo];
    }
    [...at.value, at.pdf, ...drawn.direction, drawn.pdf, ...drawn.weight, ...albedo].forEach((v, row) => { answers[row * n + i] = v; });
}
const out = new Uint8Array(answers.buffer);
for (let sent = 0; sent < out.length;) sent += writeSync(1, out, sent);
