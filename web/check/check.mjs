// The page in headless Chromium: load, turn, fit, download, and the ball beside `srbf render`: node check.mjs PAGE CHROMIUM SRBF [MEASURED...]
//
// PAGE is a folder of `packaging/web`. MEASURED files are fitted, the first with a limit in seconds. Screenshots go to PAGE/shots.

import { spawn, spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, readFileSync, rmSync, truncateSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { open, start } from "./browser.mjs";
import { script } from "./modules.mjs";
import { png, radiance } from "./pictures.mjs";

const { exr } = await script("exr.js");
const [folder, program, srbf, ...measured] = process.argv.slice(2).map((path) => resolve(path));
const seeds = join(dirname(fileURLToPath(import.meta.url)), "..", "..", "fuzz", "seeds", "scene-exr");
const [SIDE, BLOCK, PICTURES] = [96, 8, 32];
const MOST_NOISES = 1.5, MOST_NOISE = 0.03;
const shots = join(folder, "shots"), taken = join(folder, "taken");
[shots, taken].forEach((place) => { rmSync(place, { recursive: true, force: true }); mkdirSync(place); });

let isRight = true;
function expectThat(holds, what) {
    if (!holds) console.log(`FAILS: ${what}`);
    isRight &&= Boolean(holds);
}

function command(...parameters) {
    const run = spawnSync(srbf, parameters, { encoding: "utf8" });
    if (run.status !== 0) throw new Error(`srbf ${parameters.join(" ")}: ${run.stderr}`);
    return run.stdout;
}

/** Means over blocks that lie within the ball, of numbers with `count` a pixel, rows from the top. */
function blocks(pixels, count) {
    const means = [];
    for (let y = 0; y < SIDE; y += BLOCK) {
        for (let x = 0; x < SIDE; x += BLOCK) {
            const sum = [0, 0, 0];
            let reach = 0;
            for (let i = 0; i < BLOCK * BLOCK; i++) {
                const [px, py] = [x + (i % BLOCK), y + Math.floor(i / BLOCK)];
                reach = Math.max(reach, Math.hypot(px + 0.5 - SIDE / 2, py + 0.5 - SIDE / 2));
                for (let c = 0; c < 3; c++) sum[c] += pixels[count * (py * SIDE + px) + c] / BLOCK ** 2;
            }
            if (reach < 0.34 * SIDE) means.push(...sum);
        }
    }
    return means;
}

/** Root mean square of a difference over the mean of the second. */
function apart(a, b) {
    const square = a.reduce((sum, value, i) => sum + (value - b[i]) ** 2, 0);
    return Math.sqrt(square / a.length) / (b.reduce((sum, value) => sum + Math.abs(value), 0) / b.length);
}

const both = (a, b) => a.map((value, i) => 0.5 * (value + b[i]));

function turnedOver(rows, count) {
    const out = new Float32Array(rows.length), line = count * SIDE;
    for (let y = 0; y < SIDE; y++) out.set(rows.slice(y * line, (y + 1) * line), (SIDE - 1 - y) * line);
    return out;
}

/** Balls of the page beside those of `srbf render`, under lights of the page as maps. */
async function balls(page) {
    console.log("balls: difference from srbf render over the mean, noise of both, difference in noises");
    const lights = await page.call("[...document.querySelectorAll('#lights input')].map((one) => one.value)");
    for (const [name, size, material, lamp, isOwn] of [["sky", [512, 256], "cayman"], ["lamps", [1024, 512], "garnet_red"], ["lamps", [1024, 512], "garnet_red", "A"], ["room", [1024, 512], "gold"], ["sky", [512, 256], "garnet_red", undefined, true], ["zip", null, "garnet_red", undefined, true]]) {
        const light = lights.indexOf(name);
        const map = join(taken, size ? `${name}.hdr` : `${name}.exr`);
        if (size) writeFileSync(map, radiance(await page.call(`Array.from(srbf.tracer.map(${light}, ${size[0]}, ${size[1]}))`), ...size));
        else copyFileSync(join(seeds, name), map);
        const references = [];
        for (const seed of [0, 1]) {
            const to = join(taken, `${material}-${seed}.exr`), file = join(folder, "presets", `${material}.srbf`);
            const spectral = lamp ? ["--spectral", lamp] : [];
            command("render", "--quiet", ...spectral, "--scene", "sphere", "--material", file, "--env", map, "--size", `${SIDE}x${SIDE}`, "--spp", "64", "--seed", String(seed), "-o", to);
            references.push(blocks((await exr(readFileSync(to), to)).numbers, 4));
        }
        await page.call(`document.querySelector("#illuminants [value=${lamp ?? "D65"}]").click(), document.querySelector("[data-name=${material}]").click(), srbf.tracer.light = ${Math.max(light, 0)}, srbf.tracer.home()`);
        // The same light as a picture of one's own.
        if (isOwn) {
            await page.give("#own-light", [map]);
            await page.until("srbf.tracer.light === 4");
        }
        const halves = [];
        for (const first of [0, 5000]) {
            const rows = await page.call(`Array.from(srbf.tracer.rendered(${SIDE}, ${SIDE}, ${PICTURES}, ${first}))`);
            halves.push(blocks(turnedOver(rows, 4), 4));
        }
        const [ours, theirs] = [both(...halves), both(...references)];
        const noise = 0.5 * Math.hypot(apart(...halves), apart(...references));
        const difference = apart(ours, theirs);
        console.log(`  ${material} under ${name}${lamp ? `, ${lamp}` : ""}${isOwn ? `, as ${map.slice(-3)}` : ""}: ${(100 * difference).toFixed(2)} %, noise ${(100 * noise).toFixed(2)} %, ${(difference / noise).toFixed(2)} noises`);
        expectThat(difference <= MOST_NOISES * noise && noise > 0 && noise < MOST_NOISE, `the ball of ${material} under ${name} is that of srbf render`);
    }
    await page.call(`document.querySelector("#illuminants [value=D65]").click(), document.querySelector("#lights [value=room]").click()`);
    // Pictures that are none.
    const map = readFileSync(join(taken, "sky.hdr"));
    const head = (text) => Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n${text}\n`), Buffer.alloc(64)]);
    for (const [name, bytes, said] of [["short", map.subarray(0, 5000), "the file ends in row"], ["picture", Buffer.from("P6 1 1"), "Radiance (.hdr) or OpenEXR (.exr)"], ["half", readFileSync(join(seeds, "zip")).subarray(0, 900), "ends within block"], ["losses", readFileSync(join(seeds, "losses")), "PXR24 is there; `oiiotool"], ["large", head("-Y 16384 +X 16384"), "16384 x 16384"], ["turned", head("+X 4 +Y 4"), "-Y HEIGHT +X WIDTH"], ["dark", head("-Y 4 +X 4"), "some light"]]) {
        writeFileSync(join(taken, `${name}.hdr`), bytes);
        await page.give("#own-light", [join(taken, `${name}.hdr`)]);
        await page.until(`document.getElementById("notice").textContent.startsWith("${name}.hdr: ")`);
        const notice = await page.call(`document.getElementById("notice").textContent`);
        expectThat(notice.includes(said), `${name}.hdr: ${notice}`);
        console.log(`refused: ${notice}`);
    }
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
}

