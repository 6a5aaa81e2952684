"""Materials, tables and the fit. Directions are unit vectors in the shading frame, +z the normal."""

from __future__ import annotations

import os
from typing import Any, Callable, Literal, Sequence, Tuple, Union, final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from .types import Comparison, Primaries, Report, Sample, Samples

__version__: str

_Path = Union[str, "os.PathLike[str]"]
_Symmetry = Literal["isotropic", "quadrant", "half turn", "none"]
_Vec3 = Tuple[float, float, float]

class FitError(ValueError):
    """An input that a fit, or the reader of a file, refuses; the message names the file, the place and the expectation."""

@final
class Material:
    """A BRDF as lobes: a few kilobytes that are evaluated, integrated and sampled.

    Arrays of directions have shape (..., 3); leading shapes broadcast as NumPy's do, and results have the leading shape of all. Any type of
    numbers is cast to float32. `wo` points towards the viewer, `wi` towards the light. Values are `f cos` in linear sRGB, 1/sr.
    """

    @staticmethod
    def load(path: _Path) -> Material:
        """Reads a `.srbf` file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> Material:
        """Takes the bytes of a `.srbf` file."""
    def to_bytes(self) -> bytes:
        """The bytes of its `.srbf` file. A pickle holds them, and report and verdict of its fit."""
    def save(self, path: _Path) -> None:
        """Writes a `.srbf` file, never half."""
    @property
    def lobe_count(self) -> int: ...
    @property
    def view_count(self) -> int: ...
    @property
    def is_isotropic(self) -> bool: ...
    @property
    def has_signed_factors(self) -> bool: ...
    @property
    def provenance(self) -> str: ...
    @property
    def has_spectrum(self) -> bool:
        """Whether it has a map from its colours to spectra, as fits of measured wavelengths have."""
    @property
    def wavelengths(self) -> NDArray[np.float32]:
        """The wavelengths of that map, nm, (n,); empty without one."""
    def primaries(self, wavelengths: ArrayLike) -> Primaries:
        """What takes its colours to values at wavelengths in nm. Without a map these are smooth primaries of sRGB, which are 1 together."""
    @property
    def report(self) -> Report:
        """What its fit says of itself; empty for a material that was read."""
    @property
    def verdict(self) -> list[str]:
        """How good its fit is, a sentence each; empty for a material that was read."""
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """`f cos`, (..., 3), 1/sr; 0 below the horizon."""
    def pdf(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """Density of `sample`, (...), 1/sr."""
    def evaluate_and_pdf(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Both in one pass."""
    def sample(self, wo: ArrayLike, u: ArrayLike) -> Sample:
        """Draws incident directions by uniform numbers `u` (..., 3) in [0, 1)."""
    def sample_and_evaluate(
        self, wo: ArrayLike, u: ArrayLike, wi: ArrayLike
    ) -> tuple[Sample, NDArray[np.float32], NDArray[np.float32]]:
        """What `sample` gives; value and density towards `wi`."""
    def albedo(self, wo: ArrayLike) -> NDArray[np.float32]:
        """Integral of `f cos` over the hemisphere, (..., 3)."""
    def compare(self, table: Table | _Path, angles: Sequence[float] | None = None) -> Comparison:
        """Judges it beside a table, at outgoing directions in degrees from the normal: by default 0, 5, 30, 60 and 75."""
    def to_merl(self, path: _Path) -> None:
        """Writes a MERL `.binary` file."""
    def to_rgl(self, path: _Path) -> None:
        """Writes an RGL `.bsdf` file."""
    def arrays(self) -> dict[str, Any]:
        """The numbers of all views as arrays by name."""
    def ball(self, size: int = 256) -> NDArray[np.uint8]:
        """A lit ball, (size, size, 3)."""
    def _repr_png_(self) -> bytes: ...
    def plot(self, table: Table | _Path | None = None, angles: Sequence[float] | None = None) -> Figure:
        """A sheet of curves, albedo and ball, by matplotlib; with a table its values dotted, or its samples near the plane as points.

        `angles` are outgoing directions in degrees from the normal, by default 5, 30, 60 and 75, or four of those of the samples.
        """

