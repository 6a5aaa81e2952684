// The page: what is clicked, dropped and shown.
import { DAYLIGHT, LIGHTS, PARTS, SHAPES, SIDES, Tracer } from "./tracer.js";
import { MOST_LIGHT } from "./radiance.js";
import { isLight, lightOf } from "./exr.js";
import { COLUMNS, columnOf, draw, drawSpectrum, nearest } from "./plot.js";
import { exported, hasFitter, looked, opened } from "./opener.js";
import { Palette } from "./palette.js";
import { decoded } from "./tree.js";
import { QUARTERS } from "./words.js";

const data = self.srbfData;
const at = (id) => document.getElementById(id);
const ILLUMINANTS = ["D65", "A", "F11"]; // daylight, an incandescent lamp, a fluorescent one
const THUMBNAIL = 96; // pixels of the picture of a preset
const options = new URLSearchParams(location.hash.slice(1));

let tracer = null;
let shown = null; // { bytes, json }: what is on the page
let isLogarithmic = true;
let fitting = null;
let palette = null;

function make(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (key in made && typeof value !== "string") made[key] = value;
        else made.setAttribute(key, value);
    }
    made.append(...children);
    return made;
}

function say(text) {
    at("notice").textContent = text ?? "";
    at("notice").hidden = !text;
}

/** A name as a title: underscores are spaces, and it begins with a capital letter. */
const titled = (name) => name.replace(/_+/g, " ").replace(/^./, (c) => c.toUpperCase());

// The picture

let isRunning = false;
function run() {
    if (isRunning || !tracer) return;
    isRunning = true;
    const step = () => {
        let goesOn = false;
        // A fit has the processor for itself, where that draws too.
        if (at("fitting").open) {
            isRunning = false;
            return;
        }
        try {
            goesOn = tracer.step();
        } catch (error) {
            say(`The picture: ${error.message}`);
        }
        at("count").textContent = tracer.count > 0 ? `${tracer.count} samples a pixel` : "";
        if (goesOn) requestAnimationFrame(step);
        else isRunning = false;
    };
    requestAnimationFrame(step);
}

function fitCanvas() {
    const canvas = at("canvas"), box = canvas.getBoundingClientRect();
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const size = [box.width, box.height].map((n) => Math.max(Math.round(n * ratio), 16));
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    run();
}

function turnable(canvas) {
    const pointers = new Map();
    let rest = 0;
    const moved = () => {
        tracer.isMoving = true;
        clearTimeout(rest);
        rest = setTimeout(() => { tracer.isMoving = false; run(); }, 200);
        run();
    };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, event);
    });
    const end = (event) => pointers.delete(event.pointerId);
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("pointermove", (event) => {
        const before = pointers.get(event.pointerId);
        if (!before || !tracer) return;
        const others = [...pointers.values()].filter((other) => other.pointerId !== event.pointerId);
        pointers.set(event.pointerId, event);
        if (others.length > 0) {
            const apart = (p) => Math.hypot(p.clientX - others[0].clientX, p.clientY - others[0].clientY);
            tracer.turn(0, 0, Math.max(apart(event), 1) / Math.max(apart(before), 1));
        } else {
            tracer.turn(0.4 * (event.clientX - before.clientX), 0.4 * (event.clientY - before.clientY));
        }
        moved();
    });
    canvas.addEventListener("wheel", (event) => {
        // The page scrolls, but where the picture is held or a key is.
        if (!event.ctrlKey && document.activeElement !== canvas) return;
        event.preventDefault();
        tracer?.turn(0, 0, Math.exp(-0.0015 * event.deltaY));
        moved();
    }, { passive: false });
    const keys = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5], "+": [0, 0, 1.1], "=": [0, 0, 1.1], "-": [0, 0, 1 / 1.1] };
    canvas.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !tracer) return;
        if (event.key === "0") tracer.home();
        else if (keys[event.key]) tracer.turn(...keys[event.key]);
        else return;
        event.preventDefault();
        moved();
    });
}

// Light, and a second material