/** The light is seen behind the ball, and two materials are beside each other. */
async function beside(page) {
    const rendered = async () => turnedOver(await page.call(`Array.from(srbf.tracer.rendered(${SIDE}, ${SIDE}, 4))`), 4);
    const choose = (name) => page.call(`(() => { const select = document.getElementById("beside"); select.value = "${name}"; select.dispatchEvent(new Event("change")); })()`);
    const show = (name) => page.call(`document.querySelector("[data-name=${name}]").click()`);
    const half = (pixels, isRight) => Array.from({ length: SIDE }, (_, y) => Array.from(pixels.slice(4 * (y * SIDE + (isRight ? SIDE / 2 : 0)), 4 * (y * SIDE + (isRight ? SIDE : SIDE / 2))))).flat();
    await page.call(`document.querySelector("#lights [value=room]").click()`);
    await show("gold");
    const behind = await rendered();
    await page.call(`document.getElementById("surroundings").click()`);
    const alone = await rendered();
    await page.call(`document.getElementById("surroundings").click()`);
    expectThat(behind[3] === 1 && behind[0] > 0.2 && alone[3] === 0, `the light is seen behind the ball (${behind[3]}, ${behind[0]}, ${alone[3]})`);
    const middle = 4 * (SIDE / 2 * SIDE + SIDE / 2);
    expectThat([0, 1, 2, 3].every((c) => behind[middle + c] === alone[middle + c]), "the ball is the same before it");
    await choose("cayman");
    const goldCayman = await rendered();
    await show("cayman");
    const caymanCayman = await rendered();
    await choose("gold");
    const caymanGold = await rendered();
    const same = (a, b) => apart(a, b) < 1e-6;
    expectThat(same(half(goldCayman, true), half(caymanCayman, true)), "the second ball is of the material beside");
    expectThat(same(half(caymanGold, false), half(caymanCayman, false)), "the first ball is of the one that is shown");
    expectThat(!same(half(goldCayman, false), half(caymanCayman, false)) && !same(half(caymanGold, true), half(caymanCayman, true)), "both differ");
    // One that is shown is kept, also a file.
    await choose("\\n");
    await show("gold");
    expectThat(same(await rendered(), goldCayman), "the one that was shown is kept beside another one");
    await choose("");
    expectThat(same(await rendered(), behind), "without it there is one ball");
    const look = await page.call(`document.getElementById("looks").textContent`);
    const first = await page.call(`[...document.querySelectorAll("#facts dt")].map((one) => one.textContent)`);
    console.log(`gold: ${look}`);
    expectThat(/^It shines softly.* 77 %/.test(look) && first.indexOf("size") > first.indexOf("lobes"), `first what it looks like, then bytes: ${look} ${first}`);
    await show("garnet_red");
}

