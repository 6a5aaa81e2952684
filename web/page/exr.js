// OpenEXR pictures (.exr) of scan lines or tiles, and the one function that reads light of either format. Every bound is checked; no browser is needed.
import { MOST_PIXELS, MOST_SIDE, isRadiance, radiance } from "./radiance.js";

const isExr = (bytes) => [0x76, 0x2f, 0x31, 1].every((byte, n) => bytes[n] === byte);
/** Whether the first bytes are those of a picture that `lightOf` reads. */
export const isLight = (bytes) => isRadiance(bytes) || isExr(bytes);

/** Red, green, blue and 1 of each pixel of a Radiance or OpenEXR file, as `radiance` gives them. */
export async function lightOf(bytes, name) {
    if (isRadiance(bytes)) return radiance(bytes, name);
    if (!isExr(bytes)) throw new Error(`${name}: a picture of Radiance (.hdr) or OpenEXR (.exr) is expected`);
    const { width, height, numbers } = await exr(bytes, name);
    let largest = 0;
    for (const value of numbers) if (value > largest && value < Infinity) largest = value;
    for (let i = 0; i < numbers.length; i++) {
        if (numbers[i] >= 0 && numbers[i] < Infinity) continue;
        if (!(numbers[i] >= -BELOW * largest && numbers[i] < Infinity)) {
            throw new Error(`${name}: column ${(i >> 2) % width}, row ${Math.floor((i >> 2) / width)}: a number of 0 or more is expected, ${numbers[i]} is there`);
        }
        numbers[i] = 0;
    }
    return { width, height, numbers };
}

// Rows of a block; the decoder, or a name alone of those that are not read. An unnamed one is of no known format.
const COMPRESSIONS = [[1, "none"], [1, "RLE", unpacked], [1, "ZIPS", inflated], [16, "ZIP", inflated], [32, "PIZ", unwound], [16, "PXR24"], [32, "B44"], [32, "B44A"], [32, "DWAA"], [256, "DWAB"]];
const CONVERT = "`oiiotool FILE.exr --scanline --compression zip -o OUT.exr` writes one that is read";
// No compression above makes bytes shorter by more, so that no short file asks for much memory.
const MOST_RATIO = 1100;
const MOST_BLOCK = 1 << 29, MOST_NAME = 255, MOST_CHANNELS = 1024;
// How far below 0 a value may be, over the largest: compression with losses leaves such, as `srbf render` allows.
const BELOW = 0.01;