/** Takes a picture of light from a file. */
async function ownLight(file) {
    say(null);
    try {
        if (!tracer) throw new Error(`${file.name}: without WebGL no light is seen`);
        if (file.size > MOST_LIGHT) throw new Error(`${file.name}: a picture of light of at most ${MOST_LIGHT} bytes is expected; ${file.size} are there`);
        const map = await lightOf(new Uint8Array(await file.arrayBuffer()), file.name);
        try {
            tracer.setOwn(map);
        } catch (error) {
            throw new Error(`${file.name}: ${error.message}`);
        }
        const own = at("lights").querySelector("[value=own]");
        own.parentElement.hidden = false;
        own.parentElement.title = file.name;
        own.checked = true;
        describe();
        run();
    } catch (error) {
        say(error.message);
    }
}

/** Shows a material on a second ball: a preset, or the one that is shown at this moment. */
function besides(all) {
    const select = at("beside");
    const titles = [["", "nothing"], ...all.map(({ json }) => [json.name, titled(json.name)]), ["\n", "the one that is shown"]];
    select.append(...titles.map(([value, title]) => make("option", { value }, title)));
    select.addEventListener("change", () => {
        const preset = all.find(({ json }) => json.name === select.value);
        const other = preset ? { bytes: preset.bytes, name: preset.json.name } : select.value && shown ? { bytes: shown.bytes, name: shown.json.name } : null;
        say(null);
        try {
            tracer?.setBeside(other);
            if (select.value === "\n") {
                const kept = [...select.options].find(({ value }) => value === "\r") ?? make("option", { value: "\r" });
                kept.textContent = titled(other.name);
                select.append(kept);
                select.value = "\r";
            }
        } catch (error) {
            select.value = "";
            tracer?.setBeside(null);
            say(error.message);
        }
        describe();
        run();
    });
}

// Choices

function choices(fieldset, names, chosen, choose) {
    for (const name of names) {
        const input = make("input", { type: "radio", name: fieldset.id, value: name, checked: name === chosen });
        input.addEventListener("change", () => choose(name));
        fieldset.append(make("label", {}, input, make("span", {}, name)));
    }
}

function describe() {
    const seen = tracer?.quarters ? `, ${tracer.side}, ${tracer.part === "both" ? "reflected and transmitted" : tracer.part} light,` : "";
    const beside = tracer?.isPair ? ` beside ${at("beside").selectedOptions[0].textContent}` : "";
    const light = LIGHTS[tracer?.light ?? 0];
    at("canvas").setAttribute("aria-label", `${at("name").textContent}${beside}${seen} on a ${tracer?.shape ?? "ball"}, lit by ${light === "own" ? "a picture" : `the ${light}`}`);
}

// The plot

function plot() {
    if (!shown) return;
    const degrees = Number(at("degrees").value);
    at("degrees-text").textContent = `${degrees}°`;
    if (!tracer) {
        plotWithout(degrees);
        return;
    }
    const view = nearest(shown.json.data, degrees);
    const curves = tracer.curves(degrees, COLUMNS);
    const spectra = spectraShown(), marked = Number(at("marked").value);
    const width = Math.max(at("curves").clientWidth, 280);
    draw(at("curves"), curves, { degrees, isLogarithmic, width, points: view?.points ?? [], marked: spectra ? marked : null });
    const lobes = tracer.numbers.lobes + tracer.numbers.mirrored;
    const entry = (kind, text) => make("span", {}, make("i", kind ? { class: kind } : {}), text);
    const plotted = tracer.quarters ? ` of the ${QUARTERS[tracer.quarters.indexOf(tracer.place, 2 * SIDES.indexOf(tracer.side))]?.replace("-", " ") ?? "other side"}` : "";
    const entries = [entry("of-all", `all of them${plotted}`), entry("", `each of ${lobes} lobes`), entry("of-diffuse", "diffuse")];
    if (view) entries.push(entry("of-points", `the ${shown.json.data.are}, seen at ${Number(view.degrees.toFixed(1))}°`));
    at("legend").replaceChildren(...entries);
    shares(degrees);
    const row = curves[0];
    let best = 0;
    for (let i = 0; i < COLUMNS; i++) if (row[4 * i] > row[4 * best]) best = i;
    const peak = Math.round((180 * best) / (COLUMNS - 1) - 90);
    if (spectra) spectrum(spectra, row, marked, width);
    at("curves-text").textContent = `Seen at ${degrees} degrees, f cos is largest towards light at ${peak} degrees: ${row[4 * best].toPrecision(3)} per steradian.`;
}

