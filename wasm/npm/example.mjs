import { readFile } from "node:fs/promises";
import { load } from "srbf-wasm";

const srbf = await load();
const material = srbf.material(await readFile(new URL("garnet_red.srbf", import.meta.resolve("srbf-wasm"))));
const mixture = material.prepare([-0.6, 0, 0.8]);
const { direction, pdf, weight } = mixture.sample([0.3, 0.6, 0.9]);
const { value, pdf: density } = mixture.evaluate([0, 0.6, 0.8]);
console.log({ direction, pdf, weight, value, density });
material.free();