/** The same of an OpenEXR file, whose numbers may be any. */
export async function exr(bytes, name) {
    const expect = (holds, what) => { if (!holds) throw new Error(`${name}: ${what}`); };
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 8;
    const need = (count, what) => expect(count >= 0 && at + count <= bytes.length, `the file ends within ${what}`);
    const word = () => {
        const end = bytes.subarray(0, at + MOST_NAME + 1).indexOf(0, at);
        expect(end >= 0, `a name in its head has no end in ${MOST_NAME} bytes`);
        const text = String.fromCharCode(...bytes.subarray(at, end));
        at = end + 1;
        return text;
    };
    need(0, "its head");
    const flags = view.getUint32(4, true);
    expect((flags & 255) === 2, `version 2 of the format is expected, ${flags & 255} is there`);
    expect((flags & 0x1800) === 0, `one part with plain pixels is expected; parts and deep pixels are not read: \`oiiotool FILE.exr --subimage 0 -o OUT.exr\` takes the first part`);
    const isTiled = (flags & 0x200) !== 0, channels = [];
    let [window, compression, tile] = [null, -1, null];
    for (let key = word(); key !== ""; key = word()) {
        word();
        need(4, "its head");
        const size = view.getInt32(at, true), next = (at += 4) + size;
        need(size, `its attribute ${JSON.stringify(key)}`);
        const is = (wanted, least) => { if (key === wanted) expect(size >= least, `its attribute ${wanted} has ${size} bytes, not ${least}`); return key === wanted; };
        if (is("dataWindow", 16)) window = [0, 4, 8, 12].map((n) => view.getInt32(at + n, true));
        if (is("compression", 1)) compression = bytes[at];
        if (is("tiles", 9)) tile = [view.getUint32(at, true), view.getUint32(at + 4, true)];
        if (is("channels", 1)) {
            for (let title = word(); title !== ""; title = word()) {
                need(16, "its channels");
                const [type, across, down] = [0, 8, 12].map((n) => view.getInt32(at + n, true));
                expect(type >= 0 && type <= 2 && channels.length < MOST_CHANNELS, `channel ${JSON.stringify(title)}: a type from 0 to 2 is expected, and at most ${MOST_CHANNELS} channels`);
                expect(across === 1 && down === 1, `channel ${JSON.stringify(title)} has fewer samples than pixels; ${CONVERT}`);
                channels.push({ title, type, bytes: type === 1 ? 2 : 4 });
                at += 16;
            }
        }
        at = next;
    }
    expect(window && compression >= 0 && channels.length > 0 && (tile || !isTiled), `dataWindow, compression, channels${isTiled ? " and tiles" : ""} are expected in its head`);
    const [rows, method, decode] = COMPRESSIONS[compression] ?? [];
    expect(decode || compression === 0, `a compression by none, RLE, ZIPS, ZIP or PIZ is expected, ${method ?? compression} is there; ${CONVERT}`);
    const [left, top] = window, width = window[2] - left + 1, height = window[3] - top + 1;
    expect(width >= 1 && height >= 1 && Math.max(width, height) <= MOST_SIDE && width * height <= MOST_PIXELS, `a size from 1 x 1 to ${MOST_SIDE} along a side and ${MOST_PIXELS} pixels is expected, ${width} x ${height} is there`);
    const wanted = ["RGB", "YYY"].map((titles) => [...titles].map((title) => channels.findIndex((c) => c.title === title))).find((found) => found.every((n) => n >= 0));
    expect(wanted && wanted.every((n) => channels[n].type > 0), `channels R, G and B, or Y, of real numbers are expected; ${channels.slice(0, 8).map((c) => c.title.slice(0, 40)).join(", ")} are there`);

    // Blocks are whole rows, or tiles; a column of blocks after another would be of a picture of lower resolution.
    let [across, down] = [width, rows];
    if (isTiled) {
        expect(tile[0] >= 1 && tile[1] >= 1 && Math.max(...tile) <= MOST_SIDE, `tiles from 1 x 1 to ${MOST_SIDE} along a side are expected, ${tile.join(" x ")} is there`);
        [across, down] = tile;
    }
    const wide = Math.ceil(width / across), count = wide * Math.ceil(height / down), head = isTiled ? 20 : 8, table = at;
    const deep = channels.reduce((sum, c) => sum + c.bytes, 0);
    need((8 + head) * count, `the table of its ${count} blocks`);
    expect(bytes.length * MOST_RATIO >= width * height * deep, `${bytes.length} bytes are too few for ${width} x ${height} pixels of ${channels.length} channels`);
    expect(Math.min(across, width) * Math.min(down, height) * deep <= MOST_BLOCK, `blocks of at most ${MOST_BLOCK} bytes are expected; ${CONVERT}`);
    const numbers = new Float32Array(4 * width * height).fill(1);
    halves ??= halfTable();
    for (let n = 0; n < count; n++) {
        const [column, row] = [n % wide, Math.floor(n / wide)], block = `block ${n} of ${count}`;
        const [x0, y0] = [column * across, row * down], [w, h] = [Math.min(across, width - x0), Math.min(down, height - y0)];
        at = Number(view.getBigUint64(table + 8 * n, true));
        need(head, `the table or ${block}`);
        const place = isTiled ? [0, 4, 8, 12].map((k) => view.getInt32(at + k, true)) : [view.getInt32(at, true) - top];
        expect(place.join() === (isTiled ? [column, row, 0, 0] : [y0]).join(), `${block} is of another place`);
        const size = view.getUint32(at + head - 4, true), whole = w * h * deep;
        at += head;
        need(size, block);
        const packed = bytes.subarray(at, at + size), isPlain = size === whole;
        expect(isPlain || (decode && size < whole), `${block}: ${size} bytes where ${whole} are the most`);
        const pixels = isPlain ? packed : await decode(packed, whole, { w, h, channels });
        expect(pixels, `${block} is damaged`);
        const from = new DataView(pixels.buffer, pixels.byteOffset, whole);
        for (let y = 0, start = 0; y < h; y++) {
            for (const [k, { type, bytes: step }] of channels.entries()) {
                for (let c = 0; c < 3; c++) {
                    if (wanted[c] !== k) continue;
                    let to = 4 * ((y0 + y) * width + x0) + c;
                    if (type === 1) for (let x = 0; x < w; x++, to += 4) numbers[to] = halves[from.getUint16(start + 2 * x, true)];
                    else for (let x = 0; x < w; x++, to += 4) numbers[to] = from.getFloat32(start + 4 * x, true);
                }
                start += step * w;
            }
        }
    }
    return { width, height, numbers };
}

