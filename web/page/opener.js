// Files that are opened: materials at once, measurements by the fitter, in a worker that can be ended.
import { decoded } from "./tree.js";
import { QUARTERS, checkHead, quartersOf, wordsOf } from "./words.js";

const FIRST_BYTES = [0x89, 0x53, 0x52, 0x42, 0x46];

// First bytes of measurements that are no text: RGL, MERL.
const BINARY = [[..."tensor_file"].map((c) => c.charCodeAt(0)), [90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0]];

const LOOKED_AT = 4096; // bytes of a file that are looked at before it is read
const MOST_MEASURED = 1 << 28; // bytes of a measurement; a MERL file has an eighth of it

/** Whether `srbf view` answers questions: the page is its own. */
const hasServer = () => self.srbfServer === true;

/** Whether the page has a fitter beside it, or a program that fits. */
export const hasFitter = () => hasServer() || typeof self.srbfFitter === "string";

let compiled = null;
function module() {
    compiled ??= WebAssembly.compile(decoded(self.srbfFitter));
    return compiled;
}

/** The text of the worker. It runs by itself, and sees nothing of the page. */
function work() {
    let fitter = null;
    const put = (bytes) => {
        const place = fitter.fitter_allocate(bytes.length);
        new Uint8Array(fitter.memory.buffer, place, bytes.length).set(bytes);
        return [place, bytes.length];
    };
    // Part by part, so that the whole is in memory once.
    const take = async (file) => {
        const place = fitter.fitter_allocate(file.size), reader = file.stream().getReader();
        let count = 0;
        for (;;) {
            const { done, value } = await reader.read();
            if (done) break;
            if (count + value.length > file.size) throw new Error("the file has changed");
            new Uint8Array(fitter.memory.buffer, place + count, value.length).set(value);
            count += value.length;
        }
        return [place, file.size];
    };
    const part = (n) => new Uint8Array(fitter.memory.buffer, fitter.fitter_answer(n), fitter.fitter_answer_size(n)).slice();
    self.onmessage = async ({ data }) => {
        try {
            let told = 0;
            const progress = (share) => {
                const now = performance.now();
                if (now - told > 60 || share >= 1) {
                    told = now;
                    self.postMessage({ share });
                }
            };
            fitter ??= (await WebAssembly.instantiate(data.module, { srbf: { progress } })).exports;
            const text = (value) => new TextEncoder().encode(value);
            const failed = data.format === undefined
                ? fitter.fitter_open(...put(text(data.file.name)), ...(await take(data.file)))
                : fitter.fitter_export(...put(text(data.format)), ...put(data.bytes));
            const answer = new TextDecoder().decode(part(1));
            if (failed) throw new Error(answer);
            const bytes = part(0);
            self.postMessage({ bytes, text: answer }, [bytes.buffer]);
        } catch (error) {
            const reason = error instanceof WebAssembly.RuntimeError ? `the fitter stopped at a fault of its own (${error.message})` : error.message;
            self.postMessage({ error: reason });
        }
    };
}

/** A question to `srbf view`: lines with the share that is done, one with the length of a text or with an error, the text, and bytes. */
function askServer({ file, bytes, format }, onShare) {
    const aborter = new AbortController();
    const path = file ? `open?${encodeURIComponent(file.name)}` : `export?${encodeURIComponent(format)}`;
    const answered = async () => {
        const response = await fetch(path, { method: "POST", body: file ?? bytes, signal: aborter.signal });
        if (!response.ok) throw new Error((await response.text()).trim());
        const reader = response.body.getReader();
        let all = new Uint8Array(0);
        for (let length = null; ;) {
            const { done, value } = await reader.read();
            if (!done) {
                const joined = new Uint8Array(all.length + value.length);
                joined.set(all);
                joined.set(value, all.length);
                all = joined;
            }
            for (let end = all.indexOf(10); length === null && end >= 0; end = all.indexOf(10)) {
                const [word, ...rest] = new TextDecoder().decode(all.subarray(0, end)).split(" ");
                all = all.slice(end + 1);
                if (word === "share") onShare(Number(rest[0]));
                else if (word === "done") length = Number(rest[0]);
                else throw new Error(rest.join(" "));
            }
            if (done && length === null) throw new Error("srbf view gave no answer");
            if (done) return { text: new TextDecoder().decode(all.subarray(0, length)), bytes: all.slice(length) };
        }
    };
    const answer = answered().catch((error) => { throw aborter.signal.aborted ? new Error("cancelled") : error; });
    return { answer, end: () => aborter.abort() };
}

