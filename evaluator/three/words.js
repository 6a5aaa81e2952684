// The words of a .srbf file, checked. It imports nothing, and needs no browser.

/** Bytes at the beginning of a file that tell a material and its length. */
export const HEAD_BYTES = 20;

/** Most bytes of a material that is read: the largest have some megabytes. */
export const MOST_BYTES = 1 << 26;

/** Names of the quarters of a sheet: reflection and transmission, seen from the front and from the back. */
export const QUARTERS = ["front-reflection", "front-transmission", "back-reflection", "back-transmission"];

const LEAST_BYTES = 60, MAGIC = [0x42525389, 0x1a0a0d46], LOBE = 0x45424f4c, FACT = 0x54434146, PACK = 0x4b434150;
const SHEET = 2, SHARES = 0x52414853, TAGS = [0x46455246, 0x41525446, 0x46455242, 0x41525442];

function crc32(bytes) {
    let crc = ~0;
    for (const byte of bytes) {
        crc ^= byte;
        for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc >>> 0;
}

/**
 * The length that the first bytes of a material announce. Throws an error where they are no material's: no more need be read or copied then.
 * @param {Uint8Array} head HEAD_BYTES bytes or more
 */
export function announcedLength(head, name) {
    const expected = `a .srbf file of ${LEAST_BYTES} to ${MOST_BYTES} bytes is expected`;
    const view = new DataView(head.buffer, head.byteOffset, head.length);
    const begins = head.length >= HEAD_BYTES && MAGIC.every((word, i) => view.getUint32(4 * i, true) === word);
    if (!begins) throw new Error(`${name}: ${expected}`);
    const length = view.getUint32(16, true);
    if (length < LEAST_BYTES || length > MOST_BYTES) throw new Error(`${name}: ${expected}, ${length} are announced`);
    return length;
}

/** Throws an error unless a file of `size` bytes begins as a material of that length. */
export function checkHead(head, size, name) {
    const length = announcedLength(head, name);
    if (length !== size) throw new Error(`${name}: ${length} bytes are expected, ${size} are there`);
}

/** The bytes of a material that a request is answered with. Of another answer the rest is not taken. */
export async function received(answer, name) {
    const joined = (parts, count) => {
        const all = new Uint8Array(count);
        parts.reduce((at, part) => (all.set(part, at), at + part.length), 0);
        return all;
    };
    const reader = answer.body.getReader();
    let parts = [], count = 0, length = Infinity;
    try {
        for (;;) {
            const { done, value } = await reader.read();
            if (!done) {
                parts.push(value);
                count += value.length;
            }
            if (length === Infinity && (done || count >= HEAD_BYTES)) {
                parts = [joined(parts, count)];
                length = announcedLength(parts[0], name);
            }
            if (count > length) throw new Error(`${name}: ${length} bytes are expected, more are there`);
            if (done) return joined(parts, count);
        }
    } finally {
        reader.cancel().catch(() => {});
    }
}

/** Throws an error unless the words are those of a material that the shader can read without leaving them, and its numbers mean something. */
function check(words, length, name) {
    const expect = (holds, what) => { if (!holds) throw new Error(`${name}: ${what}`); };
    const within = (i, least, most, what) =>
        expect(words[i] >= least && words[i] <= most, `${what}: ${words[i]} is not from ${least} to ${most}`);
    within(2, 2, 3, "format version");
    within(3, 0, 1, "kind");
    const isPacked = words[2] === 3 && words[10] === PACK;
    expect(!isPacked, "its numbers are codes; srbf pack FILE --bits 32 writes plain ones");
    within(5, 1, 1024, "angles of the views");
    within(6, 1, 64, "lobes");
    within(7, 0, words[6], "squeezed lobes");
    const isOld = words[2] === 2, isLine = words[3] === 0, ring = isOld ? 9 : 8;
    if (isLine) within(ring, 0, Math.min(words[6] - words[7], 64 - words[6]), "mirrored lobes");
    else {
        const turns = words[ring + 1] & 65535;
        expect([1, 2, 4].includes(turns), `turns: ${turns} is not 1, 2 or 4`);
        within(ring, turns === 4 ? 2 : 1, 64, "views of a ring");
    }
    const [angles, lobes] = [words[5], words[6]];
    const views = isLine ? angles : 1 + (angles - 1) * words[ring];
    const head = isLine ? 4 : 6, row = isLine ? 5 * lobes + words[ring] : 6 * lobes;
    const rows = 12 + angles + views * head, endOfLobes = rows + views * row;
    const end = Math.floor(length / 4);
    expect(views <= 4096 && endOfLobes < end, "its views are longer than the file");
    // The ranges of the format, a little wider where a rounding decides. A NaN is in none.
    const numbers = new Float32Array(words.buffer, words.byteOffset, words.length);
    const range = (i, count, least, most) => {
        for (; count-- > 0; i++) expect(numbers[i] >= least && numbers[i] <= most, `word ${i}: ${numbers[i]} is not from ${least} to ${most}`);
    };
    const pi = 3.1415928;
    range(12, 1, 0, 0);
    for (let i = 13; i < 12 + angles; i++) range(i, 1, numbers[i - 1], pi / 2);
    for (let view = 0; view < views; view++) {
        const own = 12 + angles + view * head, first = rows + view * row, most = view === 0 ? 0 : 1;
        if (isLine) {
            // At the normal nothing depends on an azimuth.
            range(own, 1, -6.6400001 * most, most);
            range(first, lobes, -pi * most, pi * most);
            range(first + 5 * lobes, words[ring], -pi / 2 * most, pi / 2 * most);
        } else {
            const [xx, xy, yy] = numbers.subarray(own), reach = Math.hypot((xx - yy) / 2, xy);
            expect((xx + yy) / 2 - reach >= -5.00001 && (xx + yy) / 2 + reach <= 6.64001, `word ${own}: a squeeze out of range`);
            for (let k = first; k < first + lobes; k++) expect(Math.hypot(numbers[k], numbers[k + lobes]) <= pi, `word ${k}: an axis out of range`);
        }
        range(own + head - 3, 1, -126, 2);
        range(own + head - 2, 2, -16, 16);
        const others = first + (isLine ? 1 : 2) * lobes;
        range(others, lobes, -100, 26.5);
        range(others + lobes, lobes, -126, 60);
        range(others + 2 * lobes, 2 * lobes, -16, 16);
    }
    let at = endOfLobes, nodes = [words[11] & 65535, words[11] >>> 16, 1];
    if (!isOld) {
        expect(length % 4 === 0 && words[10] === LOBE && words[11] === 4 * (endOfLobes - 12), "no block of lobes");
        while (at + 1 < end && words[at] !== FACT) {
            // Blocks that a reader may not leave out begin with a capital letter.
            expect(words[at] & 32 && words[at + 1] <= 4 * (end - at), `an unknown block at word ${at}`);
            at += 2 + Math.ceil(words[at + 1] / 4);
        }
        if (at + 1 >= end) return;
        nodes = [words[at + 2] & 255, (words[at + 2] >>> 8) & 255, (words[at + 2] >>> 16) & 255];
        at += 3;
    } else if (words[11] === 0) return;
    const inRange = nodes[0] >= 2 && nodes[0] <= 32 && nodes[1] >= 2 && nodes[1] <= 32 && nodes[2] >= 1 && nodes[2] <= 8;
    const count = nodes[0] * nodes[1] * nodes[2];
    const endOfNodes = at + 3 * views + 1 + (isOld ? count : Math.ceil((3 * count) / 4));
    expect(inRange && endOfNodes <= end, `its factors, ${nodes.join(" x ")}, do not fit into the file`);
    range(at, 3 * views, -16, 16);
    range(at + 3 * views, 1, numbers[at + 3 * views] === 0 ? 0 : 9.99e-21, 8.0831);
}

/** Words before each quarter of a sheet, 0 for one that is black; null for a material. */
export function quartersOf(words) {
    if (words[3] !== SHEET) return null;
    const places = [0, 0, 0, 0], end = words[4] / 4 - 1;
    for (let at = 20; at < end; at += 2 + Math.ceil(words[at + 1] / 4)) {
        const quarter = TAGS.indexOf(words[at]);
        if (quarter >= 0) places[quarter] = at + 2;
    }
    return words[5] === 1 ? [...places.slice(0, 2), ...places.slice(0, 2)] : places;
}

/** Throws an error unless the words are those of a sheet, each quarter of which is a material. */
function checkSheet(words, length, name, checkMaterial) {
    const expect = (holds, what) => { if (!holds) throw new Error(`${name}: ${what}`); };
    expect(words[2] === 3 && words[5] <= 1 && length % 4 === 0 && length >= 84, "the head of a sheet is expected");
    expect(words[10] === SHARES && words[11] === 32, "no block of shares");
    const end = length / 4 - 1, has = [];
    for (let at = 20; at < end;) {
        const size = words[at + 1], quarter = TAGS.indexOf(words[at]);
        expect(at + 1 < end && size <= 4 * (end - at - 2), `a block at word ${at} that is longer than the file`);
        expect(quarter >= 0 || words[at] & 32, `an unknown block at word ${at}`);
        const next = at + 2 + Math.ceil(size / 4);
        if (quarter >= 0) {
            const own = words.subarray(at + 2, next), of = `${name}, ${QUARTERS[quarter]}`;
            expect(!has.includes(quarter) && !(words[5] === 1 && quarter > 1), `a quarter at word ${at} that is there already`);
            expect(size >= LEAST_BYTES && MAGIC.every((word, i) => own[i] === word) && own[4] === size, `no material at word ${at}`);
            checkMaterial(own, size, of);
            has.push(quarter);
        }
        at = next;
    }
    expect(has.length > 0, "no quarters");
    const shares = (side) => Array.from({ length: 16 }, (_, i) => (words[12 + 4 * side + (i >> 2)] >>> (8 * (i & 3))) & 255);
    for (const side of words[5] === 1 ? [0] : [0, 1]) {
        const hasBoth = [0, 1].every((part) => has.includes(2 * side + part));
        expect(!hasBoth || shares(side).every((share) => share > 0 && share < 255), "a share of draws that is none");
    }
}

/**
 * The little-endian words of a .srbf file, a material's or a sheet's, with zeros up to a whole number of rows.
 * @param {ArrayBuffer | Uint8Array} data the file
 * @param {string} name how errors call it
 * @param {number} row words of a row
 * @param checkMaterial what throws an error of a material: of one that no shader can read, unless it is given
 */
export function wordsOf(data, name, row, checkMaterial = check) {
    const bytes = data instanceof ArrayBuffer ? new Uint8Array(data) : data;
    checkHead(bytes, bytes.length, name);
    const padded = new Uint8Array(4 * row * Math.max(Math.ceil(bytes.length / (4 * row)), 1));
    padded.set(bytes);
    const view = new DataView(padded.buffer);
    const words = Uint32Array.from({ length: padded.length / 4 }, (_, i) => view.getUint32(4 * i, true));
    if (words[3] === SHEET) checkSheet(words, bytes.length, name, checkMaterial);
    else checkMaterial(words, bytes.length, name);
    const end = bytes.length - 4;
    if (crc32(bytes.subarray(0, end)) !== view.getUint32(end, true)) throw new Error(`${name}: the checksum does not fit: the bytes are damaged`);
    return words;
}
