// Files that are opened: materials at once, measurements by the fitter, in a worker that can be ended.
import { decoded } from "./tree.js";
import { wordsOf } from "./words.js";

const FIRST_BYTES = [0x89, 0x53, 0x52, 0x42, 0x46];

/** Whether the page has a fitter beside it. */
export const hasFitter = () => typeof self.srbfFitter === "string";

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
                ? fitter.fitter_open(...put(text(data.name)), ...put(data.bytes))
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

/** A question to the fitter: the answer, and a way to end it. */
function ask(question, onShare = () => {}) {
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

/** Facts that stand in the head of a material. */
function factsOf(words, size) {
    return [["size", `${size} bytes`], ["lobes", `${words[6]}, at ${words[5]} view angles`], ["surface", words[3] === 0 ? "isotropic" : "anisotropic"]];
}

/**
 * Opens a file: `{ answer, end }`, the answer a promise of `{ bytes, json }`.
 * @param {string} name
 * @param {Uint8Array} bytes
 * @param {(share: number) => void} onShare
 */
export function opened(name, bytes, onShare) {
    const isMaterial = FIRST_BYTES.every((byte, i) => bytes[i] === byte);
    if (isMaterial && !hasFitter()) {
        const answer = (async () => {
            const words = wordsOf(bytes, name, 1024);
            return { bytes, json: { name: name.replace(/\.[^.]+$/, ""), facts: factsOf(words, bytes.length), findings: [], verdict: [], data: null } };
        })();
        return { answer, end: () => {} };
    }
    if (!hasFitter()) {
        const reason = `${name}: a .srbf file is expected. This copy of the page has no fitter: \`srbf fit ${name}\` makes one, or \`srbf view ${name}\``;
        return { answer: Promise.reject(new Error(reason)), end: () => {} };
    }
    const { answer, end } = ask({ name, bytes }, onShare);
    return { answer: answer.then(({ bytes, text }) => ({ bytes, json: JSON.parse(text) })), end };
}