/** Without WebGL the curves are those with it. */
async function plain(browser, page, url) {
    const curve = `document.querySelector("#curves .all")?.getAttribute("d")`;
    const without = await open(browser, url, { before: "HTMLCanvasElement.prototype.getContext = () => null;" });
    await without.until(curve, 120);
    // The slider of the page may have been moved.
    const degrees = await without.call(`document.getElementById("degrees").value`);
    await page.call(`(() => { const slider = document.getElementById("degrees"); slider.value = ${degrees}; slider.dispatchEvent(new Event("input")); })()`);
    await page.call(`document.querySelector("[data-name=gold]").click(), srbf.tracer.set({ turned: [1, 0] })`);
    const expected = await page.call(curve);
    const numbers = (text) => text.match(/[\d.]+/g).map(Number);
    const [a, b] = [numbers(expected), numbers(await without.call(curve))];
    const most = a.reduce((sum, value, n) => Math.max(sum, Math.abs(value - b[n])), Math.abs(a.length - b.length));
    console.log(`curves without WebGL: ${a.length} numbers, ${most.toFixed(2)} pixels apart`);
    expectThat(a.length > 500 && most < 0.5, "curves without WebGL are those with it");
    expectThat((await without.call(`document.getElementById("notice").textContent`)).startsWith("No picture"), "it says why there is no picture");
    expectThat(without.errors.length === 0, without.errors.join("\n"));
    await without.close();
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
}

/** The sample of an anisotropic material turns, in the picture and in the plot. */
async function turns(page) {
    const fit = join(taken, "brushed.srbf");
    command("fit", "model:ggx:alpha_x=0.1,alpha_y=0.4,f0=0.9", "--lobes", "4", "--steps", "5", "--no-picture", "-o", fit);
    const isHidden = `document.getElementById("turn-part").hidden`;
    expectThat(await page.call(isHidden), "an isotropic material has no turn");
    await page.give("#file", [fit]);
    await page.until(`document.getElementById("name").textContent === "Brushed"`);
    expectThat(!await page.call(isHidden), "an anisotropic material has a turn");
    const seen = async (degrees) => {
        await page.call(`(() => { const slider = document.getElementById("turn"); slider.value = ${degrees}; slider.dispatchEvent(new Event("input")); })()`);
        const rows = await page.call(`Array.from(srbf.tracer.rendered(${SIDE}, ${SIDE}, ${PICTURES}))`);
        return [blocks(turnedOver(rows, 4), 4), await page.call(`document.querySelector("#curves .all").getAttribute("d")`)];
    };
    const [[asIs, curve], [half], [quarter, other]] = [await seen(0), await seen(180), await seen(90)];
    const [same, apartBy] = [apart(half, asIs), apart(quarter, asIs)];
    console.log(`turned by 180 degrees: ${(100 * same).toFixed(2)} % apart, by 90: ${(100 * apartBy).toFixed(1)} %`);
    expectThat(apartBy > 0.1 && same < 0.1 * apartBy, "half a turn changes nothing, and a quarter does");
    expectThat(curve !== other, "the curves follow the turn");
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
}