let isAsking = false;
/** The curve of all lobes without WebGL, from the fitter: the last that is asked for. */
async function plotWithout(degrees) {
    if (isAsking || !hasFitter()) return;
    isAsking = true;
    const { bytes, json } = shown;
    try {
        const values = new Float32Array((await exported(bytes, `curve ${degrees} ${COLUMNS}`)).buffer);
        const view = nearest(json.data, degrees);
        draw(at("curves"), [values], { degrees, isLogarithmic, width: Math.max(at("curves").clientWidth, 280), points: view?.points ?? [], marked: null });
        const entry = (kind, text) => make("span", {}, make("i", { class: kind }), text);
        at("legend").replaceChildren(entry("of-all", "all of the lobes"), ...(view ? [entry("of-points", `the ${json.data.are}, seen at ${Number(view.degrees.toFixed(1))}°`)] : []));
    } catch (error) {
        say(`The curves: ${error.message}`);
    } finally {
        isAsking = false;
    }
    if (shown.bytes !== bytes || Number(at("degrees").value) !== degrees) plot();
}

/** The spectrum towards a direction of the light that is marked among the lobes. */
function spectrum({ nm, columns }, row, marked, width) {
    const rgb = row.slice(4 * columnOf(marked) + 1, 4 * columnOf(marked) + 4);
    const values = columns.map((column) => Math.max(column[0] * rgb[0] + column[1] * rgb[1] + column[2] * rgb[2], 0));
    at("marked-text").textContent = `${marked}°`;
    drawSpectrum(at("spectrum"), nm, values, width);
    const most = values.indexOf(Math.max(...values));
    at("spectrum-text").textContent = `With light at ${marked} degrees, f cos is ${values[most].toPrecision(3)} per steradian at ${nm[most]} nm${nm.length > 1 ? ", its largest" : ""}.`;
}

/** The spectra of the material, or of the quarter whose lobes are plotted. */
function spectraShown() {
    const all = shown?.json.spectra;
    return tracer?.quarters ? (all?.[tracer.quarters.indexOf(tracer.place)] ?? null) : (all ?? null);
}

/** How much of the light a sheet reflects and lets through. */
function shares(degrees) {
    at("shares").hidden = !tracer.quarters;
    if (!tracer.quarters) return;
    const [reflected, transmitted] = tracer.shares(degrees).map((share) => `${(100 * share).toFixed(1)} %`);
    at("shares").textContent = `Seen from the ${tracer.side} at ${degrees}°, it shows ${reflected} of light from everywhere by reflection, and ${transmitted} by transmission.`;
}

/** The colours under a light, if the material has its spectra. */
function lit(name) {
    const of = (spectra) => spectra?.lights[name] ?? DAYLIGHT;
    const all = shown?.json.spectra;
    tracer?.set({ seen: tracer.quarters ? tracer.quarters.map((_, n) => of(all?.[n])) : of(all) });
    run();
}

/** Shows a side or a part of a sheet. */
function turnedOver(settings) {
    tracer?.set(settings);
    describe();
    spectraParts();
    plot();
    run();
}

// A material

function verdict(lines, findings) {
    const kinds = /^(good|fair|off|try|note) +(.*)$/s;
    const [sentences, others] = [lines.filter((line) => !kinds.test(line)), lines.filter((line) => kinds.test(line))];
    const sentence = at("sentence");
    sentence.hidden = sentences.length === 0;
    const [, use, rest] = /^((?:do not )?use it(?: with care)?)(.*)$/s.exec(sentences.join(" ")) ?? [null, "", sentences.join(" ")];
    sentence.className = `sentence ${/^do not/.test(use) ? "off" : /with care/.test(use) ? "fair" : "good"}`;
    sentence.replaceChildren(make("b", {}, use.replace(/^./, (c) => c.toUpperCase())), rest);
    const rank = ["off", "look", "note", "fair", "try", "good"];
    const all = [...others.map((line) => kinds.exec(line).slice(1)), ...findings.map((text) => ["look", text])];
    all.sort((a, b) => rank.indexOf(a[0]) - rank.indexOf(b[0]));
    const item = ([kind, text]) => make("li", { class: kind }, make("b", {}, kind), make("span", {}, text));
    const good = all.filter(([kind]) => kind === "good"), care = all.filter(([kind]) => kind !== "good");
    at("verdict").hidden = care.length === 0;
    at("verdict").replaceChildren(...care.map(item));
    at("good").hidden = good.length === 0;
    at("good-count").textContent = `${good.length} ${good.length === 1 ? "criterion is" : "criteria are"} good`;
    at("good-list").replaceChildren(...good.map(item));
}

