"""A sheet of a material by matplotlib: curves, albedo, ball."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def plane(theta_o: float, theta_i):
    """Directions in the plane of incidence, angles in radians, the mirror side positive."""
    wo = np.array([-np.sin(theta_o), 0.0, np.cos(theta_o)])
    return wo, np.stack([np.sin(theta_i), np.zeros_like(theta_i), np.cos(theta_i)], axis=1)


def plot(material, table=None, angles=(5.0, 30.0, 60.0, 75.0)):
    """The sheet that `Material.plot` returns, a `matplotlib.figure.Figure`."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("plot() draws by matplotlib: pip install matplotlib") from error
    from .picture import ball

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
    curves.set(xlabel="wi from the normal, degrees", ylabel="luminance of f, 1/sr", ylim=(max(0.5 * lowest, 1e-6), None))
    curves.set_title("plane of incidence" + (", data dotted" if table is not None and table.is_evaluable else ""))
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