/** Both sides of a sheet, and the light that each part adds. */
async function sheets(page) {
    await page.give("#file", [join(folder, "presets", "sheets", "ground_glass.srbf")]);
    await page.until(`document.getElementById("name").textContent === "Ground glass"`);
    const seen = async (side, part) => {
        await page.call(`document.querySelector("#sides [value=${side}]").click(), document.querySelector("#parts [value=${part}]").click()`);
        return blocks(turnedOver(await page.call(`Array.from(srbf.tracer.rendered(${SIDE}, ${SIDE}, ${PICTURES}))`), 4), 4);
    };
    for (const side of ["front", "back"]) {
        const [whole, reflected, transmitted] = [await seen(side, "both"), await seen(side, "reflected"), await seen(side, "transmitted")];
        const difference = apart(whole, reflected.map((value, i) => value + transmitted[i]));
        console.log(`${side} of ground glass: ${(100 * difference).toExponential(1)} % from the sum of its parts; ${await page.call(`document.getElementById("shares").textContent`)}`);
        expectThat(difference < 1e-4 && whole.some((value) => value > 0.1), `both parts are the sum of each, ${side}`);
        expectThat((side === "back") === reflected.every((value) => value === 0), "the reflection of the back is black");
    }
    expectThat(await page.call(`document.getElementById("shapes").hidden`), "a sheet is shown on the ball");
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
    expectThat(await page.call(`document.getElementById("sides").hidden && document.getElementById("shares").hidden`), "a material has no sides");
}

