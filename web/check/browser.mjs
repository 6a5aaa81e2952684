// A headless Chromium, driven through a pipe by its own protocol. It imports nothing but Node.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

/** Starts a browser: `send(method, parameters)`, `on(event, call)`, `end()`. */
export function start(program) {
    const folder = mkdtempSync(join(tmpdir(), "srbf-web-"));
    const options = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--allow-file-access-from-files=false"];
    const child = spawn(program, [...options, `--user-data-dir=${folder}`, "--remote-debugging-pipe", "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    const [input, output] = [child.stdio[3], child.stdio[4]];
    const waiting = new Map(), listeners = [];
    let next = 1, rest = "";
    output.setEncoding("utf8");
    output.on("data", (text) => {
        const parts = (rest + text).split("\0");
        rest = parts.pop();
        for (const part of parts) {
            const message = JSON.parse(part);
            if (message.id) {
                const { resolve, reject } = waiting.get(message.id);
                waiting.delete(message.id);
                if (message.error) reject(new Error(message.error.message));
                else resolve(message.result);
            } else {
                listeners.filter(([name]) => name === message.method).forEach(([, call]) => call(message.params));
            }
        }
    });
    child.on("exit", () => waiting.forEach(({ reject }) => reject(new Error("the browser ended"))));
    const send = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
        const id = next++;
        waiting.set(id, { resolve, reject });
        input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
    const on = (event, call) => listeners.push([event, call]);
    const end = async () => {
        await send("Browser.close").catch(() => {});
        await new Promise((resolve) => (child.exitCode === null ? child.once("exit", resolve) : resolve()));
        rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
    };
    return { send, on, end };
}

/** Opens a page, after a script `before` its own: `call(expression)`, `send`, `key`, `screenshot`. Errors of the page are collected in `errors`. */
export async function open(browser, url, { width = 1280, height = 900, scheme = "light", before = null } = {}) {
    const { targetId } = await browser.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await browser.send("Target.attachToTarget", { targetId, flatten: true });
    const send = (method, params) => browser.send(method, params, sessionId);
    const errors = [];
    browser.on("Runtime.exceptionThrown", ({ exceptionDetails }) => errors.push(exceptionDetails.exception?.description ?? exceptionDetails.text));
    await send("Runtime.enable");
    await send("Page.enable");
    await send("DOM.enable");
    await send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 600 });
    await send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
    if (before) await send("Page.addScriptToEvaluateOnNewDocument", { source: before });
    await send("Page.navigate", { url });
    const call = async (expression) => {
        const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
        if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    };
    /** Waits until an expression holds. */
    const until = async (expression, seconds = 60) => {
        const end = Date.now() + 1000 * seconds;
        while (!(await call(`Boolean(${expression})`))) {
            if (errors.length > 0) throw new Error(errors.join("\n"));
            if (Date.now() > end) throw new Error(`not in ${seconds} s: ${expression}`);
            await new Promise((resolve) => setTimeout(resolve, 100));
        }
    };
    const key = async (name, code = name) => {
        for (const type of ["keyDown", "keyUp"]) await send("Input.dispatchKeyEvent", { type, key: name, code, windowsVirtualKeyCode: { Tab: 9, ArrowLeft: 37, ArrowRight: 39, Enter: 13 }[name] ?? 0 });
    };
    const give = async (selector, files) => {
        const { root } = await send("DOM.getDocument");
        const { nodeId } = await send("DOM.querySelector", { nodeId: root.nodeId, selector });
        await send("DOM.setFileInputFiles", { nodeId, files });
    };
    const screenshot = async (whole = true) => Buffer.from((await send("Page.captureScreenshot", { captureBeyondViewport: whole })).data, "base64");
    const close = () => browser.send("Target.closeTarget", { targetId });
    return { call, until, send, key, give, screenshot, close, errors };
}