/** How it looks, in words: colour, light that it sends back, highlight. */
function looks() {
    const isSeen = Boolean(tracer) && !tracer.quarters;
    at("looks").hidden = !isSeen;
    if (!isSeen) return;
    const { along, grazing, width, contrast, share: sent } = tracer.look();
    const encoded = (v) => Math.round(255 * Math.min(Math.max(v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055, 0), 1));
    const share = ([y]) => `${Math.round(100 * y)} %`;
    const gloss = contrast < 2.5 ? "is matt" : sent < 0.003 ? "is half matt, with a faint gloss" : width < 4 ? "is nearly a mirror" : width < 12 ? "is glossy" : width < 30 ? "shines softly" : "is half matt";
    const highlight = contrast < 2.5 ? "" : ` Its highlight is ${width < 10 ? width.toFixed(1) : Math.round(width)}° wide and ${contrast < 10 ? contrast.toFixed(1) : Math.round(contrast)} times as bright as the light beside it.`;
    at("looks").replaceChildren(
        make("i", { style: `background: rgb(${[1, 2, 3].map((c) => encoded(along[c])).join(" ")})`, title: "its colour under light from everywhere" }),
        `It ${gloss}.${highlight} It sends ${share(along)} of light from everywhere back along its normal, and ${share(grazing)} at 75°.`,
    );
}

/** Turns the sample about its normal. It changes an anisotropic material alone. */
function turned() {
    const degrees = Number(at("turn").value), radians = (degrees * Math.PI) / 180;
    at("turn-text").textContent = `${degrees}°`;
    tracer?.set({ turned: [Math.cos(radians), Math.sin(radians)] });
    plot();
    run();
}

/** What is there of spectra. */
function spectraParts() {
    const spectra = spectraShown();
    at("spectrum-part").hidden = !spectra;
    // The others of a palette have spectra of their own.
    at("illuminants").hidden = Object.keys(spectra?.lights ?? {}).length === 0 || tracer?.palette > 1;
}

/** What follows from another palette. */
function mixed() {
    if (tracer?.palette > 1) lit(ILLUMINANTS[0]);
    else lit(at("illuminants").querySelector(":checked")?.value);
    spectraParts();
    run();
}

function show(material) {
    tracer?.setMaterial(material.bytes, material.json.name);
    const { quarters } = tracer ?? {};
    at("turn-part").hidden = !tracer || (quarters ?? [0]).every((place) => tracer.all[place + 3] !== 1);
    for (const id of ["sides", "parts"]) at(id).hidden = !quarters;
    at("shapes").hidden = Boolean(quarters);
    at("shapes").querySelector(`[value=${tracer?.shape ?? "ball"}]`).checked = true;
    shown = material;
    const { name, facts, findings } = material.json;
    at("name").textContent = titled(name);
    document.title = `${titled(name)}, srbf`;
    // First what it is, then how large.
    const isBytes = ([label]) => ["size", "made of"].includes(label);
    const sorted = [...facts.filter((fact) => !isBytes(fact)), ...facts.filter(isBytes)];
    at("facts").replaceChildren(...sorted.flatMap(([label, text]) => [make("dt", {}, label), make("dd", {}, text)]));
    verdict(material.json.verdict, findings);
    looks();
    at("beside-part").hidden = !tracer || Boolean(quarters);
    at("palette").hidden = !tracer || Boolean(quarters);
    palette.tell(name);
    for (const button of at("presets").children) button.setAttribute("aria-pressed", String(button.dataset.name === material.preset));
    const views = material.json.data?.views ?? [];
    const degrees = Number(at("degrees").value);
    // Where there are samples, one looks at them first.
    if (views.length > 0 && !nearest(material.json.data, degrees)) {
        at("degrees").value = views.reduce((a, b) => (Math.abs(a.degrees - degrees) <= Math.abs(b.degrees - degrees) ? a : b)).degrees;
    }
    describe();
    plot();
    run();
}

