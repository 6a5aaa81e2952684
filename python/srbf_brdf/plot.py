"""A sheet of a material by matplotlib: curves, albedo, ball."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def plane(theta_o: float, theta_i):
    """Directions in the plane of incidence, angles in radians, the mirror side positive."""
    wo = np.array([-np.sin(theta_o), 0.0, np.cos(theta_o)])
    return wo, np.stack([np.sin(theta_i), np.zeros_like(theta_i), np.cos(theta_i)], axis=1)


# Samples are drawn that are so near the plane of incidence, degrees, and at most as far from the outgoing direction of a curve.
NEAR, AWAY = 6.0, 2.5


def samples_near_the_plane(table):
    """By outgoing angle in degrees: the signed angles of `wi`, degrees, and the luminances of `f`. Only angles that have some."""
    samples = table.samples()
    theta_o, (x, y, z) = np.degrees(samples["theta_o"]), samples["wi"].T
    is_near = np.degrees(np.arcsin(np.clip(np.abs(y), 0, 1))) <= NEAR
    found = {}
    for angle in np.unique(np.round(theta_o[is_near], 3)):
        here = is_near & (np.abs(theta_o - angle) < 1e-3)
        found[float(angle)] = np.degrees(np.arctan2(x[here], z[here])), samples["f"][here] @ LUMINANCE
    return found


def _nearest(found, angle):
    """The samples of the outgoing direction that is nearest to an angle, or none."""
    nearest = min(found, key=lambda own: abs(own - angle), default=None)
    return None if nearest is None or abs(nearest - angle) > AWAY else found[nearest]


def plot(material, table=None, angles=None):
    """The sheet that `Material.plot` returns, a `matplotlib.figure.Figure`."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("plot() draws by matplotlib: pip install matplotlib") from error
    from .picture import ball

    points = {} if table is None or table.is_evaluable else samples_near_the_plane(table)
    if angles is None:
        own = sorted(points)
        # As far apart as four of them can be.
        angles = [own[round(n * (len(own) - 1) / 3)] for n in range(4)] if own else (5.0, 30.0, 60.0, 75.0)
        angles = sorted(set(angles))
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    curves, albedo, picture = figure.subplots(1, 3, width_ratios=(2, 1, 1))
    theta_i = np.radians(np.linspace(-89, 89, 713))
    lowest = np.inf
    for n, angle in enumerate(angles):
        wo, wi = plane(np.radians(angle), theta_i)
        value = material.evaluate(wo, wi) @ LUMINANCE / np.cos(theta_i)
        curves.semilogy(np.degrees(theta_i), np.maximum(value, 1e-9), color=f"C{n}", label=f"{angle:g} degrees")
        lowest = min(lowest, np.min(value[np.abs(theta_i) < 1.4]))
        if table is not None and table.is_evaluable:
            data = table.evaluate(wo, wi) @ LUMINANCE / np.cos(theta_i)
            curves.semilogy(np.degrees(theta_i), np.maximum(data, 1e-9), color=f"C{n}", linestyle=":")
        drawn = _nearest(points, angle)
        if drawn is not None:
            curves.semilogy(drawn[0], np.maximum(drawn[1], 1e-9), color=f"C{n}", linestyle="", marker=".", alpha=0.6)
    curves.set(xlabel="wi from the normal, degrees", ylabel="luminance of f, 1/sr", ylim=(max(0.5 * lowest, 1e-6), None))
    title = "plane of incidence"
    if table is not None:
        of_samples = f", samples within {NEAR:g} degrees of it as points" if points else ", which no sample is near"
        title += ", data dotted" if table.is_evaluable else of_samples
    curves.set_title(title)
    curves.legend(title="wo")

    theta_o = np.radians(np.linspace(0, 89, 90))
    wo = np.stack([-np.sin(theta_o), np.zeros_like(theta_o), np.cos(theta_o)], axis=1)
    for channel, color in enumerate(("tab:red", "tab:green", "tab:blue")):
        albedo.plot(np.degrees(theta_o), material.albedo(wo)[:, channel], color=color)
    albedo.set(title="albedo", xlabel="wo from the normal, degrees", ylim=(0, None))
    picture.imshow(ball(material, 256))
    picture.set_axis_off()
    picture.set_title(f"{material.lobe_count} lobes, {len(material.to_bytes())} bytes")
    return figure
