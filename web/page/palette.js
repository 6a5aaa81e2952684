// A palette: materials beside the one that is shown, and pictures that say where each is.
import { checkHead, MOST_BYTES } from "./words.js";

const MAPS = [
    ["index", "Numbers: red of a first material, green of a second"],
    ["weight", "Red: the share of the second material"],
    ["tint", "A colour that the reflected light is multiplied by"],
];
const MOST_PICTURE = 1 << 26; // bytes of the file of a map
const MOST_MATERIALS = 256;

/** The largest numbers in red and green: materials of an index map. */
function numbersOf(picture) {
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, picture.width, picture.height);
    let most = 0;
    for (let i = 0; i < data.length; i += 4) most = Math.max(most, data[i], data[i + 1]);
    return most;
}

/**
 * The palette of a page. `page` has `at`, `make`, `say`, `titled`, `changed` (what follows when it changes) and `tracer`; `presets` are materials.
 */
export class Palette {
    constructor(page, presets) {
        Object.assign(this, page);
        this.materials = []; // { name, bytes }, beside the first
        this.names = {}; // files of maps
        this.most = 0; // the largest number of the index map
        const { at, make } = this;
        const add = at("palette-add");
        add.append(make("option", { value: "" }, "add a preset"), ...presets.map(({ json }) => make("option", { value: json.name }, this.titled(json.name))));
        add.addEventListener("change", () => {
            const chosen = presets.find(({ json }) => json.name === add.value);
            add.value = "";
            if (chosen) this.take([{ name: chosen.json.name, bytes: chosen.bytes }]);
        });
        at("palette-files").addEventListener("change", (event) => this.read([...event.target.files], event.target));
        at("mix").addEventListener("input", () => {
            this.tracer()?.set({ share: Number(at("mix").value) });
            this.tell();
        });
        for (const [name, title] of MAPS) {
            const input = make("input", { type: "file", id: `${name}-map`, accept: "image/*" });
            input.addEventListener("change", () => this.map(name, input.files[0], input));
            const gone = make("button", { type: "button", id: `${name}-gone`, hidden: true, title: `Without the ${name} map` }, "×");
            gone.addEventListener("click", () => this.map(name, null));
            at("maps").append(make("span", {}, make("label", { class: "open plain", for: `${name}-map`, title }, `${name} map`, input), make("output", { id: `${name}-name`, for: `${name}-map` }), gone));
        }
        this.tell();
    }

    /** Adds materials; says which is none. */
    take(added) {
        const all = [...this.materials, ...added];
        if (all.length >= MOST_MATERIALS) return this.say(`A palette of ${MOST_MATERIALS} materials at most is expected.`);
        try {
            this.tracer()?.setPalette(all);
        } catch (error) {
            return this.say(error.message);
        }
        this.materials = all;
        this.say(null);
        this.tell();
    }

    async read(files, input) {
        try {
            const read = async (file) => {
                if (file.size > MOST_BYTES) throw new Error(`${file.name}: a .srbf file of at most ${MOST_BYTES} bytes is expected`);
                const bytes = new Uint8Array(await file.arrayBuffer());
                checkHead(bytes, bytes.length, file.name);
                return { name: file.name.replace(/\.srbf$/, ""), bytes };
            };
            this.take(await Promise.all(files.map(read)));
        } catch (error) {
            this.say(error.message);
        }
        input.value = "";
    }

    /** Takes a map from a file, or takes it away. */
    async map(name, file, input) {
        try {
            if (file && file.size > MOST_PICTURE) throw new Error(`a picture of at most ${MOST_PICTURE} bytes is expected`);
            const picture = file && await createImageBitmap(file, { premultiplyAlpha: "none", colorSpaceConversion: "none" }).catch(() => { throw new Error("a picture is expected, such as a PNG"); });
            if (name === "index") this.most = picture ? numbersOf(picture) : 0;
            this.tracer()?.setMap(name, picture ?? null);
            if (file) this.names[name] = file.name;
            else delete this.names[name];
            this.say(null);
        } catch (error) {
            this.say(`${name} map ${file.name}: ${error.message}`);
        }
        if (input) input.value = "";
        this.tell();
    }

    /** Takes a material away. */
    drop(n) {
        this.materials.splice(n, 1);
        this.tracer()?.setPalette(this.materials);
        this.say(null);
        this.tell();
    }

    /** Shows what there is. */
    tell(first = this.first) {
        const { at, make } = this;
        this.first = first;
        const row = (name, n) => {
            const gone = make("button", { type: "button", title: `Without ${this.titled(name)}` }, "×");
            gone.addEventListener("click", () => this.drop(n));
            return make("li", {}, this.titled(name), gone);
        };
        const own = make("li", {}, `${this.titled(first ?? "")} (shown)`);
        at("palette-list").replaceChildren(own, ...this.materials.map(({ name }, n) => row(name, n)));
        for (const [name] of MAPS) {
            at(`${name}-name`).textContent = this.names[name] ?? "";
            at(`${name}-gone`).hidden = !this.names[name];
        }
        at("mix-part").hidden = this.materials.length === 0 || Boolean(this.names.index || this.names.weight);
        at("mix-text").textContent = `${Math.round(100 * Number(at("mix").value))} %`;
        if (this.names.index && this.most > this.materials.length) this.say(`index map ${this.names.index}: material ${this.most} of a palette from 0 to ${this.materials.length}; the last is shown there`);
        this.changed();
    }
}
