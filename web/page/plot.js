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
 * @param {{ degrees: number, isLogarithmic: boolean, width: number, points: number[][] }} options
 */
export function draw(svg, curves, { degrees, isLogarithmic, width, points }) {
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
}