@final
class Sheet:
    """A thin surface that reflects light and lets some through: up to four materials, its quarters.

    Directions have +z the front of the sheet, and lie in front or behind; shapes as those of `Material`. Values are `f |cos|` in linear sRGB, 1/sr.
    """

    @staticmethod
    def load(path: _Path) -> Sheet:
        """Reads a `.srbf` file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> Sheet:
        """Takes the bytes of a `.srbf` file."""
    @staticmethod
    def join(
        *,
        front_reflection: Material | None = None,
        front_transmission: Material | None = None,
        back_reflection: Material | None = None,
        back_transmission: Material | None = None,
        symmetric: bool = False,
    ) -> Sheet:
        """Puts materials together; those that are not given are black. `symmetric`: the back is like the front."""
    def to_bytes(self) -> bytes:
        """The bytes of its `.srbf` file."""
    def save(self, path: _Path) -> None:
        """Writes a `.srbf` file."""
    @property
    def report(self) -> dict[str, Any]:
        """What its fit says of itself: where light goes by angle, and how far patches are apart; empty for a sheet that was read."""
    @property
    def is_symmetric(self) -> bool:
        """Whether the back is like the front."""
    @property
    def provenance(self) -> str:
        """Where it comes from, as its maker wrote it."""
    def quarter(self, name: str) -> Material | None:
        """`front_reflection`, `front_transmission`, `back_reflection` or `back_transmission`, named by the viewer's side; None for black."""
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """`f |cos|`, (..., 3), 1/sr."""
    def pdf(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """Density of `sample`, (...), 1/sr."""
    def evaluate_and_pdf(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Both in one pass."""
    def sample(self, wo: ArrayLike, u: ArrayLike) -> Sample:
        """Draws incident directions on both sides by uniform numbers `u` (..., 3) in [0, 1)."""
    def sample_and_evaluate(
        self, wo: ArrayLike, u: ArrayLike, wi: ArrayLike
    ) -> tuple[Sample, NDArray[np.float32], NDArray[np.float32]]:
        """What `sample` gives; value and density towards `wi`."""
    def reflected_share(self, wo: ArrayLike) -> NDArray[np.float32]:
        """Share of draws that are reflected, (...)."""
    def albedos(self, wo: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Reflected and transmitted light towards `wo`, of light from everywhere, (..., 3) each."""

@final
class Blend:
    """Several materials at one hit: the value is the sum of theirs, each times its weight and its tint.

    Directions and values are those of `Material`. Draws choose a part by weight times power, and the density is that of such draws.
    """

    def __new__(
        cls, materials: Sequence[Material], weights: ArrayLike, tints: ArrayLike | None = None, coats: ArrayLike | None = None
    ) -> Blend:
        """`weights` (k,), or (..., k) for hits of their own; `tints` (k, 3) or (..., k, 3), 1 by default.

        `coats` (k,): the refractive index of a clear coat above each part, 1 for none.
        """
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """`f cos`, (..., 3), 1/sr."""
    def pdf(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """Density of `sample`, (...), 1/sr."""
    def evaluate_and_pdf(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Both in one pass."""
    def sample(self, wo: ArrayLike, u: ArrayLike) -> Sample:
        """Draws incident directions by uniform numbers `u` (..., 3) in [0, 1)."""
    def sample_and_evaluate(
        self, wo: ArrayLike, u: ArrayLike, wi: ArrayLike
    ) -> tuple[Sample, NDArray[np.float32], NDArray[np.float32]]:
        """What `sample` gives; value and density towards `wi`."""
    def albedo(self, wo: ArrayLike) -> NDArray[np.float32]:
        """Reflected light towards `wo`, of light from everywhere, (..., 3); below a coat a bound from above."""
    def gradients(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """How `evaluate` changes with weights and with tints, (..., k, 3) each; a channel of a tint changes that channel alone."""

@final
class Table:
    """A measurement: scattered samples, or values at every pair of directions.

    A pickle holds the bytes of its file, which is read once more for that, or its samples.
    """

    @property
    def name(self) -> str: ...
    @property
    def sha256(self) -> str: ...
    @property
    def is_evaluable(self) -> bool: ...
    @property
    def left_out(self) -> str:
        """Rows that are no samples, by reason and line; row i of arrays is line i + 2."""
    def look(self, quick: bool = False) -> list[str]:
        """What there is to say of samples before a fit, a sentence each; those that begin with "check" name a fault.

        `quick` leaves out units and outliers, which take seconds.
        """
    @property
    def symmetry(self) -> _Symmetry: ...
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float64]:
        """`f cos`, (..., 3), 1/sr; only of a table with a value everywhere."""
    def samples(self, angles: Sequence[float] | None = None) -> Samples:
        """By default at 0, 15, 30, 45, 60 and 75 degrees: `theta_o` (n,) radians, `wi` (n, 3), `f` (n, 3) 1/sr, `weight` (n,) sr."""
    def save(self, path: _Path) -> None:
        """Writes `.binary`, `.bsdf`, `.csv` or `.astm`."""

def read(path: _Path) -> Table:
    """Reads a measured file, or `model:...`."""

def table(wo: ArrayLike, wi: ArrayLike, f: ArrayLike, name: str = "samples") -> Table:
    """Makes a table of samples: directions (..., 3) that broadcast, and `f` without a cosine, 1/sr, (..., 3); of shape (...) it is grey."""

def fit(
    source: Table | _Path | tuple[ArrayLike, ArrayLike, ArrayLike] | Callable[[_Vec3, _Vec3], _Vec3 | float],
    *,
    lobes: int = 12,
    error: float | None = None,
    views: int | None = None,
    factors: str | tuple[int, int] | tuple[int, int, int] | None = None,
    squeezed: int | None = None,
    mirrored: int | None = None,
    bytes: int | None = None,
    smoothness: float | None = None,
    starts: int | None = None,
    steps: int | None = None,
    exchanges: int | None = None,
    symmetry: _Symmetry | None = None,
    provenance: str = "",
    progress: bool | Callable[[float], object] | None = None,
) -> Material:
    """Fits lobes to a measurement; a bar shows the progress, and Ctrl-C ends it.

    `symmetry` is of a function, "isotropic" if it is None; other sources have their own.
    """

def fit_sheet(
    path: _Path,
    *,
    band: str = "visible",
    lobes: int = 12,
    views: int | None = None,
    bytes: int | None = None,
    starts: int | None = None,
    steps: int | None = None,
    exchanges: int | None = None,
    provenance: str = "",
    progress: bool | Callable[[float], object] | None = None,
) -> Sheet:
    """Fits all quarters of a sheet: of a file of WINDOW or Radiance, or of samples in front and behind.

    `band` is of a file of a window: "visible", "solar", "infrared", or a name in the file. `lobes`, `views` and `bytes` are those of each quarter.
    """