/** Opens a file, and fits it if it is a measurement. */
async function open(file) {
    say(null);
    if (isLight(new Uint8Array(await file.slice(0, 4).arrayBuffer()))) return ownLight(file);
    fitting?.end();
    let isMaterial = false;
    try {
        isMaterial = await looked(file);
    } catch (error) {
        return say(error.message);
    }
    const start = performance.now();
    const dialog = at("fitting");
    at("fitting-name").textContent = file.name;
    at("share").value = 0;
    const told = { share: 0 };
    const seconds = () => Math.round((performance.now() - start) / 1000);
    const done = () => (told.share > 0 ? `${Math.round(100 * told.share)} %` : "looking at the measurement");
    const tell = () => { at("fitting-text").textContent = `${done()}, ${seconds()} s`; };
    const clock = setInterval(tell, 500);
    const mine = opened(file, (share) => {
        // It falls where a fit misses a goal and goes on; the bar waits then.
        told.share = Math.max(told.share, share);
        at("share").value = told.share;
        tell();
    });
    fitting = mine;
    if (!isMaterial && hasFitter()) dialog.showModal();
    tell();
    try {
        const { bytes: made, json } = await mine.answer;
        if (!isMaterial) json.facts.splice(1, 0, ["fitted in", `${((performance.now() - start) / 1000).toFixed(1)} s, here`]);
        show({ bytes: made, json });
    } catch (error) {
        if (error.message !== "cancelled") say(error.message);
    } finally {
        clearInterval(clock);
        if (fitting === mine) {
            fitting = null;
            dialog.close();
            run();
        }
    }
}

// Files

