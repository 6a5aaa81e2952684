"""What calls return in several parts."""

from __future__ import annotations

from typing import Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Sample(NamedTuple):
    """Incident directions that were drawn."""

    direction: NDArray[np.float32]
    """Unit vectors, float32 of shape (..., 3)."""
    pdf: NDArray[np.float32]
    """Their density, float32 of shape (...), 1/sr."""
    weight: NDArray[np.float32]
    """`f cos / pdf`, linear sRGB, float32 of shape (..., 3)."""


class Primaries(NamedTuple):
    """What takes the colours of a material to values at wavelengths."""

    columns: NDArray[np.float32]
    """For each wavelength three numbers, whose product with linear sRGB is the value; float32 of shape (w, 3)."""

    def of(self, rgb: ArrayLike) -> NDArray[np.float32]:
        """The values of colours (..., 3) at the wavelengths, (..., w): of `f cos`, weights, albedos. None is below 0."""
        return np.maximum(np.asarray(rgb, np.float32) @ self.columns.T, 0)


class View(TypedDict):
    """A material at one outgoing direction, beside its measurement. Errors are shares of the value; None where there is nothing to tell."""

    theta_degrees: float
    azimuth_degrees: float
    measure: float
    """Solid angle that was compared, sr."""
    relative_l2: float | None
    relative_l2_peak: float | None
    relative_l2_off_peak: float | None
    least_relative_l2: float | None
    """The error that noise leaves to every fit."""
    negative_relative_l2: float | None
    negative_share: float | None
    median_luminance_error_off_peak: float | None
    median_chroma_error_off_peak: float | None
    albedo: list[float]
    data_albedo: list[float]
    energy_error: float | None
    largest_weight_over_mean: float | None
    relative_variance: float | None
    density_over_samples: float | None
    is_black: bool
    is_contradicted: bool
    is_data_albedo_cut: bool


Verdict = TypedDict("Verdict", {"sentence": "str | None", "good": "list[str]", "fair": "list[str]", "off": "list[str]", "try": "list[str]"})
"""Criteria that are good, fair and off, and advice."""


class Report(TypedDict, total=False):
    """The findings of a fit or a comparison, as `srbf fit` and `srbf judge` write it (docs/judging.md)."""

    method: str
    by: str
    version: str
    input: dict[str, str]
    settings: dict[str, Any]
    provenance: str
    seconds: float
    evaluations: int
    stopped: str | None
    bytes: int
    lobes: int
    squeezed: int
    mirrored: int
    stored_views: int
    factors: dict[str, Any] | None
    factor_sizes: list[dict[str, float]]
    views: list[View]
    """At the stored views."""
    held_out: list[View]
    """Between them, or of a comparison."""
    mean_relative_l2: float | None
    mean_relative_l2_held_out: float | None
    summary: dict[str, Any]
    verdict: Verdict
    notes: list[str]
    reciprocity: dict[str, float] | None
    appearance: dict[str, Any] | None
    look: Any
    spectra: Any
    completion: dict[str, Any] | None
    cross_validation: dict[str, Any] | None
    not_measured: dict[str, Any] | None


class Samples(TypedDict):
    """Samples of a table."""

    theta_o: NDArray[np.float64]
    wi: NDArray[np.float64]
    f: NDArray[np.float64]
    weight: NDArray[np.float64]


class Comparison:
    """A material beside a table; prints as its verdict."""

    def __init__(self, report: Report, verdict: list[str]) -> None:
        self.report: Report = report
        """Every number, view by view, as `srbf judge` prints it."""
        self.verdict: list[str] = verdict
        """Criteria that are good, fair and off, and advice: a sentence each."""

    def __str__(self) -> str:
        return "\n".join(self.verdict)

    __repr__ = __str__