/** Several materials on the ball: shares of two, an index map, a tint, and what is refused. */
async function palettes(page) {
    const rendered = async (first = 0) => turnedOver(await page.call(`Array.from(srbf.tracer.rendered(${SIDE}, ${SIDE}, ${PICTURES}, ${first}))`), 4);
    const alone = async (name) => { await page.call(`document.querySelector("[data-name=${name}]").click()`); return rendered(); };
    const add = (name) => page.call(`(() => { const select = document.getElementById("palette-add"); select.value = "${name}"; select.dispatchEvent(new Event("change")); })()`);
    // The light behind the ball has no material.
    const surroundings = () => page.call(`document.getElementById("surroundings").click()`);
    await surroundings();
    // The seam of the maps is in the middle of a ball that has not been turned.
    await page.call(`srbf.tracer.home()`);
    let count = 0;
    const given = async (name, rows) => {
        const file = `${name}-${count++}.png`;
        writeFileSync(join(taken, file), png(rows));
        await page.give(`#${name}-map`, [join(taken, file)]);
        await page.until(`document.getElementById("${name}-name").textContent === "${file}"`);
    };
    const gone = (name) => page.call(`document.getElementById("${name}-gone").click()`);
    const [blue, red] = [await alone("krylon_blue"), await alone("garnet_red")];
    // Shares of two.
    await add("krylon_blue");
    await page.call(`(() => { const mix = document.getElementById("mix"); mix.value = 0.3; mix.dispatchEvent(new Event("input")); })()`);
    const halves = [blocks(await rendered(), 4), blocks(await rendered(5000), 4)];
    const expected = blocks(red.map((value, i) => 0.7 * value + 0.3 * blue[i]), 4);
    const [noise, difference] = [0.5 * apart(...halves), apart(both(...halves), expected)];
    console.log(`a palette of two: ${(100 * difference).toFixed(2)} % from the sum of both, noise ${(100 * noise).toFixed(2)} %`);
    expectThat(difference < 2.5 * noise && noise > 0 && noise < MOST_NOISE, "shares of two materials are those of their pictures");
    expectThat(await page.call(`document.getElementById("illuminants").hidden`), "a palette is seen in daylight");
    // The left half of the ball is of one, the right half of the other, as each is alone.
    await given("index", [[0, 1, 0, 1].map((n) => [n, n, n])]);
    const placed = await rendered();
    let wrong = 0;
    for (let y = 0; y < SIDE; y++) {
        for (const x of [...Array(SIDE / 2 - 2).keys(), ...Array.from({ length: SIDE / 2 - 2 }, (_, i) => SIDE / 2 + 2 + i)]) {
            const at = 4 * (y * SIDE + x), of = x < SIDE / 2 ? red : blue;
            wrong += [0, 1, 2].some((c) => Math.abs(placed[at + c] - of[at + c]) > 1e-4 * (1 + of[at + c])) ? 1 : 0;
        }
    }
    expectThat(wrong === 0, `materials are where the index map says (${wrong} pixels are not)`);
    await given("index", [[[2, 0, 0]]]);
    expectThat((await page.call(`document.getElementById("notice").textContent`)).includes("material 2 of a palette from 0 to 1"), "a number beyond the palette is named");
    await gone("index");
    // A weight map, and a tint, which is sRGB.
    await given("weight", [[[255, 0, 0]]]);
    await given("tint", [[[188, 255, 0]]]);
    const tinted = await rendered(), tint = [((188 / 255 + 0.055) / 1.055) ** 2.4, 1, 0];
    let off = 0;
    for (let i = 0; i < tinted.length; i += 4) for (let c = 0; c < 3; c++) off = Math.max(off, Math.abs(tinted[i + c] - tint[c] * blue[i + c]) / (1 + blue[i + c]));
    expectThat(off < 2e-3, `a tint multiplies what the second material reflects (${off})`);
    writeFileSync(join(taken, "none.png"), "no picture");
    await page.give("#tint-map", [join(taken, "none.png")]);
    await page.until(`document.getElementById("notice").textContent.includes("none.png: a picture is expected")`);
    for (const name of ["weight", "tint"]) await gone(name);
    await page.give("#palette-files", [join(folder, "presets", "sheets", "ground_glass.srbf")]);
    await page.until(`document.getElementById("notice").textContent.includes("this is a sheet")`);
    await page.call(`document.querySelector("#palette-list button").click()`);
    const again = await rendered();
    expectThat(again.every((value, i) => value === red[i]), "without the others the first is as it was");
    await surroundings();
}

