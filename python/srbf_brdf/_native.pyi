"""Materials, tables and the fit. Directions are unit vectors in the shading frame, +z the normal."""

from __future__ import annotations

import os
from typing import Any, Callable, Literal, Sequence, Tuple, Union

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from .types import Comparison, Primaries, Sample

__version__: str

Path = Union[str, "os.PathLike[str]"]
Symmetry = Literal["isotropic", "quadrant", "half turn", "none"]
Vec3 = Tuple[float, float, float]

class FitError(ValueError):
    """An input that a fit, or the reader of a file, refuses; the message names the file, the place and the expectation."""

class Material:
    """A BRDF as lobes: a few kilobytes that are evaluated, integrated and sampled.

    Arrays of directions have shape (n, 3), or (3,) for one, which then stands for all n of the others; any type of numbers is cast to
    float32. `wo` points towards the viewer, `wi` towards the light. Values are `f cos` in linear sRGB, 1/sr.
    """

    @staticmethod
    def load(path: Path) -> Material:
        """Reads a `.srbf` file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> Material:
        """Takes the bytes of a `.srbf` file."""
    def to_bytes(self) -> bytes:
        """The bytes of its `.srbf` file. A pickle holds them, and report and verdict of its fit."""
    def save(self, path: Path) -> None:
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
    def report(self) -> dict[str, Any] | None:
        """What its fit says of itself; None for a sheet that was read."""
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
    def report(self) -> dict[str, Any] | None:
        """What its fit says of itself; None for a material that was read."""
    @property
    def verdict(self) -> list[str] | None:
        """How good its fit is, a sentence each; None for a material that was read."""
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """`f cos`, (n, 3), 1/sr; 0 below the horizon."""
    def pdf(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """Density of `sample`, (n,), 1/sr."""
    def evaluate_and_pdf(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Both in one pass."""
    def sample(self, wo: ArrayLike, u: ArrayLike) -> Sample:
        """Draws incident directions by uniform numbers `u` (n, 3) in [0, 1)."""
    def sample_and_evaluate(
        self, wo: ArrayLike, u: ArrayLike, wi: ArrayLike
    ) -> tuple[Sample, NDArray[np.float32], NDArray[np.float32]]:
        """What `sample` gives; value and density towards `wi`."""
    def albedo(self, wo: ArrayLike) -> NDArray[np.float32]:
        """Integral of `f cos` over the hemisphere, (n, 3)."""
    def compare(self, table: Table | Path, angles: Sequence[float] = (0, 5, 30, 60, 75)) -> Comparison:
        """Judges it beside a table, at outgoing directions in degrees from the normal."""
    def to_merl(self, path: Path) -> None:
        """Writes a MERL `.binary` file."""
    def to_rgl(self, path: Path) -> None:
        """Writes an RGL `.bsdf` file."""
    def arrays(self) -> dict[str, Any]:
        """The numbers of all views as arrays by name."""
    def ball(self, size: int = 256) -> NDArray[np.uint8]:
        """A lit ball, (size, size, 3)."""
    def _repr_png_(self) -> bytes: ...
    def plot(self, table: Table | None = None, angles: Sequence[float] = (5, 30, 60, 75)) -> Figure:
        """A sheet of curves, albedo and ball, by matplotlib."""

class Sheet:
    """A thin surface that reflects light and lets some through: up to four materials, its quarters.

    Directions have +z the front of the sheet, and lie in front or behind; shapes as those of `Material`. Values are `f |cos|` in linear sRGB, 1/sr.
    """

    @staticmethod
    def load(path: Path) -> Sheet:
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
    def save(self, path: Path) -> None:
        """Writes a `.srbf` file."""
    @property
    def is_symmetric(self) -> bool:
        """Whether the back is like the front."""
    @property
    def provenance(self) -> str:
        """Where it comes from, as its maker wrote it."""
    def quarter(self, name: str) -> Material | None:
        """`front_reflection`, `front_transmission`, `back_reflection` or `back_transmission`, named by the viewer's side; None for black."""
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """`f |cos|`, (n, 3), 1/sr."""
    def pdf(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float32]:
        """Density of `sample`, (n,), 1/sr."""
    def evaluate_and_pdf(self, wo: ArrayLike, wi: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Both in one pass."""
    def sample(self, wo: ArrayLike, u: ArrayLike) -> Sample:
        """Draws incident directions on both sides by uniform numbers `u` (n, 3) in [0, 1)."""
    def sample_and_evaluate(
        self, wo: ArrayLike, u: ArrayLike, wi: ArrayLike
    ) -> tuple[Sample, NDArray[np.float32], NDArray[np.float32]]:
        """What `sample` gives; value and density towards `wi`."""
    def reflected_share(self, wo: ArrayLike) -> NDArray[np.float32]:
        """Share of draws that are reflected, (n,)."""
    def albedos(self, wo: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Reflected and transmitted light towards `wo`, of light from everywhere, (n, 3) each."""

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
    def symmetry(self) -> Symmetry: ...
    def evaluate(self, wo: ArrayLike, wi: ArrayLike) -> NDArray[np.float64]:
        """`f cos`, (n, 3), 1/sr; only of a table with a value everywhere."""
    def samples(self, angles: Sequence[float] = (0, 15, 30, 45, 60, 75)) -> dict[str, NDArray[np.float64]]:
        """`theta_o` (n,) radians, `wi` (n, 3), `f` (n, 3) 1/sr, `weight` (n,) sr."""
    def save(self, path: Path) -> None:
        """Writes `.binary`, `.bsdf`, `.csv` or `.astm`."""

def read(path: Path) -> Table:
    """Reads a measured file, or `model:...`."""

def table(wo: ArrayLike, wi: ArrayLike, f: ArrayLike, name: str = "samples") -> Table:
    """Makes a table of samples: (n, 3) each, `f` without a cosine, 1/sr; of shape (n,) it is grey."""

def fit(
    source: Table | Path | tuple[ArrayLike, ArrayLike, ArrayLike] | Callable[[Vec3, Vec3], Vec3 | float],
    *,
    lobes: int = 12,
    error: float | None = None,
    views: int | None = None,
    factors: str | tuple[int, int] | tuple[int, int, int] | None = None,
    squeezed: int | None = None,
    mirrored: int | None = None,
    smoothness: float | None = None,
    starts: int | None = None,
    steps: int | None = None,
    exchanges: int | None = None,
    bytes: int | None = None,
    symmetry: Symmetry | None = None,
    provenance: str = "",
    progress: bool | Callable[[float], object] | None = None,
) -> Material:
    """Fits lobes to a measurement; a bar shows the progress, and Ctrl-C ends it.

    `symmetry` is of a function, "isotropic" if it is None; other sources have their own.
    """

def fit_sheet(
    path: Path,
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