let halves = null; // made when a picture has some

/** Numbers of 16 bits by their bits. */
function halfTable() {
    return Float32Array.from({ length: 1 << 16 }, (_, bits) => {
        const power = (bits >> 10) & 31, rest = bits & 1023, sign = bits & 0x8000 ? -1 : 1;
        return sign * (power === 31 ? (rest ? NaN : Infinity) : power ? (1 + rest / 1024) * 2 ** (power - 15) : rest * 2 ** -24);
    });
}

/** Bytes of which differences were stored, the first halves of numbers before the second. */
function summed(out) {
    for (let i = 1; i < out.length; i++) out[i] += out[i - 1] - 128;
    const whole = new Uint8Array(out.length), half = (out.length + 1) >> 1;
    for (let i = 0; i < out.length; i++) whole[i] = out[(i >> 1) + (i & 1) * half];
    return whole;
}

// Decoders give the bytes of a block, or null where they are damaged.

/** Runs of one byte, and bytes as they are. */
function unpacked(packed, size) {
    const out = new Uint8Array(size);
    let [from, to] = [0, 0];
    while (from < packed.length) {
        const code = packed[from++], isRun = code < 128, count = isRun ? code + 1 : 256 - code;
        if (to + count > size || from + (isRun ? 1 : count) > packed.length) return null;
        if (isRun) out.fill(packed[from++], to, to + count);
        else out.set(packed.subarray(from, (from += count)), to);
        to += count;
    }
    return to === size ? summed(out) : null;
}

/** Bytes of the format of zlib. */
async function inflated(packed, size) {
    const out = new Uint8Array(size), parts = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
    try {
        for (let to = 0; ;) {
            const { done, value } = await parts.read();
            if (done) return to === size ? summed(out) : null;
            if (to + value.length > size) {
                await parts.cancel();
                return null;
            }
            out.set(value, to);
            to += value.length;
        }
    } catch {
        return null;
    }
}

/** Wavelets over Huffman codes (PIZ). */
function unwound(packed, size, { w, h, channels }) {
    const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
    const [MAP, HEAD] = [1 << 13, 20];
    if (packed.length < 8) return null;
    // The values that occur: their numbers are coded.
    const [first, last] = [view.getUint16(0, true), view.getUint16(2, true)], bits = Math.max(last - first + 1, 0);
    if (first >= MAP || last >= MAP || packed.length < 4 + bits + 4 + HEAD) return null;
    const values = new Uint16Array(1 << 16);
    let known = 0;
    for (let v = 0; v < 1 << 16; v++) if (v === 0 || (packed[4 + (v >> 3) - first] >> (v & 7) & 1 && v >> 3 >= first && v >> 3 <= last)) values[known++] = v;
    const words = huffman(packed.subarray(8 + bits), size / 2);
    if (!words) return null;
    // A plane for each channel; the two halves of a number of 32 bits are planes within each other.
    let start = 0;
    for (const { bytes } of channels) {
        const step = bytes / 2;
        for (let k = 0; k < step; k++) unfolded(words, start + k, [w, step], [h, step * w], known <= 1 << 14);
        start += step * w * h;
    }
    const out = new DataView(new ArrayBuffer(size));
    for (let y = 0, to = 0; y < h; y++) {
        let plane = 0;
        for (const { bytes } of channels) {
            const row = (bytes / 2) * w;
            for (let x = 0; x < row; x++, to += 2) out.setUint16(to, values[words[plane + y * row + x]], true);
            plane += row * h;
        }
    }
    return new Uint8Array(out.buffer);
}