/** Material, keys, slider, faults. */
async function used(page) {
    expectThat(await page.call(`document.getElementById("name").textContent`) === "Gold", "a material that one knows is there at once");
    await page.give("#file", [join(folder, "presets", "cayman.srbf")]);
    await page.until(`document.getElementById("name").textContent === "Cayman"`);
    await page.call(`document.getElementById("canvas").focus()`);
    const before = await page.call("srbf.tracer.turns.ball.azimuth");
    await page.key("ArrowLeft");
    expectThat(await page.call("srbf.tracer.turns.ball.azimuth") !== before, "an arrow key turns the ball");
    const curve = `document.querySelector("#curves .all").getAttribute("d")`;
    const [path, degrees] = await page.call(`[${curve}, document.getElementById("degrees").value]`);
    await page.call(`document.getElementById("degrees").focus()`);
    await page.key("ArrowRight");
    expectThat(await page.call(`document.getElementById("degrees").value`) === String(Number(degrees) + 1), "an arrow key moves the slider");
    expectThat(await page.call(curve) !== path, "the curves follow the slider");
    const shape = `document.querySelector("#spectrum .all").getAttribute("d")`;
    const spectrum = await page.call(shape);
    await page.call(`document.getElementById("marked").focus()`);
    await page.key("ArrowRight");
    expectThat(spectrum.split("L").length === 31 && await page.call(shape) !== spectrum, "the spectrum follows the marked light");
    expectThat(!await page.call(`document.getElementById("illuminants").hidden`), "a material with spectra has a choice of lights");
    // All that can be done is reached by the tab key.
    const reached = new Set();
    await page.call("document.activeElement.blur()");
    for (let i = 0; i < 48; i++) {
        await page.key("Tab");
        reached.add(await page.call(`document.activeElement.id || document.activeElement.name || document.activeElement.dataset.name || document.activeElement.dataset.ending || ""`));
    }
    for (const name of ["file", "canvas", "shapes", "lights", "own-light", "surroundings", "beside", "illuminants", "scales", "exposure", "degrees", "marked", "garnet_red", "srbf", "glsl", "bsdf", "binary"]) expectThat(reached.has(name), `the tab key reaches ${name}`);
    // A file that is none.
    const bytes = readFileSync(join(folder, "presets", "cayman.srbf"));
    bytes[100] ^= 1;
    writeFileSync(join(taken, "damaged.srbf"), bytes);
    await page.give("#file", [join(taken, "damaged.srbf")]);
    await page.until(`!document.getElementById("notice").hidden`);
    console.log(`refused: ${await page.call(`document.getElementById("notice").textContent`)}`);
    expectThat((await page.call(`document.getElementById("notice").textContent`)).includes("damaged.srbf"), "a fault names its file");
    // A gigabyte of zeros, which no disk holds: its first bytes are read.
    writeFileSync(join(taken, "large.csv"), "");
    truncateSync(join(taken, "large.csv"), 2 ** 30);
    const begun = Date.now();
    await page.give("#file", [join(taken, "large.csv")]);
    await page.until(`document.getElementById("notice").textContent.includes("large.csv")`);
    console.log(`refused in ${Date.now() - begun} ms: ${await page.call(`document.getElementById("notice").textContent`)}`);
    expectThat(await page.call(`document.getElementById("notice").textContent.includes("at most 268435456 bytes")`), "a large file is refused with the bound");
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
    // The teapot.
    await page.call(`document.querySelector("#shapes [value=teapot]").click()`);
    await page.until("srbf.tracer.shape === 'teapot' && srbf.tracer.count > 1", 90);
    const seen = await page.call(`(() => { srbf.tracer.surroundings = false; const p = srbf.tracer.rendered(64, 64, 2); let n = 0; for (let i = 3; i < p.length; i += 4) n += p[i] > 0.5 ? 1 : 0; srbf.tracer.surroundings = true; return n; })()`);
    expectThat(seen > 400, `the teapot is seen (${seen} of 4096 pixels)`);
    await page.call(`document.querySelector("#shapes [value=ball]").click()`);
}

/** A field of numbers of an RGL file. */
function field(file, wanted) {
    for (let n = file.readUInt32LE(14), at = 18; n > 0; n--) {
        const length = file.readUInt16LE(at);
        const name = file.toString("latin1", at + 2, at + 2 + length);
        at += 2 + length;
        const rank = file.readUInt16LE(at);
        const [start, end] = [Number(file.readBigUInt64LE(at + 3)), at + 11 + 8 * rank];
        let count = 1;
        for (let k = 0; k < rank; k++) count *= Number(file.readBigUInt64LE(at + 11 + 8 * k));
        if (name === wanted) return Array.from({ length: count }, (_, k) => file.readFloatLE(start + 4 * k));
        at = end;
    }
    return [];
}

/** The numbers of a MERL file that were measured. */
function doubles(file) {
    return Array.from({ length: (file.length - 20) >> 3 }, (_, k) => Math.max(file.readDoubleLE(12 + 8 * k), 0));
}

