#!/usr/bin/env python3
"""Draws the plots of README and docs/: `python3 lab/plots.py` writes docs/plots/*.svg, by a Python with matplotlib. Numbers come from
docs/figures/*.csv; the pictures of the theory come from its formulas. `python3 lab/plots.py NAME...` draws those named."""
import csv
import os
import statistics
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

FOLDER = "docs/plots"
BLUE, GREEN, RED, YELLOW, PURPLE, GREY = "#0072b2", "#009e73", "#d55e00", "#e69f00", "#cc79a7", "#666666"
# A white ground and letters as curves look the same on light and dark pages, on every machine; a fixed salt gives the same bytes.
plt.rcParams.update(
    {
        "svg.hashsalt": "srbf",
        "svg.fonttype": "path",
        "font.size": 12,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e0e0e0",
        "figure.facecolor": "white",
        "savefig.facecolor": "white",
        "lines.linewidth": 2.2,
    }
)


def save(figure, name):
    figure.tight_layout()
    figure.savefig(f"{FOLDER}/{name}.svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)


def rows(name):
    with open(f"docs/figures/{name}.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def lobe(cosine, sharpness, height=1.0):
    return height * np.exp(sharpness * (cosine - 1))


def baselines():
    """Error away from the peak over bytes: the median of the tables, and the range of the middle half."""
    all_rows = rows("baselines")
    forms = [
        ("two GGX lobes", GREY, "^", "two GGX lobes and a diffuse term"),
        ("network", PURPLE, "D", "a network of 675 weights"),
        ("RGL's table", YELLOW, "s", "RGL's own table with fewer numbers"),
        ("srbf", BLUE, "o", "srbf"),
        ("srbf in 8 bits", RED, "o", "srbf, packed"),
    ]
    figure, axes = plt.subplots(figsize=(8.4, 4.4))
    for form, color, mark, label in forms:
        steps = {}
        tables = sorted({row["table"] for row in all_rows})
        for table in tables:
            for step, row in enumerate(r for r in all_rows if (r["form"], r["table"]) == (form, table)):
                steps.setdefault(step, []).append((float(row["bytes"]), float(row["luminance away from the peak, %"])))
        size = [statistics.median(b for b, _ in points) for points in steps.values()]
        errors = [sorted(e for _, e in points) for points in steps.values()]
        middle = [statistics.median(e) for e in errors]
        axes.plot(size, middle, color=color, marker=mark, markersize=7, label=label, zorder=3)
        quarter = [np.percentile(e, [25, 75]) for e in errors]
        if len(size) > 1:
            axes.fill_between(size, [q[0] for q in quarter], [q[1] for q in quarter], color=color, alpha=0.1, linewidth=0)
        else:
            axes.vlines(size, quarter[0][0], quarter[0][1], color=color, alpha=0.35, linewidth=4)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks([100, 300, 1000, 3000, 10000], ["100", "300", "1000", "3000", "10 000"])
    axes.set_yticks([3, 5, 10, 20, 50], ["3", "5", "10", "20", "50"])
    axes.minorticks_off()
    axes.set_xlabel("bytes of a material")
    axes.set_ylabel("error of the brightness, %")
    axes.set_title(f"Away from the highlight, {len(tables)} measured tables", loc="left")
    axes.legend(frameon=False, loc="lower left", fontsize=11)
    save(figure, "baselines")


def noise():
    """Noise over time: the relative mean squared error of pictures over seconds of processors."""
    methods = [
        ("ggx+mis", YELLOW, "s", "one direction of the light, one of a GGX lobe"),
        ("mis", BLUE, "^", "one direction of the light, one of srbf's lobes"),
        ("even", RED, "o", "srbf's sums of light and lobes"),
    ]
    all_rows = rows("noise-over-time")
    scenes = [("sphere", "a ball in the open"), ("teapot", "a teapot on a ground, which hides light")]
    figure, both = plt.subplots(1, 2, figsize=(10.6, 4.4), sharey=True)
    for axes, (scene, title) in zip(both, scenes):
        for method, color, mark, label in methods:
            points = [(float(r["seconds"]), float(r["relative_mse"])) for r in all_rows if (r["scene"], r["method"]) == (scene, method)]
            axes.plot(*zip(*sorted(points)), color=color, marker=mark, markersize=6, label=label)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("seconds of processors")
        axes.set_ylim(1e-5, 3e-1)
        seconds = [0.02, 0.1, 1, 5] if scene == "sphere" else [0.1, 1, 5]
        axes.set_xticks(seconds, [str(s) for s in seconds])
        axes.minorticks_off()
        axes.set_title(title, loc="left", fontsize=12)
    both[0].set_ylabel("noise: relative mean squared error")
    both[1].legend(frameon=False, fontsize=10, loc="upper right")
    save(figure, "noise-over-time")


def error_against_time():
    """Ratios of squared errors after the same time, by scene: means, and lines from the least to the largest."""
    ways = [("lobes", GREY, "lobes alone"), ("mis", BLUE, "mis: light and lobes"), ("product", YELLOW, "product: one of 16")]
    all_rows = [row for row in rows("error-against-time") if row["after the same"] == "time"]
    scenes = ["sphere", "teapot", "statue", "room", "furnace"]
    figure, axes = plt.subplots(figsize=(8.4, 3.8))
    for n, (way, color, label) in enumerate(ways):
        for k, scene in enumerate(scenes):
            (row,) = [row for row in all_rows if (row["of"], row["case"]) == (scene, f"{way} over even, Sobol")]
            at = len(scenes) - k - 0.22 * (n - 1)
            axes.plot([float(row["least"]), float(row["largest"])], [at, at], color=color, alpha=0.45, linewidth=5, solid_capstyle="butt")
            axes.plot([float(row["ratio"])], [at], marker="o", color=color, linestyle="", label=label if k == 0 else None)
    axes.axvline(1, color="black", linewidth=1.2)
    axes.set_xscale("log")
    axes.set_xticks([0.3, 1, 3, 10, 30, 100, 1000], ["0.3", "1", "3", "10", "30", "100", "1000"])
    axes.minorticks_off()
    axes.set_yticks(range(len(scenes), 0, -1), scenes)
    axes.set_xlabel("squared error over that of even sums, after the same time")
    axes.legend(frameon=False, fontsize=11, loc="lower right")
    save(figure, "error-against-time")


def half_plane(axes, limit=1.12, top=1.08):
    """Axes for a drawing over a surface."""
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_xlim(-limit, limit)
    axes.plot([-limit, limit], [0, 0], color="black", linewidth=1.6)
    axes.annotate("", (0, top), (0, 0), arrowprops={"arrowstyle": "->", "color": GREY})
    axes.text(0.03, top - 0.06, "normal", color=GREY, fontsize=10)


def theory_lobe():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), width_ratios=[1.15, 1])
    angles = np.radians(np.linspace(-90, 90, 721))
    half_plane(left)
    axis = np.radians(40)
    for sharpness, height, color in [(6, 0.55, GREEN), (60, 0.95, BLUE)]:
        value = lobe(np.cos(angles - axis), sharpness, height)
        left.fill(np.sin(angles) * value, np.cos(angles) * value, color=color, alpha=0.25)
        left.plot(np.sin(angles) * value, np.cos(angles) * value, color=color)
    left.annotate("", (1.05 * np.sin(axis), 1.05 * np.cos(axis)), (0, 0), arrowprops={"arrowstyle": "->", "linestyle": "--"})
    left.text(1.07 * np.sin(axis), 1.05 * np.cos(axis), "axis", fontsize=11)
    left.annotate("", (0, 0), (-np.sin(axis), np.cos(axis)), arrowprops={"arrowstyle": "<-", "color": RED})
    left.text(-1.04 * np.sin(axis) - 0.3, np.cos(axis), "to the viewer", fontsize=11, color=RED)
    left.set_ylim(-0.05, 1.12)
    degrees = np.linspace(-90, 90, 721)
    for sharpness, color in [(2, YELLOW), (6, GREEN), (60, BLUE), (600, RED)]:
        right.plot(degrees, lobe(np.cos(np.radians(degrees)), sharpness), color=color, label=f"sharpness {sharpness}")
    right.set_xlabel("degrees from the axis")
    right.set_ylabel("value over the amplitude")
    right.set_xticks([-90, -45, 0, 45, 90])
    right.set_ylim(0, 1.45)
    right.set_yticks([0, 0.5, 1])
    right.legend(frameon=False, fontsize=10, ncols=2, loc="upper center")
    save(figure, "lobe")


