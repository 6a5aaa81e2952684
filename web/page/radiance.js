// Radiance pictures (.hdr), read with every bound checked. It imports nothing, and needs no browser.

/** Most bytes of a file of light. */
export const MOST_LIGHT = 1 << 27;
/** Most pixels along a side. */
export const MOST_SIDE = 1 << 14;
/** Most pixels of all. */
export const MOST_PIXELS = 1 << 25;
const MOST_HEAD = 1 << 14;

/** Whether the first bytes are those of a Radiance picture. */
export const isRadiance = (bytes) => bytes[0] === 35 && bytes[1] === 63;

/**
 * Red, green, blue and 1 of each pixel, rows from the top: `{ width, height, numbers }`. Throws an error that names the place of a fault.
 * @param {Uint8Array} bytes
 * @param {string} name of the file
 */
export function radiance(bytes, name) {
    const expect = (holds, what) => { if (!holds) throw new Error(`${name}: ${what}`); };
    expect(isRadiance(bytes), "a Radiance picture (.hdr) is expected, whose first characters are #?");
    let at = 0, scale = 1, format = "";
    const line = () => {
        const end = bytes.indexOf(10, at);
        expect(end >= 0 && end < MOST_HEAD, `its head has no end in ${MOST_HEAD} bytes`);
        const text = String.fromCharCode(...bytes.subarray(at, end)).trim();
        at = end + 1;
        return text;
    };
    for (let text = line(); text !== ""; text = line()) {
        const [, key, value] = /^(\w+)\s*=\s*(.*)$/.exec(text) ?? [];
        if (key === "FORMAT") format = value;
        if (key === "EXPOSURE") scale /= Number(value);
    }
    expect(format === "" || format === "32-bit_rle_rgbe", `FORMAT=32-bit_rle_rgbe is expected, ${JSON.stringify(format.slice(0, 40))} is there`);
    expect(scale > 0 && Number.isFinite(scale), "EXPOSURE is expected to be a number above 0");
    const sizes = line(), [, down, across] = /^-Y (\d+) \+X (\d+)$/.exec(sizes) ?? [];
    expect(down, `the size is expected as "-Y HEIGHT +X WIDTH", ${JSON.stringify(sizes.slice(0, 40))} is there`);
    const [width, height] = [Number(across), Number(down)];
    expect(width >= 1 && height >= 1 && Math.max(width, height) <= MOST_SIDE && width * height <= MOST_PIXELS, `a size from 1 x 1 to ${MOST_SIDE} along a side and ${MOST_PIXELS} pixels is expected, ${width} x ${height} is there`);
    // A run of a whole row has 8 bytes at least, so that no short file asks for much memory.
    expect(bytes.length - at >= height * 4 * Math.ceil(width / 512), `${bytes.length} bytes are too few for ${width} x ${height} pixels`);
    const numbers = new Float32Array(4 * width * height), row = new Uint8Array(4 * width);
    const next = (y) => { expect(at < bytes.length, `the file ends in row ${y} of ${height}`); return bytes[at++]; };
    for (let y = 0; y < height; y++) {
        const isNew = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 && bytes[at + 2] < 128;
        if (isNew) {
            expect(bytes[at + 2] * 256 + bytes[at + 3] === width, `row ${y} is ${bytes[at + 2] * 256 + bytes[at + 3]} pixels long, not ${width}`);
            at += 4;
            // Each channel by itself: runs of one byte, and bytes as they are.
            for (let c = 0; c < 4; c++) {
                for (let x = 0; x < width;) {
                    const code = next(y), isRun = code > 128, count = isRun ? code - 128 : code;
                    expect(count > 0 && x + count <= width, `row ${y}: ${count} bytes at pixel ${x} of ${width}`);
                    const value = isRun ? next(y) : 0;
                    for (let i = 0; i < count; i++) row[4 * x++ + c] = isRun ? value : next(y);
                }
            }
        } else {
            // Pixels as they are; 1, 1, 1, n repeats the one before, and n of one such after another are digits.
            for (let x = 0, shift = 0; x < width;) {
                const pixel = [next(y), next(y), next(y), next(y)];
                if (pixel[0] === 1 && pixel[1] === 1 && pixel[2] === 1) {
                    const count = pixel[3] * 2 ** shift;
                    expect(x > 0 && x + count <= width, `row ${y}: ${count} repeats at pixel ${x} of ${width}`);
                    for (let i = 0; i < count; i++, x++) row.copyWithin(4 * x, 4 * x - 4, 4 * x);
                    shift += 8;
                } else {
                    row.set(pixel, 4 * x++);
                    shift = 0;
                }
            }
        }
        for (let x = 0; x < width; x++) {
            const power = row[4 * x + 3] === 0 ? 0 : scale * 2 ** (row[4 * x + 3] - 136), to = 4 * (y * width + x);
            for (let c = 0; c < 3; c++) numbers[to + c] = row[4 * x + c] * power;
            numbers[to + 3] = 1;
        }
    }
    return { width, height, numbers };
}
