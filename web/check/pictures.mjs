// Pictures of numbers as files of Radiance and PNG.

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