def theory_fold():
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.3))
    axis, sharpness = np.radians(76), 9.0
    above = np.radians(np.linspace(-90, 90, 721))
    below = np.radians(np.linspace(90, 180, 361))
    direct = lobe(np.cos(above - axis), sharpness, 0.66)
    hidden = lobe(np.cos(below - axis), sharpness, 0.66)
    mirrored = lobe(np.cos(np.pi - above - axis), sharpness, 0.66)
    for panel, title in zip(axes, ["a lobe by the horizon", "the same lobe, folded"]):
        half_plane(panel, 1.08, 0.66)
        panel.set_xlim(-0.45, 1.12)
        panel.set_ylim(-0.22, 0.7)
        panel.set_title(title, fontsize=12)
    left, right = axes
    left.fill(np.sin(above) * direct, np.cos(above) * direct, color=BLUE, alpha=0.25)
    left.plot(np.sin(above) * direct, np.cos(above) * direct, color=BLUE)
    left.fill(np.sin(below) * hidden, np.cos(below) * hidden, color=RED, alpha=0.25)
    left.plot(np.sin(below) * hidden, np.cos(below) * hidden, color=RED, linestyle="--")
    left.text(0.05, -0.17, "under the surface: lost", color=RED, fontsize=11)
    total = direct + mirrored
    right.fill(np.sin(above) * total, np.cos(above) * total, color=BLUE, alpha=0.25)
    right.plot(np.sin(above) * total, np.cos(above) * total, color=BLUE, label="sum")
    right.plot(np.sin(above) * mirrored, np.cos(above) * mirrored, color=RED, linestyle="--")
    right.text(0.05, -0.17, "the lost part, mirrored up and added", color=RED, fontsize=11)
    right.fill(np.sin(above) * mirrored, np.cos(above) * mirrored, color=RED, alpha=0.2)
    save(figure, "fold")


