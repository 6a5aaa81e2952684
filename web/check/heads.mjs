// Files are looked at before they are read or copied, by the page and by the package for three.js: node heads.mjs
//
// Needs no browser. Says the result as `cargo test` does, for fuzz/plant.

import { readFileSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { runInNewContext } from "node:vm";
import { script } from "./modules.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "..", "..");
const preset = new Uint8Array(readFileSync(join(root, "presets", "cayman.srbf")));
const GIGABYTE = 2 ** 30, LITTLE = 4096;

globalThis.self = globalThis;
const { lobesOf, looked, opened } = await script("opener.js");
const { quartersOf, received, wordsOf } = await script("words.js");
const { lightOf } = await script("exr.js");

// The worker of the page, with a fitter that gives the file back.
const memory = { buffer: new ArrayBuffer(1 << 16) };
let [end, name, file] = [64, [], []]; // the next block; those of a call
const fitter = {
    memory,
    fitter_allocate: (size) => (end += size) - size,
    fitter_open: (...blocks) => { [name, file] = [blocks.slice(0, 2), blocks.slice(2)]; return 0; },
    fitter_answer: (part) => (part === 0 ? file[0] : 0),
    fitter_answer_size: (part) => (part === 0 ? file[1] : 2),
};
new Uint8Array(memory.buffer).set(new TextEncoder().encode("{}"));
globalThis.Worker = class {
    constructor(url) {
        const own = { postMessage: (data) => this.onmessage({ data }) };
        const inside = { self: own, performance, Blob, TextEncoder, TextDecoder, Uint8Array, WebAssembly: { instantiate: async () => ({ exports: fitter }), RuntimeError: Error } };
        this.ready = fetch(url).then((answer) => answer.text()).then((text) => { runInNewContext(text, inside); return own; });
    }
    postMessage(data) { this.ready.then((own) => own.onmessage({ data })); }
    terminate() {}
};
// fetch has a module of its own, which it compiles when it is first called.
await fetch("data:,");
WebAssembly.compile = async () => "a module";

let [passed, failed] = [0, 0];
function expectThat(holds, what) {
    if (!holds) console.log(`FAILS: ${what}`);
    if (holds) passed += 1;
    else failed += 1;
}

/** The bytes at the beginning of a file of a size; zeros follow. Counts the bytes that are taken of it. */
class Counted {
    constructor(name, start, size = start.length) {
        Object.assign(this, { name, start, size, taken: 0, isWhole: false });
    }
    part(from, to) {
        const end = Math.min(to, this.size), bytes = new Uint8Array(Math.max(end - from, 0));
        this.taken += bytes.length;
        bytes.set(this.start.subarray(from, end));
        return bytes;
    }
    slice(from, to) { return { arrayBuffer: async () => this.part(from, to).buffer }; }
    async arrayBuffer() {
        this.isWhole = true;
        if (this.size > 2 ** 28) {
            this.taken += this.size;
            throw new Error("all of it is read");
        }
        return this.part(0, this.size).buffer;
    }
    stream() {
        let at = 0;
        return new ReadableStream({ pull: (to) => {
            if (at >= this.size) return to.close();
            to.enqueue(this.part(at, at + 1000));
            at += 1000;
        } });
    }
}

/** A material's bytes that announce another length. */
function announcing(length) {
    const bytes = preset.slice();
    new DataView(bytes.buffer).setUint32(16, length, true);
    return bytes;
}

const says = (error, words) => words.every((word) => error.includes(word));
const message = (promise) => promise.then(() => "", (error) => error.message);
/** As the page does it. */
const open = async (file) => { await looked(file); return opened(file, () => {}).answer; };

async function refused(file, words) {
    const error = await message(open(file));
    expectThat(says(error, words) && file.taken <= LITTLE, `${file.name} of ${file.size} bytes: ${file.taken} are taken, "${error}"`);
}

async function ofThePage() {
    for (const hasFitter of [false, true]) {
        self.srbfFitter = hasFitter ? "AA==" : undefined;
        const most = hasFitter ? `at most ${2 ** 28} bytes` : "a .srbf file is expected";
        await refused(new Counted("zeros.csv", new Uint8Array(0), GIGABYTE), ["zeros.csv", most]);
        await refused(new Counted("text.csv", new TextEncoder().encode("theta_i,".repeat(600)), GIGABYTE), ["text.csv", most]);
        await refused(new Counted("longer.srbf", preset, GIGABYTE), ["longer.srbf", `${preset.length} bytes`, `${GIGABYTE} are there`]);
        await refused(new Counted("large.srbf", announcing(GIGABYTE), GIGABYTE), ["large.srbf", `${2 ** 26} bytes`, `${GIGABYTE} are announced`]);
        await refused(new Counted("cut.srbf", preset.subarray(0, 12)), ["cut.srbf", "a .srbf file of"]);
    }
    await refused(new Counted("other.bin", preset.subarray(4), 2 ** 27), ["other.bin", "is 0"]);

    self.srbfFitter = undefined;
    const own = new Counted("cayman.srbf", preset);
    const { bytes, json } = await open(own);
    expectThat(Buffer.compare(bytes, preset) === 0 && json.name === "cayman" && own.taken <= LITTLE + preset.length, `a material is opened: ${own.taken} bytes are taken`);
}

async function ofTheWorker() {
    end = 64;
    self.srbfFitter = "AA==";
    const rows = new TextEncoder().encode("theta_i,phi_i,theta_o,phi_o,value\n".repeat(300));
    for (const [title, start] of [["rows.csv", rows], ["16-bits.csv", new Uint8Array(Buffer.from("theta_i,1\n".repeat(500), "utf16le"))], ["table.bsdf", new TextEncoder().encode("tensor_file\0\0\0")]]) {
        const file = new Counted(title, start);
        const { bytes } = await open(file);
        const given = new TextDecoder().decode(new Uint8Array(memory.buffer, ...name));
        expectThat(given === title && Buffer.compare(bytes, start) === 0, `the fitter gets ${title} whole: ${given}, ${bytes.length} bytes`);
        expectThat(file.taken <= LITTLE + start.length && !file.isWhole, `${title} is taken once, part by part: ${file.taken} bytes`);
    }
}

/** An answer to a request, in parts of a size. */
function answered(file, size) {
    let at = 0;
    return { body: new ReadableStream({ pull: (to) => {
        if (at >= file.size) return to.close();
        to.enqueue(file.part(at, at + size));
        at += size;
    } }) };
}

async function ofThePackage() {
    const before = process.memoryUsage().arrayBuffers, large = new Uint8Array(GIGABYTE);
    const attempt = (data) => { try { wordsOf(data, "it", 1024); return ""; } catch (error) { return error.message; } };
    expectThat(says(attempt(large), ["it: ", `to ${2 ** 26} bytes`]), "zeros are no material");
    large.set(preset);
    expectThat(says(attempt(large), [`${preset.length} bytes`, `${GIGABYTE} are there`]), "a longer file is refused");
    large.set(announcing(GIGABYTE));
    expectThat(says(attempt(large), [`${2 ** 26} bytes`, `${GIGABYTE} are announced`]), "a large file is refused");
    const copied = process.memoryUsage().arrayBuffers - before - GIGABYTE;
    expectThat(copied < 1e6, `nothing is copied of a gigabyte: ${copied} bytes`);

    for (const size of [1, 19, 47, 1000, preset.length]) {
        const bytes = await received(answered(new Counted("it", preset), size), "it");
        expectThat(Buffer.compare(bytes, preset) === 0, `parts of ${size} bytes are put together`);
    }
    for (const [start, words] of [
        [new Uint8Array(0), ["it: a .srbf file", `to ${2 ** 26} bytes`]],
        [preset, [`${preset.length} bytes are expected, more are there`]],
        [announcing(GIGABYTE), [`${GIGABYTE} are announced`]],
    ]) {
        // Large, but such as memory holds where all of it is taken.
        const file = new Counted("it", start, GIGABYTE / 8);
        const error = await message(received(answered(file, LITTLE), "it"));
        expectThat(says(error, words) && file.taken <= 4 * LITTLE, `a large answer: ${file.taken} bytes are taken, "${error}"`);
    }
    expectThat(says(await message(received(answered(new Counted("it", preset.subarray(0, 9)), 4), "it")), ["it: a .srbf file"]), "a short answer is refused");
}

/** Sheets are checked, and their quarters found. */
async function ofSheets() {
    const glass = new Uint8Array(readFileSync(join(root, "presets", "sheets", "ground_glass.srbf")));
    const words = wordsOf(glass, "glass", 1024), quarters = quartersOf(words);
    expectThat(quarters.map((at) => at > 0 && words[at] === words[0]).join() === "true,true,false,true", `quarters at ${quarters}`);
    expectThat(quartersOf(wordsOf(preset, "it", 1024)) === null, "a material has no quarters");
    const attempt = (change) => {
        const bytes = glass.slice();
        change(new DataView(bytes.buffer));
        try { wordsOf(bytes, "it", 1024); return ""; } catch (error) { return error.message; }
    };
    for (const [at, value, expected] of [[20, 7, "head of a sheet"], [40, 0, "shares"], [84, 1e9, "longer"], [80, 0x41424344, "unknown"], [48, 0, "a share"], [200, 1, "it"]]) {
        const error = attempt((view) => view.setUint32(at, value, true));
        expectThat(says(error, ["it", expected]), `word ${at / 4} is refused: "${error}"`);
    }
}

for (const part of [ofThePage, ofSheets, ofTheWorker, ofThePackage]) {
    // A fault of the code is no failure of a test.
    await part().catch((error) => { console.log(error.stack); process.exit(3); });
}
// A mirrored lobe stands for two.
const red = new Uint8Array(readFileSync(join(root, "presets", "garnet_red.srbf")));
expectThat(lobesOf(wordsOf(red, "red", 1024)) === 12, "mirrored lobes are counted");

// Pictures of light: rows as they are, and by runs of both kinds; then any damage, which gives a sentence or a picture, never another fault.
const headOf = (width, height) => new TextEncoder().encode(`#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
const fileOf = (width, height, rows) => Uint8Array.from([...headOf(width, height), ...rows]);
const [red0, grey] = [[128, 0, 0, 129], [128, 128, 128, 130]];
const pixels = fileOf(2, 2, [...red0, ...grey, ...grey, ...red0]);
const flat = await lightOf(pixels, "flat");
expectThat([0.5, 0, 0, 1, 1, 1, 1, 1].every((v, n) => flat.numbers[n] === v), `pixels are numbers: ${flat.numbers}`);
const oldRuns = fileOf(4, 1, [...red0, 1, 1, 1, 2, ...grey]);
const repeated = await lightOf(oldRuns, "repeated");
expectThat([0, 4, 8, 12].every((at, n) => repeated.numbers[at] === [0.5, 0.5, 0.5, 1][n]), "old runs repeat a pixel");
const runs = fileOf(8, 1, [2, 2, 0, 8, 128 + 8, 128, 4, 1, 2, 3, 4, 128 + 4, 9, 128 + 8, 0, 128 + 8, 129]);
expectThat((await lightOf(runs, "runs")).numbers[4 * 2 + 1] === 3 / 256, "new runs are of one channel");

/** The number that a picture of `fuzz/seeds` has in a channel, as `tests/src/bin/seeds.rs` makes it. */
function seeded(title, x, y, c) {
    if (title !== "many-values") return [Math.fround(x / 3), y / 4 + x / 16, (x * y) % 32][c];
    const bits = 640 * y + x, power = bits >> 10, rest = (bits & 1023) / 1024;
    return power ? (1 + rest) * 2 ** (power - 15) : rest * 2 ** -14;
}
const folder = join(root, "fuzz", "seeds", "scene-exr"), seeds = new Map(readdirSync(folder).map((title) => [title, new Uint8Array(readFileSync(join(folder, title)))]));
for (const [title, size] of [["none", "5 x 3"], ["tiles", "19 x 34"], ["rows", "19 x 34"], ["zip", "40 x 20"], ["wavelets", "19 x 34"], ["many-values", "640 x 32"]]) {
    const { width, height, numbers } = await lightOf(seeds.get(title), title);
    const wrong = numbers.findIndex((v, n) => v !== ((n & 3) === 3 ? 1 : seeded(title, (n >> 2) % width, Math.floor((n >> 2) / width), n & 3)));
    expectThat(`${width} x ${height}` === size && wrong < 0, `${title} is read: ${width} x ${height}, number ${wrong} is ${numbers[wrong]}`);
}

/** A seed after a change of its bytes behind a text of its head. */
function changed(title, text, change) {
    const bytes = seeds.get(title).slice(), at = Buffer.from(bytes).indexOf(text, "latin1") + text.length;
    change(new DataView(bytes.buffer, at), bytes);
    return bytes;
}
const WINDOW = "dataWindow\0box2i\0\x10\0\0\0", KIND = "compression\0compression\0\x01\0\0\0", PLACES = "chlist\0";
for (const [bytes, words] of [
    [seeds.get("losses"), ["PXR24 is there", "oiiotool"]],
    [changed("zip", KIND, (view) => view.setUint8(0, 99)), ["99 is there"]],
    [changed("zip", WINDOW, (view) => view.setInt32(8, 16384, true)), ["16385 x 20"]],
    [changed("zip", WINDOW, (view) => view.setInt32(8, 16383, true)), ["16384 x 20", "too few"]],
    [changed("zip", WINDOW, (view) => view.setInt32(8, -1, true)), ["0 x 20"]],
    [changed("none", PLACES, (view) => view.setUint8(4, 81)), ["R, G and B, or Y", "Q, G, R are there"]],
    [changed("none", PLACES, (view) => view.setInt32(18, 2, true)), ["fewer samples"]],
    [changed("none", "", (view) => view.setUint32(4, 0x1002, true)), ["one part"]],
    [changed("none", "", (view) => view.setUint32(4, 1, true)), ["version 2"]],
    [changed("none", "", (view, all) => view.setUint32(all.length - 4, 0x7f800000, true)), ["column 4, row 2", "Infinity"]],
    [changed("none", "", (view, all) => view.setFloat32(all.length - 4, -0.5, true)), ["column 4, row 2", "-0.5"]],
    [seeds.get("none").subarray(0, -1), ["ends within block 2 of 3"]],
]) {
    const error = await message(lightOf(bytes, "it"));
    expectThat(says(error, ["it: ", ...words]), `a picture is refused: "${error}", not "${words.join()}"`);
}
const below = await lightOf(changed("none", "", (view, all) => view.setFloat32(all.length - 4, -0.01, true)), "below");
expectThat(below.numbers[4 * 14] === 0, "a value a little below 0 is 0");

let sentences = 0;
const damaged = async (bytes) => {
    try {
        const { width, height, numbers } = await lightOf(bytes, "damaged");
        return numbers.length === 4 * width * height;
    } catch (error) {
        sentences += 1;
        return error.constructor === Error && error.message.startsWith("damaged: ");
    }
};
let isSound = true, seed = 1;
const executions = Number(process.env.SRBF_FUZZ ?? 10000);
const some = (n) => (seed = (seed * 48271) % 2147483647) % n;
for (const kind of [pixels, oldRuns, runs]) {
    for (let n = 0; n <= kind.length; n++) isSound &&= await damaged(kind.slice(0, n));
    for (let n = 0; n < executions; n++) isSound &&= await damaged(kind.map((byte) => (some(kind.length) < 4 ? some(256) : byte)));
}
for (const [width, height] of [[0, 4], [16384, 16384], [99999, 1], [1e9, 1e9], [4, 16384]]) isSound &&= await damaged(fileOf(width, height, [0, 0, 0, 0]));
for (const text of ["", "#?", "v/1\x01", `#?${"a".repeat(1 << 15)}`, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"]) isSound &&= await damaged(Uint8Array.from(text, (letter) => letter.charCodeAt(0)));
expectThat(isSound && sentences > 1000, `damaged pictures of Radiance are refused in a sentence (${sentences})`);
for (const [title, bytes] of seeds) {
    sentences = 0;
    for (let n = 0; n < 100; n++) isSound &&= await damaged(bytes.subarray(0, some(bytes.length)));
    expectThat(isSound && sentences === 100, `${title} in part is refused in a sentence (${sentences})`);
    for (let n = 0; n < executions / 50; n++) {
        const other = bytes.slice();
        for (let k = 0; k <= n % 4; k++) other[some(bytes.length)] = some(256);
        isSound &&= await damaged(other);
    }
    expectThat(isSound, `${title} with damage is refused in a sentence, or read`);
}

console.log(failed === 0 ? `test result: ok. ${passed} passed` : `error: test failed, ${failed} of ${passed + failed}`);
process.exit(failed === 0 ? 0 : 1);
