// Pictures of numbers: Radiance and PNG files are written, EXR files of `srbf render` are read.

import { deflateSync } from "node:zlib";

/** A PNG of rows of red, green, blue, bytes, from the top. */
export function png(rows) {
    const table = Array.from({ length: 256 }, (_, n) => { for (let bit = 0; bit < 8; bit++) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1; return n >>> 0; });
    const chunk = (kind, content) => {
        const body = Buffer.concat([Buffer.from(kind, "latin1"), content]), frame = Buffer.alloc(8);
        frame.writeUInt32BE(content.length);
        frame.writeUInt32BE(~body.reduce((sum, byte) => table[(sum ^ byte) & 255] ^ (sum >>> 8), ~0) >>> 0, 4);
        return Buffer.concat([frame.subarray(0, 4), body, frame.subarray(4)]);
    };
    const head = Buffer.alloc(13);
    head.writeUInt32BE(rows[0].length);
    head.writeUInt32BE(rows.length, 4);
    head.set([8, 2], 8);
    const pixels = Buffer.concat(rows.map((row) => Buffer.from([0, ...row.flat()])));
    return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head), chunk("IDAT", deflateSync(pixels)), chunk("IEND", Buffer.alloc(0))]);
}

/** A latitude-longitude map of numbers, four a pixel, as a Radiance file without runs. */
export function radiance(numbers, width, height) {
    const head = Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
    const pixels = Buffer.alloc(4 * width * height);
    for (let i = 0; i < width * height; i++) {
        const most = Math.max(numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]);
        if (most < 1e-30) continue;
        const exponent = Math.floor(Math.log2(most)) + 1;
        for (let c = 0; c < 3; c++) pixels[4 * i + c] = Math.min(Math.round(numbers[4 * i + c] * 2 ** (8 - exponent)), 255);
        pixels[4 * i + 3] = exponent + 128;
    }
    return Buffer.concat([head, pixels]);
}

/** Runs of bytes, as EXR packs them. */
function unpacked(bytes, size) {
    const out = Buffer.alloc(size);
    for (let from = 0, to = 0; from < bytes.length;) {
        const count = bytes.readInt8(from++);
        if (count < 0) {
            bytes.copy(out, to, from, from - count);
            [from, to] = [from - count, to - count];
        } else {
            out.fill(bytes[from++], to, to + count + 1);
            to += count + 1;
        }
    }
    // Differences, then the first halves of numbers before the second.
    for (let i = 1; i < size; i++) out[i] = (out[i - 1] + out[i] - 128) & 255;
    const whole = Buffer.alloc(size);
    const half = (size + 1) >> 1;
    for (let i = 0; i < size; i++) whole[i] = out[(i >> 1) + (i & 1) * half];
    return whole;
}

/** Red, green, blue of an EXR file of `srbf render`, which has tiles, rows from the top: `{ width, height, pixels }`. */
export function exr(bytes) {
    let at = 8, width = 0, height = 0, compression = -1, side = 0;
    const word = () => {
        const end = bytes.indexOf(0, at), text = bytes.toString("latin1", at, end);
        at = end + 1;
        return text;
    };
    for (let name = word(); name !== ""; name = word()) {
        word();
        const size = bytes.readInt32LE(at);
        at += 4;
        if (name === "dataWindow") [width, height] = [bytes.readInt32LE(at + 8) - bytes.readInt32LE(at) + 1, bytes.readInt32LE(at + 12) - bytes.readInt32LE(at + 4) + 1];
        if (name === "compression") compression = bytes[at];
        if (name === "tiles") side = bytes.readInt32LE(at);
        at += size;
    }
    if (compression !== 1 || side === 0) throw new Error(`EXR of compression ${compression}, tiles of ${side}: runs and tiles are expected`);
    const pixels = new Float32Array(3 * width * height);
    const count = Math.ceil(width / side) * Math.ceil(height / side);
    for (let tile = 0; tile < count; tile++) {
        const start = Number(bytes.readBigUInt64LE(at + 8 * tile));
        const [left, top] = [side * bytes.readInt32LE(start), side * bytes.readInt32LE(start + 4)];
        const [across, down, size] = [Math.min(side, width - left), Math.min(side, height - top), bytes.readInt32LE(start + 16)];
        const packed = bytes.subarray(start + 20, start + 20 + size);
        const all = size < 12 * across * down ? unpacked(packed, 12 * across * down) : packed;
        // Line by line, in each the channels by the alphabet: blue, green, red.
        for (let y = 0; y < down; y++) {
            for (let c = 0; c < 3; c++) {
                for (let x = 0; x < across; x++) pixels[3 * ((top + y) * width + left + x) + 2 - c] = all.readFloatLE(4 * ((3 * y + c) * across + x));
            }
        }
    }
    return { width, height, pixels };
}
