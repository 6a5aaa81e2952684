// A tree of boxes round triangles, laid out for a shader that walks it without a stack. It imports nothing.

const LEAF = 4; // most triangles of a leaf

/** Numbers in base64 as the text of the page has them. */
export function floats(text) { return new Float32Array(decoded(text).buffer); }
export function integers(text) { return new Uint32Array(decoded(text).buffer); }
export function decoded(text) { return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)); }

/**
 * Texels of four numbers. A node has two: the least corner and the node behind its subtree; the largest corner, and for a leaf
 * 8 * first triangle + their number, else -1. The first child of a node follows it. A triangle has six: a corner, two edges, three normals.
 */
export function tree(positions, normals, triangles) {
    const count = triangles.length / 3;
    const place = (t, k, axis) => positions[3 * triangles[3 * t + k] + axis];
    const middles = new Float32Array(3 * count);
    for (let t = 0; t < count; t++) {
        for (let a = 0; a < 3; a++) middles[3 * t + a] = (place(t, 0, a) + place(t, 1, a) + place(t, 2, a)) / 3;
    }
    const order = Uint32Array.from({ length: count }, (_, t) => t);
    const nodes = [];
    const grow = (from, to) => {
        const index = nodes.length / 8;
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
        const spread = [[Infinity, -Infinity], [Infinity, -Infinity], [Infinity, -Infinity]];
        for (let i = from; i < to; i++) {
            for (let a = 0; a < 3; a++) {
                for (let k = 0; k < 3; k++) {
                    low[a] = Math.min(low[a], place(order[i], k, a));
                    high[a] = Math.max(high[a], place(order[i], k, a));
                }
                spread[a] = [Math.min(spread[a][0], middles[3 * order[i] + a]), Math.max(spread[a][1], middles[3 * order[i] + a])];
            }
        }
        const isLeaf = to - from <= LEAF;
        nodes.push(...low, 0, ...high, isLeaf ? 8 * from + (to - from) : -1);
        if (!isLeaf) {
            const widths = spread.map(([a, b]) => b - a);
            const axis = widths.indexOf(Math.max(...widths));
            order.subarray(from, to).sort((a, b) => middles[3 * a + axis] - middles[3 * b + axis]);
            const middle = (from + to) >> 1;
            grow(from, middle);
            grow(middle, to);
        }
        nodes[8 * index + 3] = nodes.length / 8;
    };
    grow(0, count);
    const corners = new Float32Array(24 * count);
    order.forEach((t, i) => {
        for (let a = 0; a < 3; a++) {
            const at = (k) => place(t, k, a);
            corners[24 * i + a] = at(0);
            corners[24 * i + 4 + a] = at(1) - at(0);
            corners[24 * i + 8 + a] = at(2) - at(0);
            for (let k = 0; k < 3; k++) corners[24 * i + 12 + 4 * k + a] = normals[3 * triangles[3 * t + k] + a];
        }
    });
    return { nodes: Float32Array.from(nodes), corners };
}
