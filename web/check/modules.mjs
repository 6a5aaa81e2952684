// The scripts of the page as modules: in the page they are one script.

import { copyFileSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const scripts = join(dirname(fileURLToPath(import.meta.url)), "..", "page");
const place = mkdtempSync(join(tmpdir(), "srbf-scripts-"));
process.on("exit", () => rmSync(place, { recursive: true, force: true }));
for (const name of readdirSync(scripts).filter((name) => name.endsWith(".js"))) copyFileSync(join(scripts, name), join(place, name));
writeFileSync(join(place, "package.json"), `{ "type": "module" }`);

/** A script by its name. */
export const script = (name) => import(pathToFileURL(join(place, name)));
