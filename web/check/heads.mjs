// Files are looked at before they are read or copied, by the page and by the package for three.js: node heads.mjs
//
// Needs no browser. Says the result as `cargo test` does, for fuzz/plant.

import { copyFileSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { runInNewContext } from "node:vm";

const root = join(dirname(fileURLToPath(import.meta.url)), "..", "..");
const preset = new Uint8Array(readFileSync(join(root, "presets", "cayman.srbf")));
const GIGABYTE = 2 ** 30, LITTLE = 4096;

// As modules: in the page they are one script.
const place = mkdtempSync(join(tmpdir(), "srbf-heads-"));
process.on("exit", () => rmSync(place, { recursive: true, force: true }));
for (const name of readdirSync(join(root, "web", "page")).filter((name) => name.endsWith(".js"))) copyFileSync(join(root, "web", "page", name), join(place, name));
writeFileSync(join(place, "package.json"), `{ "type": "module" }`);
globalThis.self = globalThis;
const { lobesOf, looked, opened } = await import(pathToFileURL(join(place, "opener.js")));
const { quartersOf, received, wordsOf } = await import(pathToFileURL(join(place, "words.js")));
const { radiance } = await import(pathToFileURL(join(place, "radiance.js")));

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
const flat = radiance(pixels, "flat");
expectThat([0.5, 0, 0, 1, 1, 1, 1, 1].every((v, n) => flat.numbers[n] === v), `pixels are numbers: ${flat.numbers}`);
const oldRuns = fileOf(4, 1, [...red0, 1, 1, 1, 2, ...grey]);
const repeated = radiance(oldRuns, "repeated");
expectThat([0, 4, 8, 12].every((at, n) => repeated.numbers[at] === [0.5, 0.5, 0.5, 1][n]), "old runs repeat a pixel");
const runs = fileOf(8, 1, [2, 2, 0, 8, 128 + 8, 128, 4, 1, 2, 3, 4, 128 + 4, 9, 128 + 8, 0, 128 + 8, 129]);
expectThat(radiance(runs, "runs").numbers[4 * 2 + 1] === 3 / 256, "new runs are of one channel");
let sentences = 0;
const damaged = (bytes) => {
    try {
        const { width, height, numbers } = radiance(bytes, "damaged.hdr");
        return numbers.length === 4 * width * height;
    } catch (error) {
        sentences += 1;
        return error.constructor === Error && error.message.startsWith("damaged.hdr: ");
    }
};
let isSound = true, seed = 1;
const executions = Number(process.env.SRBF_FUZZ ?? 10000);
const some = (n) => (seed = (seed * 48271) % 2147483647) % n;
for (const kind of [pixels, oldRuns, runs]) {
    for (let n = 0; n <= kind.length; n++) isSound &&= damaged(kind.slice(0, n));
    for (let n = 0; n < executions; n++) isSound &&= damaged(kind.map((byte) => (some(kind.length) < 4 ? some(256) : byte)));
}
for (const [width, height] of [[0, 4], [16384, 16384], [99999, 1], [1e9, 1e9], [4, 16384]]) isSound &&= damaged(fileOf(width, height, [0, 0, 0, 0]));
for (const text of ["", "#?", "v/1\x01", `#?${"a".repeat(1 << 15)}`, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"]) isSound &&= damaged(new TextEncoder().encode(text));
expectThat(isSound && sentences > 1000, `damaged pictures are refused in a sentence (${sentences})`);

console.log(failed === 0 ? `test result: ok. ${passed} passed` : `error: test failed, ${failed} of ${passed + failed}`);
process.exit(failed === 0 ? 0 : 1);
