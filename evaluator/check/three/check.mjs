// Serves a folder, opens its check.html in headless Chromium, and judges the answer: node check.mjs FOLDER CHROMIUM
//
// Balls by three.js are as those by `srbf render` within the Monte Carlo error of both, which the halves of each tell. Writes a PNG of each.

import { spawn } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";

const [folder, browser] = process.argv.slice(2);
const SECONDS = 600, MOST_NOISES = 1.5, MOST_APART = 0.01, MOST_STILL = 0.05;
const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json" };

let answered;
const answer = new Promise((resolve) => { answered = resolve; });
const server = createServer(async (request, response) => {
    if (request.method === "POST") {
        const parts = [];
        for await (const part of request) parts.push(part);
        response.end();
        answered(JSON.parse(Buffer.concat(parts)));
        return;
    }
    try {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
        const content = await readFile(join(folder, path));
        response.setHeader("Content-Type", types[extname(path)] ?? "application/octet-stream");
        response.end(content);
    } catch {
        response.statusCode = 404;
        response.end();
    }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const options = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", `--user-data-dir=${join(tmpdir(), `srbf-three-${process.pid}`)}`];
const chromium = spawn(browser, [...options, `http://127.0.0.1:${server.address().port}/check.html`], { stdio: "ignore" });
const late = setTimeout(() => answered({ error: `no answer in ${SECONDS} s` }), 1000 * SECONDS);
const found = await answer;
clearTimeout(late);
chromium.kill();
server.close();

let isRight = !found.error && found.answers.length > 0;
if (found.error) console.log(found.error);
else console.log(`three.js r${found.version}; differences over the mean, and how many of both noises`);
for (const { name, blocks, difference, noise, still, isSame, picture } of found.answers ?? []) {
    const noises = difference / noise;
    isRight &&= noises <= MOST_NOISES && noise > 0 && noise < 0.03 && still <= MOST_STILL && isSame;
    console.log(`${name}: ${blocks} blocks, ${(100 * difference).toFixed(2)} %, noise ${(100 * noise).toFixed(2)} %, ${noises.toFixed(2)} noises; a picture without noise ${(100 * still).toFixed(2)} %${isSame ? "" : ", and another one the second time"}`);
    await writeFile(join(folder, `${name}.png`), Buffer.from(picture.split(",")[1], "base64"));
}
for (const [name, [value, bound]] of Object.entries(found.features ?? {})) {
    isRight &&= value <= bound;
    console.log(`${value <= bound ? "" : "FAILS: "}${name}: ${value.toExponential(1)}, at most ${bound}`);
}
isRight &&= Object.keys(found.features ?? {}).length === 15;
for (const { side, difference, parts } of found.sheets ?? []) {
    isRight &&= difference < MOST_APART && parts.every((part) => Math.max(...part) > 0.001);
    console.log(`a sheet from ${side > 0 ? "the front" : "behind"}: ${(100 * difference).toFixed(2)} % from the sum of its quarters`);
}
isRight &&= found.sheets?.length === 2;
for (const message of found.refused ?? []) console.log(`refused: ${message}`);
isRight &&= found.refused?.length === 4;
process.exit(isRight ? 0 : 1);