/** The `count` numbers of a stream of Huffman codes of PIZ, or null. */
function huffman(packed, count) {
    const [QUICK, LONGEST, HEAD, ZEROS, MANY_ZEROS, CODES] = [14, 52, 20, 59, 63, (1 << 16) + 1];
    if (packed.length < HEAD) return null;
    const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
    const [low, high, , total] = [0, 4, 8, 12].map((n) => view.getUint32(n, true));
    if (low >= CODES || high >= CODES || low > high) return null;
    // Zeros behind the end, so that the bits of the last byte and of those after it can be taken.
    const bytes = new Uint8Array(packed.length - HEAD + 4);
    bytes.set(packed.subarray(HEAD));
    let at = 0, end = 8 * (packed.length - HEAD);
    const peek = (n) => ((bytes[at >> 3] << 16 | bytes[(at >> 3) + 1] << 8 | bytes[(at >> 3) + 2]) >> (24 - (at & 7) - n)) & ((1 << n) - 1);
    const take = (n) => { const found = peek(n); at += n; return found; };
    // The length of each code; runs have none.
    const lengths = new Uint8Array(CODES), counts = new Float64Array(LONGEST + 2);
    for (let code = low; code <= high;) {
        if (at + 6 > end) return null;
        const length = take(6);
        if (length >= ZEROS) {
            code += length === MANY_ZEROS ? take(8) + 2 + MANY_ZEROS - ZEROS : length - ZEROS + 2;
            if (at > end || code > high + 1) return null;
        } else if (length > LONGEST) {
            return null;
        } else {
            lengths[code++] = length;
            counts[length] += 1;
        }
    }
    // Codes of a length follow each other, after those of longer ones; then codes by length, and quick ones by their bits.
    const starts = new Float64Array(LONGEST + 2), places = new Uint32Array(LONGEST + 2), next = new Float64Array(LONGEST + 2);
    for (let length = LONGEST; length >= 1; length--) {
        starts[length] = Math.floor((starts[length + 1] + counts[length + 1]) / 2);
        if (starts[length] + counts[length] > 2 ** length) return null;
    }
    for (let length = 1; length <= LONGEST; length++) places[length + 1] = places[length] + counts[length];
    const sorted = new Uint32Array(CODES), quick = new Uint32Array(1 << QUICK);
    for (let code = low; code <= high; code++) {
        const length = lengths[code];
        if (length === 0) continue;
        const bits = starts[length] + next[length];
        sorted[places[length] + next[length]++] = code;
        if (length <= QUICK) quick.fill(code << 4 | length, bits << (QUICK - length), (bits + 1) << (QUICK - length));
    }
    at = (at + 7) & ~7;
    if (total > end - at) return null;
    end = at + total;
    const out = new Uint16Array(count);
    for (let to = 0; to < count;) {
        const found = quick[peek(QUICK)];
        let code = -1;
        if (found) {
            at += found & 15;
            code = found >>> 4;
        } else {
            let bits = take(QUICK);
            for (let length = QUICK + 1; length <= LONGEST && at < end; length++) {
                bits = 2 * bits + take(1);
                const place = bits - starts[length];
                if (place >= 0 && place < counts[length]) {
                    code = sorted[places[length] + place];
                    break;
                }
            }
            if (code < 0) return null;
        }
        if (code === high) {
            const repeats = take(8);
            if (to === 0 || to + repeats > count || at > end) return null;
            out.fill(out[to - 1], to, to + repeats);
            to += repeats;
        } else {
            out[to++] = code;
        }
        if (at > end) return null;
    }
    return at === end ? out : null;
}

/** Sums and differences back to values, from the coarsest to the finest, of a plane within `words`: along a side, places and the step between them. */
function unfolded(words, start, [nx, ox], [ny, oy], isNarrow) {
    const pair = isNarrow
        ? (a, b) => {
            const low = words[a] << 16 >> 16, high = words[b] << 16 >> 16, sum = low + (high & 1) + (high >> 1);
            words[a] = sum;
            words[b] = sum - high;
        }
        : (a, b) => {
            const low = (words[a] - (words[b] >> 1)) & 65535;
            words[a] = words[b] + low - 32768;
            words[b] = low;
        };
    for (let far = 1 << (31 - Math.clz32(Math.min(nx, ny))); far >= 2; far /= 2) {
        const near = far / 2;
        let y = 0;
        for (; y + far <= ny; y += far) {
            let x = 0;
            for (; x + far <= nx; x += far) {
                const a = start + y * oy + x * ox, right = a + near * ox, below = a + near * oy;
                pair(a, below);
                pair(right, below + near * ox);
                pair(a, right);
                pair(below, below + near * ox);
            }
            if (nx & near) pair(start + y * oy + x * ox, start + (y + near) * oy + x * ox);
        }
        if (ny & near) for (let x = 0; x + far <= nx; x += far) pair(start + y * oy + x * ox, start + y * oy + (x + near) * ox);
    }
}
