"""Measured BRDFs as small mixtures of spherical Gaussian lobes.

    import srbf_brdf as srbf
    material = srbf.fit("red-metallic-paint.binary")      # or a table, arrays, a function
    print("\\n".join(material.verdict))
    material.save("paint.srbf")
    value = material.evaluate(wo, wi)                      # f cos, (n, 3)
    direction, pdf, weight = material.sample(wo, u)        # f cos / pdf is the weight

Directions are unit vectors in the shading frame, +z the normal: `wo` towards the viewer, `wi` towards the light. Values are `f cos`,
the BRDF times the cosine of `wi`, in linear sRGB, 1/sr. Densities are per solid angle, 1/sr.

`srbf_brdf.mitsuba.register()` makes a material a BSDF of Mitsuba 3.
"""

from ._native import Blend, FitError, Material, Sheet, Table, __version__, fit, fit_sheet, read, table
from .types import Comparison, Primaries, Sample

__all__ = ["Blend", "Comparison", "FitError", "Material", "Primaries", "Sample", "Sheet", "Table", "__version__", "fit", "fit_sheet", "load", "read", "table"]

load = Material.load
