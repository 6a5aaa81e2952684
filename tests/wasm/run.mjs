// Loads the module that is named on the command line, and prints what its checks say.
import { readFileSync } from 'node:fs';

const module = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { check, memory } = module.instance.exports;
const place = check();
const [failed, length] = new Uint32Array(memory.buffer.slice(place, place + 8));
process.stdout.write(new TextDecoder().decode(new Uint8Array(memory.buffer, place + 8, length)));
process.exit(failed === 0 && length > 0 ? 0 : 1);