/** Files that the page writes are those of the command. */
async function downloads(browser, page) {
    await browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: taken, eventsEnabled: true });
    await page.call(`document.querySelector("[data-name=garnet_red]").click()`);
    const of = {};
    for (const ending of ["srbf", "glsl", "bsdf", "binary"]) {
        const done = new Promise((resolve) => browser.on("Browser.downloadProgress", ({ state }) => { if (state === "completed") resolve(); }));
        await page.call(`document.querySelector("[data-ending=${ending}]").click()`);
        await Promise.race([done, new Promise((_, reject) => setTimeout(() => reject(new Error(`no .${ending} in 90 s`)), 90000).unref())]);
        of[ending] = readFileSync(join(taken, `garnet_red.${ending}`));
        await page.until(`!document.querySelector("[data-ending=${ending}]").disabled`);
    }
    const preset = join(folder, "presets", "garnet_red.srbf");
    expectThat(of.srbf.equals(readFileSync(preset)), "the material is the preset");
    command("export", preset, "--glsl", "-o", join(taken, "own.glsl"));
    expectThat(of.glsl.equals(readFileSync(join(taken, "own.glsl"))), "the shader is that of srbf export");
    for (const [ending, bytes, numbers] of [["bsdf", of.bsdf, (file) => field(file, "rgb")], ["binary", of.binary, (file) => doubles(file)]]) {
        command("convert", preset, join(taken, `own.${ending}`));
        const own = readFileSync(join(taken, `own.${ending}`));
        expectThat(own.length === bytes.length, `.${ending} has the size of that of srbf convert`);
        const [a, b] = [numbers(bytes), numbers(own)];
        let [difference, all] = [0, 0];
        b.forEach((value, n) => { difference += (a[n] - value) ** 2; all += value ** 2; });
        const error = Math.sqrt(difference / all);
        console.log(`download .${ending}: ${bytes.length} bytes, relative L2 from that of srbf convert ${error.toExponential(1)}`);
        expectThat(error <= 1e-4 && b.length > 1e5, `.${ending} has the values of srbf convert`);
    }
}

/** Measured files are fitted; the first is cancelled before. */
async function fits(page) {
    for (const [i, file] of measured.entries()) {
        if (i === 0) {
            await page.give("#file", [file]);
            await page.until(`document.getElementById("fitting").open && Number(document.getElementById("share").value) > 0`, 120);
            await page.call(`document.getElementById("cancel").click()`);
            await page.until(`!document.getElementById("fitting").open`);
            expectThat(await page.call(`document.getElementById("notice").hidden`), "a fit that is cancelled leaves no word");
        }
        const begun = Date.now();
        await page.give("#file", [file]);
        await page.until(`document.getElementById("fitting").open`);
        await page.until(`!document.getElementById("fitting").open`, 240);
        const [notice, sentence, facts, points] = await page.call(`[document.getElementById("notice").textContent, document.getElementById("sentence").textContent, document.getElementById("facts").textContent, document.querySelectorAll("#curves .point").length]`);
        console.log(`fitted ${file.split("/").pop()} in ${((Date.now() - begun) / 1000).toFixed(1)} s: ${sentence}`);
        expectThat(notice === "" && sentence !== "" && points > (file.endsWith("small.csv") ? 0 : 3), `${file} is fitted: "${notice}", ${points} points`);
        expectThat(facts.includes("SHA-256"), "the facts name the file");
        const [kind, colour, off] = await page.call(`(() => { const b = document.querySelector("#sentence b"), probe = document.createElement("i"); probe.style.color = "var(--off)"; b.append(probe); const found = [b.parentElement.className, getComputedStyle(b).color, getComputedStyle(probe).color]; probe.remove(); return found; })()`);
        const isOff = sentence.startsWith("Do not");
        expectThat(isOff === (colour === off) && kind === `sentence ${isOff ? "off" : sentence.startsWith("Use it with care") ? "fair" : "good"}`, `the colour of the verdict is its own: ${kind}, ${colour}`);
    }
}