def theory_squeeze():
    figure, axes = plt.subplots(1, 2, figsize=(9, 4.4))
    x, y = np.meshgrid(np.linspace(-1, 1, 241), np.linspace(-1, 1, 241))
    inside = x * x + y * y < 1
    z = np.sqrt(np.where(inside, 1 - x * x - y * y, 0))
    axis = np.radians(68)
    for panel, c, title in [(axes[0], 1.0, "a round lobe"), (axes[1], 0.35, "squeezed to 0.35 of its width")]:
        r = np.sqrt(x * x + (y / c) ** 2 + z * z)
        cosine = (x * np.sin(axis) + z * np.cos(axis)) / r
        value = np.where(inside, lobe(cosine, 16) / (c * r**3), np.nan)
        panel.contourf(x, y, value / np.nanmax(value), levels=np.linspace(0.05, 1, 9), cmap="Blues")
        panel.contour(x, y, value / np.nanmax(value), levels=[0.1, 0.5, 0.9], colors=BLUE, linewidths=1)
        panel.add_patch(plt.Circle((0, 0), 1, fill=False, color="black"))
        panel.plot([-1, 1], [0, 0], color=GREY, linestyle=":", linewidth=1.2)
        panel.plot([0], [0], marker="+", color="black")
        panel.text(0.02, -0.12, "normal", fontsize=10)
        panel.text(-0.97, 0.04, "plane of incidence", color=GREY, fontsize=9.5)
        panel.set_aspect("equal")
        panel.axis("off")
        panel.set_title(title, fontsize=12)
    save(figure, "squeeze")


def theory_glide():
    figure, axes = plt.subplots(1, 2, figsize=(10.4, 3.7), sharey=True)
    degrees = np.linspace(0, 90, 721)
    value = lambda axis, sharpness, height: lobe(np.cos(np.radians(degrees - axis)), sharpness, height)
    first, second = (25, 60, 0.8), (60, 110, 1.1)
    for panel, title in zip(axes, ["cross-faded: two ghosts", "gliding: one highlight"]):
        for stored, label in [(first, "stored view"), (second, "next stored view")]:
            panel.plot(degrees, value(*stored), color=GREY, linestyle="--", linewidth=1.4)
            panel.text(stored[0], stored[2] + 0.03, label, color=GREY, ha="center", fontsize=10)
        panel.set_title(title, loc="left", fontsize=12)
        panel.set_xlabel("degrees from the normal")
        panel.set_ylim(0, 1.3)
    axes[0].set_ylabel("value")
    axes[0].plot(degrees, 0.5 * (value(*first) + value(*second)), color=RED)
    middle = tuple(0.5 * (a + b) for a, b in zip(first, second))
    axes[1].plot(degrees, value(*middle), color=BLUE)
    for panel, color in [(axes[0], RED), (axes[1], BLUE)]:
        panel.text(42.5, 0.98 if color == BLUE else 0.3, "halfway", color=color, ha="center", fontsize=11)
    save(figure, "glide")


PLOTS = {
    "baselines": baselines,
    "noise-over-time": noise,
    "error-against-time": error_against_time,
    "lobe": theory_lobe,
    "fold": theory_fold,
    "squeeze": theory_squeeze,
    "glide": theory_glide,
}
os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
os.makedirs(FOLDER, exist_ok=True)
for chosen in sys.argv[1:] or PLOTS:
    PLOTS[chosen]()
    print(f"{FOLDER}/{chosen}.svg")
