// The lobes over the plane of incidence, as SVG. It imports nothing.

const NAMESPACE = "http://www.w3.org/2000/svg";
export const COLUMNS = 721; // angles of a curve
const DECADES = 4.5; // shown below the highest, on the logarithmic scale
const NEAR = 2.6; // degrees up to which points of a measurement belong to a view angle

function element(name, attributes = {}, text = null) {
    const made = document.createElementNS(NAMESPACE, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== null) made.textContent = text;
    return made;
}

/** The view of a measurement that is nearest to an angle, if one is near. */
export function nearest(data, degrees) {
    const views = data?.views ?? [];
    const best = views.reduce((a, b) => (a && Math.abs(a.degrees - degrees) <= Math.abs(b.degrees - degrees) ? a : b), null);
    return best && Math.abs(best.degrees - degrees) <= NEAR ? best : null;
}

function short(value) {
    return value >= 100 || value < 0.01 ? value.toExponential(0).replace("e+", "e").replace("e", "×10^") : String(Number(value.toPrecision(2)));
}

/**
 * Draws curves into an SVG element.
 * @param {SVGSVGElement} svg
 * @param {Float32Array[]} curves rows as the tracer gives them: all, each lobe, the diffuse term; four numbers an angle
 * @param {{ degrees: number, isLogarithmic: boolean, width: number, points: number[][], marked: ?number }} options
 */