function save(bytes, name) {
    const url = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
    const link = make("a", { href: url, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A material, or the quarter of a sheet that is plotted: its bytes and its name. */
function one({ bytes, json }) {
    if (!tracer?.quarters) return { bytes, name: json.name };
    const { place, all, quarters } = tracer;
    return { bytes: bytes.slice(4 * place, 4 * place + all[place + 4]), name: `${json.name}-${QUARTERS[quarters.indexOf(place)]}` };
}

/** The evaluator with the words of a material or a sheet, as `srbf export --glsl` writes it. */
function shader(bytes) {
    const padded = new Uint8Array(4 * Math.ceil(bytes.length / 4));
    padded.set(bytes);
    const view = new DataView(padded.buffer);
    const words = Array.from({ length: padded.length >> 2 }, (_, i) => `0x${view.getUint32(4 * i, true).toString(16).padStart(8, "0")}u`);
    const rows = Array.from({ length: Math.ceil(words.length / 8) }, (_, i) => `    ${words.slice(8 * i, 8 * i + 8).join(", ")}`);
    const n = words.length, isSheet = words[3] === "0x00000002u";
    // Precisions of numbers come before the first of them.
    const end = data.evaluator.indexOf("#endif") + 8, [head, text] = [data.evaluator.slice(0, end), data.evaluator.slice(end)];
    return new TextEncoder().encode(`${data.calls[isSheet ? 1 : 0]}${shown.json.comment ?? ""}${head}const uint srbf_data[${n}] = uint[${n}](\n${rows.join(",\n")}\n);\nuint srbf_word(int data, int i) { return srbf_data[data + i]; }\n\n${text}${isSheet ? data.sheet : ""}`);
}

const DOWNLOADS = [
    ["Material", "srbf", (bytes) => bytes, false],
    ["Shader (GLSL)", "glsl", shader, false],
    ["RGL", "bsdf", (bytes) => exported(bytes, "rgl"), true],
    ["MERL", "binary", (bytes) => exported(bytes, "merl"), true],
];

function downloads() {
    for (const [label, ending, make_bytes, needsFitter] of DOWNLOADS) {
        const button = make("button", { type: "button", "data-ending": ending, disabled: needsFitter && !hasFitter() }, `${label} `, make("small", {}, `.${ending}`));
        button.addEventListener("click", async () => {
            if (!shown) return;
            button.disabled = true;
            try {
                // Formats of others have no sheets.
                const { bytes, name } = needsFitter ? one(shown) : { bytes: shown.bytes, name: shown.json.name };
                save(await make_bytes(bytes), `${name}.${ending}`);
            } catch (error) {
                say(`${label}: ${error.message}`);
            } finally {
                button.disabled = false;
            }
        });
        at("downloads").append(button);
    }
    at("take-hint").textContent = hasFitter() ? "RGL and MERL files take some seconds to write. MERL files are of isotropic materials." : "This copy of the page has no fitter, which writes RGL and MERL too. A measurement is fitted by srbf view FILE.";
}

function droppable() {
    let depth = 0;
    const hide = () => { depth = 0; at("drop").hidden = true; };
    const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
    addEventListener("dragenter", (event) => { if (hasFiles(event)) { depth++; at("drop").hidden = false; } });
    addEventListener("dragleave", (event) => { if (hasFiles(event) && --depth <= 0) hide(); });
    addEventListener("dragover", (event) => { if (hasFiles(event)) event.preventDefault(); });
    addEventListener("drop", (event) => {
        if (!hasFiles(event)) return;
        event.preventDefault();
        hide();
        if (event.dataTransfer.files[0]) open(event.dataTransfer.files[0]);
    });
    at("file").addEventListener("change", (event) => {
        const [file] = event.target.files;
        if (file) open(file);
        event.target.value = "";
    });
}

function presets() {
    const all = data.presets.map((preset) => ({ bytes: decoded(preset.bytes), json: preset.json, preset: preset.json.name }));
    for (const material of all) {
        const button = make("button", { type: "button", "data-name": material.preset, "aria-pressed": "false" }, titled(material.preset));
        button.addEventListener("click", () => { say(null); show(material); });
        at("presets").append(button);
    }
    return all;
}

/** Pictures of the presets, one at a time, as the page has them at once. */
function thumbnails(all) {
    const [first, ...others] = all;
    if (!first) return;
    const button = [...at("presets").children].find((one) => one.dataset.name === first.preset);
    button.prepend(tracer.thumbnail(first.bytes, THUMBNAIL, 24));
    if (others.length > 0) setTimeout(() => thumbnails(others), 30);
}

function begin() {
    try {
        tracer = new Tracer(at("canvas"), data);
        if (options.has("scale")) tracer.fixedScale = Number(options.get("scale"));
        if (options.has("samples")) tracer.most = Number(options.get("samples"));
    } catch (error) {
        say(`No picture: ${error.message}. ${hasFitter() ? "The curves are there without it." : ""}`);
    }
    choices(at("shapes"), SHAPES, "ball", (shape) => { tracer?.set({ shape }); describe(); run(); });
    choices(at("lights"), LIGHTS, LIGHTS[0], (light) => { tracer?.set({ light: LIGHTS.indexOf(light) }); describe(); run(); });
    at("lights").querySelector("[value=own]").parentElement.hidden = true;
    choices(at("illuminants"), ILLUMINANTS, "D65", lit);
    choices(at("sides"), SIDES, SIDES[0], (side) => turnedOver({ side }));
    choices(at("parts"), PARTS, PARTS[0], (part) => turnedOver({ part }));
    choices(at("scales"), ["log", "linear"], "log", (scale) => { isLogarithmic = scale === "log"; plot(); });
    at("exposure").addEventListener("input", (event) => {
        tracer?.set({ exposure: Number(event.target.value) });
        run();
    });
    at("surroundings").addEventListener("change", (event) => { tracer?.set({ surroundings: event.target.checked }); run(); });
    at("own-light").addEventListener("change", (event) => {
        const [file] = event.target.files;
        if (file) ownLight(file);
        event.target.value = "";
    });
    for (const id of ["degrees", "marked"]) at(id).addEventListener("input", plot);
    at("turn").addEventListener("input", turned);
    at("cancel").addEventListener("click", () => fitting?.end());
    at("fitting").addEventListener("cancel", () => fitting?.end());
    at("version").textContent = `srbf ${data.version}`;
    turnable(at("canvas"));
    downloads();
    droppable();
    const all = presets();
    besides(all);
    new ResizeObserver(fitCanvas).observe(at("canvas"));
    let width = 0;
    new ResizeObserver(() => {
        if (at("curves").clientWidth !== width) {
            width = at("curves").clientWidth;
            plot();
        }
    }).observe(at("curves").parentElement);
    fitCanvas();
    palette = new Palette({ at, make, say, titled, changed: mixed, tracer: () => tracer }, all);
    const own = data.opened;
    show(own ? { bytes: decoded(own.bytes), json: own.json } : all[0]);
    if (tracer) thumbnails(all);
}

begin();
// For tests, and for who looks into the console.
self.srbf = { get tracer() { return tracer; }, get shown() { return shown; }, open, show };