/** `srbf view` serves the page with a file loaded, on the loopback address alone. */
async function viewed(browser) {
    const server = spawn(srbf, ["view", "cayman", "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
    try {
        const address = await new Promise((found, fail) => {
            server.stdout.on("data", (text) => found(/http:\S+/.exec(text)?.[0]));
            server.on("exit", () => fail(new Error("srbf view ended")));
        });
        const page = await open(browser, address);
        await page.until("self.srbf?.tracer?.count > 0");
        expectThat(await page.call(`document.getElementById("name").textContent`) === "Cayman", "srbf view shows its file");
        expectThat(!await page.call(`document.querySelector("[data-ending=binary]").disabled`), "the program writes MERL files");
        // What is dropped is read and fitted by the program: a packed material, a measurement, a fault.
        const packed = join(taken, "small.srbf");
        command("pack", join(folder, "presets", "garnet_red.srbf"), "-o", packed);
        await page.give("#file", [packed]);
        await page.until(`document.getElementById("name").textContent === "Small"`);
        expectThat((await page.call(`document.getElementById("facts").textContent`)).includes(`${readFileSync(packed).length} bytes`), "a packed material is opened");
        await page.give("#file", [measured[0]]);
        await page.until(`document.getElementById("sentence").textContent !== "" && !document.getElementById("fitting").open`, 240);
        expectThat(await page.call(`document.querySelectorAll("#curves .point").length`) > 0, "a measurement is fitted by the program");
        writeFileSync(join(taken, "words.csv"), "neither, one\nnor, the other\n");
        await page.give("#file", [join(taken, "words.csv")]);
        await page.until(`document.getElementById("notice").textContent.startsWith("words.csv: no line names the columns")`);
        console.log(`srbf view refused: ${await page.call(`document.getElementById("notice").textContent`)}`);
        expectThat(page.errors.length === 0, page.errors.join("\n"));
        console.log(`srbf view: ${address}`);
        await page.close();
    } finally {
        server.kill();
    }
    const refused = (...parameters) => spawnSync(srbf, ["view", ...parameters, "--no-open"], { encoding: "utf8", timeout: 60000 });
    for (const parameters of [["nothing.srbf"], ["--page", "/nowhere"], ["--port", "99999"]]) {
        const run = refused(...parameters);
        expectThat(run.status === 2 && run.stderr.includes(parameters.at(-1)), `srbf view ${parameters.join(" ")}: status ${run.status}, ${run.stderr}`);
    }
}

async function pictures(browser, url) {
    for (const [width, height, scheme, shape] of [[1600, 1000, "light", "ball"], [1600, 1000, "dark", "ball"], [400, 860, "light", "ball"], [400, 860, "dark", "teapot"]]) {
        const page = await open(browser, `${url}#scale=${width > 1000 ? 0.5 : 0.7}&samples=32`, { width, height, scheme });
        await page.until("self.srbf?.tracer?.count > 0", 90);
        if (shape === "teapot") await page.call(`document.querySelector("#shapes [value=teapot]").click(), document.querySelector("#lights [value=lamps]").click()`);
        await page.until(`srbf.tracer.shape === "${shape}" && srbf.tracer.count >= ${shape === "ball" ? 8 : 4}`, 120);
        const wide = await page.call("document.documentElement.scrollWidth");
        expectThat(wide <= width, `nothing is wider than ${width} pixels (${wide})`);
        writeFileSync(join(shots, `${width}-${scheme}-${shape}.png`), await page.screenshot());
        expectThat(page.errors.length === 0, page.errors.join("\n"));
        await page.close();
    }
}

const browser = start(program);
try {
    const url = pathToFileURL(join(folder, "index.html")).href;
    const page = await open(browser, url);
    const asked = [];
    browser.on("Network.requestWillBeSent", ({ request }) => asked.push(request.url));
    await page.send("Network.enable");
    await page.until("self.srbf?.tracer?.count > 0");
    const parts = { used: () => used(page), turns: () => turns(page), sheets: () => sheets(page), palettes: () => palettes(page), balls: () => balls(page), beside: () => beside(page), plain: () => plain(browser, page, url), downloads: () => downloads(browser, page), fits: () => fits(page), viewed: () => viewed(browser), pictures: () => pictures(browser, url) };
    const wanted = process.env.PARTS?.split(" ") ?? Object.keys(parts);
    for (const name of wanted) {
        const begun = Date.now();
        await parts[name]();
        console.log(`${name}: ${((Date.now() - begun) / 1000).toFixed(0)} s`);
    }
    expectThat(page.errors.length === 0, page.errors.join("\n"));
    const strange = asked.filter((address) => !/^(file|blob|data):/.test(address));
    expectThat(strange.length === 0, `no request leaves the page: ${strange}`);
} catch (error) {
    console.log(`FAILS: ${error.stack}`);
    isRight = false;
} finally {
    await browser.end();
}
process.exit(isRight ? 0 : 1);