export function draw(svg, curves, { degrees, isLogarithmic, width, points, marked }) {
    const height = Math.round(Math.min(Math.max(0.56 * width, 240), 380));
    const [left, right, top, bottom] = [46, 10, 26, 40];
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.setAttribute("height", height);
    svg.replaceChildren();
    const [all, ...parts] = curves;
    const luminance = (row) => Array.from({ length: COLUMNS }, (_, i) => row[4 * i]);
    const total = luminance(all);
    let high = Math.max(...total, ...points.map((p) => p[1]), 1e-6);
    high = isLogarithmic ? 10 ** Math.ceil(Math.log10(high) - 0.001) : 1.06 * high;
    const low = isLogarithmic ? high * 10 ** -DECADES : 0;
    const x = (angle) => left + ((angle + 90) / 180) * (width - left - right);
    const y = (value) => {
        const share = isLogarithmic ? (Math.log10(Math.max(value, 1e-30)) - Math.log10(low)) / DECADES : value / high;
        return top + (1 - Math.min(Math.max(share, -0.5), 1.02)) * (height - top - bottom);
    };
    const add = (parent, name, attributes, text) => parent.appendChild(element(name, attributes, text));

    const clip = `inside-${svg.id}`;
    const inside = add(add(svg, "defs"), "clipPath", { id: clip });
    add(inside, "rect", { x: left, y: top, width: width - left - right, height: height - top - bottom });
    const grid = add(svg, "g", { class: "grid" });
    for (const angle of width < 420 ? [-90, -45, 0, 45, 90] : [-90, -60, -30, 0, 30, 60, 90]) {
        add(grid, "line", { x1: x(angle), x2: x(angle), y1: top, y2: height - bottom });
        add(grid, "text", { x: x(angle), y: height - bottom + 16, "text-anchor": "middle" }, `${angle}°`);
    }
    const ticks = isLogarithmic
        ? Array.from({ length: Math.floor(DECADES) + 1 }, (_, i) => high * 10 ** -i)
        : Array.from({ length: 5 }, (_, i) => (i * high) / 4 / 1.06);
    for (const tick of ticks) {
        add(grid, "line", { x1: left, x2: width - right, y1: y(tick), y2: y(tick) });
        const label = short(tick).split("^");
        const text = add(grid, "text", { x: left - 6, y: y(tick) + 4, "text-anchor": "end" }, label[0]);
        if (label[1]) text.appendChild(element("tspan", { dy: -4, class: "power" }, label[1]));
    }
    add(grid, "text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, "angle of the light, in the plane of incidence");
    add(grid, "text", { x: left - 40, y: 12 }, "f cos, 1/sr");

    const mark = (angle, text, kind) => {
        const group = add(svg, "g", { class: `mark ${kind}` });
        add(group, "line", { x1: x(angle), x2: x(angle), y1: top, y2: height - bottom });
        const anchor = angle < -60 ? "start" : angle > 60 ? "end" : "middle";
        add(group, "text", { x: x(angle), y: top - 6, "text-anchor": anchor }, text);
    };
    if (degrees > 6) mark(-degrees, "viewer", "viewer");
    mark(degrees, degrees > 6 ? "mirror" : "viewer, mirror", "mirror");

    const path = (row) => {
        const values = luminance(row);
        let text = "", isDrawn = false;
        values.forEach((value, i) => {
            const isIn = isLogarithmic ? value > low * 0.3 : true;
            if (isIn) text += `${isDrawn ? "L" : "M"}${x((180 * i) / (COLUMNS - 1) - 90).toFixed(1)} ${y(value).toFixed(1)}`;
            isDrawn = isIn;
        });
        return text;
    };
    const drawn = add(svg, "g", { "clip-path": `url(#${clip})` });
    parts.forEach((row, i) => add(drawn, "path", { class: i === parts.length - 1 ? "part diffuse" : "part", d: path(row) }));
    const radius = points.length > 60 ? 1.9 : 2.6;
    for (const [angle, value] of points) {
        if (value > low) add(drawn, "circle", { class: "point", cx: x(angle).toFixed(1), cy: y(value).toFixed(1), r: radius });
    }
    add(drawn, "path", { class: "all", d: path(all) });
    if (marked !== null) {
        const at = { cx: x(marked), cy: y(total[columnOf(marked)]) };
        add(drawn, "line", { class: "marked", x1: at.cx, x2: at.cx, y1: at.cy, y2: height - bottom });
        add(drawn, "circle", { class: "marked", ...at, r: 4 });
    }
}

/** The place of an angle of the light in a curve. */
export const columnOf = (angle) => Math.round(((angle + 90) / 180) * (COLUMNS - 1));

/**
 * Draws a spectrum into an SVG element.
 * @param {SVGSVGElement} svg
 * @param {number[]} nm wavelengths, rising
 * @param {number[]} values f cos at these
 * @param {number} width
 */
export function drawSpectrum(svg, nm, values, width) {
    const height = Math.round(Math.min(Math.max(0.36 * width, 150), 240));
    const [left, right, top, bottom] = [46, 16, 20, 36];
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.setAttribute("height", height);
    svg.replaceChildren();
    const add = (name, attributes, text) => svg.appendChild(element(name, attributes, text));
    const [first, last] = [nm[0], nm[nm.length - 1]];
    const [low, high] = last > first ? [first, last] : [first - 50, first + 50];
    const most = 1.08 * Math.max(...values, 1e-9);
    const x = (at) => left + ((at - low) / (high - low)) * (width - left - right);
    const y = (value) => top + (1 - value / most) * (height - top - bottom);
    const step = [10, 20, 50, 100, 200, 500, 1000].find((step) => (high - low) / step <= (width < 420 ? 4 : 7)) ?? 2000;
    for (let at = Math.ceil(low / step) * step; at <= high; at += step) {
        const grid = svg.appendChild(element("g", { class: "grid" }));
        grid.append(element("line", { x1: x(at), x2: x(at), y1: top, y2: height - bottom }));
        grid.append(element("text", { x: x(at), y: height - bottom + 15, "text-anchor": "middle" }, String(at)));
    }
    for (const share of [0, 0.5, 1]) {
        const value = (share * most) / 1.08;
        const grid = svg.appendChild(element("g", { class: "grid" }));
        grid.append(element("line", { x1: left, x2: width - right, y1: y(value), y2: y(value) }));
        const label = value === 0 ? ["0"] : short(value).split("^");
        const text = grid.appendChild(element("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, label[0]));
        if (label[1]) text.appendChild(element("tspan", { dy: -4, class: "power" }, label[1]));
    }
    add("text", { x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, "wavelength, nm");
    add("text", { x: left - 40, y: 11 }, "f cos, 1/sr");
    add("path", { class: "all", d: values.map((value, n) => `${n > 0 ? "L" : "M"}${x(nm[n]).toFixed(1)} ${y(value).toFixed(1)}`).join("") });
    if (nm.length <= 8) values.forEach((value, n) => add("circle", { class: "marked", cx: x(nm[n]), cy: y(value), r: 4 }));
}
