// Times of the npm package: node time.mjs MATERIAL, in a folder where srbf-wasm is installed. The least of nine runs, ns a call or direction.

import { readFile } from "node:fs/promises";
import { load } from "srbf-wasm";

const COUNT = 4096, RUNS = 9;
const bytes = await readFile(process.argv[2]);
const directions = Float32Array.from({ length: COUNT }, (_, i) => i).reduce((all, i) => {
    const [z, turn] = [1 - (0.98 * (i + 0.5)) / COUNT, 2.399963 * i];
    const across = Math.sqrt(1 - z * z);
    all.set([across * Math.cos(turn), across * Math.sin(turn), z], 3 * i);
    return all;
}, new Float32Array(3 * COUNT));

function least(call) {
    let best = Infinity;
    for (let run = 0; run < RUNS; run++) {
        const start = performance.now();
        call();
        best = Math.min(best, ((performance.now() - start) * 1e6) / COUNT);
    }
    return best.toFixed(0);
}

for (const isSimd of [false, true]) {
    const srbf = await load({ isSimd });
    const material = srbf.material(bytes);
    const mixture = material.prepare([-0.6, 0, 0.8]);
    const at = (i) => directions.subarray(3 * i, 3 * i + 3);
    const each = (call) => least(() => { for (let i = 0; i < COUNT; i++) call(i); });
    const times = {
        prepare: each((i) => material.prepare(at(i), mixture)),
        evaluate: each((i) => mixture.evaluate(at(i))),
        sample: each((i) => mixture.sample([(i + 0.5) / COUNT, 0.3, 0.6])),
        "many, a direction": least(() => mixture.evaluateMany(directions)),
    };
    console.log(`${isSimd ? "simd128" : "scalar"}: ${Object.entries(times).map(([name, time]) => `${name} ${time} ns`).join(", ")}`);
}