/** A question to the fitter: the answer, and a way to end it. */
function ask(question, onShare = () => {}) {
    if (hasServer()) return askServer(question, onShare);
    let worker = null, end = () => {};
    const answer = new Promise((resolve, reject) => {
        end = () => {
            worker?.terminate();
            reject(new Error("cancelled"));
        };
        module().then((compiledModule) => {
            const url = URL.createObjectURL(new Blob([`(${work})()`], { type: "text/javascript" }));
            worker = new Worker(url);
            worker.onerror = (event) => reject(new Error(event.message || "the worker did not start"));
            worker.onmessage = ({ data }) => {
                if (data.share !== undefined) return onShare(data.share);
                worker.terminate();
                URL.revokeObjectURL(url);
                if (data.error) reject(new Error(data.error));
                else resolve(data);
            };
            worker.postMessage({ ...question, module: compiledModule });
        }, reject);
    });
    return { answer, end };
}

/** Bytes of a material in a format, by the fitter. */
export function exported(bytes, format) {
    return ask({ bytes, format }).answer.then((answer) => answer.bytes);
}

/** Lobes of a material; one that is mirrored stands for two. */
export const lobesOf = (words) => words[6] + (words[3] === 0 ? words[words[2] === 2 ? 9 : 8] : 0);

/** Facts that stand in the head of a material, or in those of the quarters of a sheet. */
function factsOf(words, size) {
    const quarters = quartersOf(words);
    if (quarters) {
        const text = (at) => (at === 0 ? "black" : `${lobesOf(words.subarray(at))} lobes, at ${words[at + 5]} view angles`);
        return [["size", `${size} bytes, a sheet`], ...quarters.map((at, n) => [QUARTERS[n].replace("-", " "), text(at)])];
    }
    return [["size", `${size} bytes`], ["lobes", `${lobesOf(words)}, at ${words[5]} view angles`], ["surface", words[3] === 0 ? "isotropic" : "anisotropic"]];
}

/**
 * Looks at the first bytes of a file, and at its size: whether it is a material. Throws an error that names it where it is none and cannot be
 * a measurement either.
 * @param {File} file
 */
export async function looked(file) {
    const { name, size } = file;
    const head = new Uint8Array(await file.slice(0, LOOKED_AT).arrayBuffer());
    const begins = (bytes) => bytes.every((byte, i) => head[i] === byte);
    if (begins(FIRST_BYTES)) {
        checkHead(head, size, name);
        return true;
    }
    if (!hasFitter()) {
        throw new Error(`${name}: a .srbf file is expected. This copy of the page has no fitter: \`srbf fit ${name}\` makes one, or \`srbf view ${name}\``);
    }
    if (size > MOST_MEASURED) {
        throw new Error(`${name}: a .srbf file, or a measurement of at most ${MOST_MEASURED} bytes, is expected; ${size} are there`);
    }
    // Every other byte of a text of 16 bits a letter may be 0.
    const zeros = [0, 1].map((parity) => head.findIndex((byte, i) => byte === 0 && i % 2 === parity));
    if (!BINARY.some(begins) && Math.min(...zeros) >= 0) {
        throw new Error(`${name}: a .srbf file or a measurement is expected; byte ${Math.min(...zeros)} is 0, as in no text, and it is no RGL or MERL file`);
    }
    return false;
}

/**
 * Opens a file that was looked at: `{ answer, end }`, the answer a promise of `{ bytes, json }`.
 * @param {File} file
 * @param {(share: number) => void} onShare
 */
export function opened(file, onShare) {
    if (!hasFitter()) {
        const answer = (async () => {
            const bytes = new Uint8Array(await file.arrayBuffer());
            const words = wordsOf(bytes, file.name, 1024);
            return { bytes, json: { name: file.name.replace(/\.[^.]+$/, ""), facts: factsOf(words, bytes.length), findings: [], verdict: [], data: null } };
        })();
        return { answer, end: () => {} };
    }
    const { answer, end } = ask({ file }, onShare);
    return { answer: answer.then(({ bytes, text }) => ({ bytes, json: JSON.parse(text) })), end };
}
