"""A material or a sheet as a BSDF of Mitsuba 3.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import srbf_brdf.mitsuba
    srbf_brdf.mitsuba.register()
    bsdf = mi.load_dict({"type": "srbf", "filename": "paint.srbf"})

In the variants of Dr.Jit (LLVM, CUDA, with derivatives) it is traced and runs where they run. In scalar variants a plugin in C++ runs, once
`python -m srbf_brdf.scalar` has compiled it; until then Python is called at each hit. Colours are linear sRGB, or their
luminance in monochrome variants. Spectral variants have the spectra of the colours:
those that the fit keeps of measured wavelengths, or smooth ones. Polarized variants have light that leaves without polarization.

| parameter | type | |
|---|---|---|
| `filename` | string | the `.srbf` file: of a material, which has a front; or of a sheet, which reflects and transmits on both sides |
| `tint` | colour or texture | multiplies the value, not the density; 1 by default; differentiable |
| `clamp` | boolean | whether channels below 0, of colours outside the gamut, are 0; by default in `scalar_rgb`, which warns of each such sample |

Two materials are blended by Mitsuba's own `blendbsdf`, whose `weight` may be a texture and is differentiable.
"""

from __future__ import annotations

import math

import numpy as np

from . import scalar
from ._native import Material, Sheet

LUMINANCE = (0.2126, 0.7152, 0.0722)


def register(name: str = "srbf", compiled: bool | None = None) -> None:
    """Registers the BSDF under a name, for the variant that is set.

    `compiled` is of scalar variants: None takes the plugin that `python -m srbf_brdf.scalar` makes where it is there, True demands it,
    False leaves it.
    """
    import mitsuba as mi

    variant = mi.variant()
    if variant is None:
        raise RuntimeError("a variant has to be set first: mitsuba.set_variant('llvm_ad_rgb')")
    is_scalar = variant.startswith("scalar")
    if is_scalar and compiled and not scalar.is_built():
        raise RuntimeError("no plugin for this version of Mitsuba: `python -m srbf_brdf.scalar` compiles it")
    if is_scalar and compiled is not False and scalar.is_built():
        scalar.open_plugin(mi)
        of_material = of_sheet = _compiled
    else:
        of_material = _scalar_class(mi) if is_scalar else _traced_class(mi)
        of_sheet = _sheet_class(mi, of_material)

    def make(props):
        path = _path(props)
        try:
            sheet = Sheet.load(path)
        except ValueError:
            return of_material(props, Material.load(path))
        return of_sheet(props, sheet)

    mi.register_bsdf(name, make)


def _path(props) -> str:
    if "filename" not in props:
        raise RuntimeError("srbf: filename: the name of a .srbf file is expected")
    path = props["filename"]
    import mitsuba as mi

    try:
        path = str(mi.file_resolver().resolve(path))
    except AttributeError:
        pass
    return path


def _tint(props):
    return props.get_texture("tint", 1.0) if hasattr(props, "get_texture") else props.texture("tint", 1.0)


def _clamp(mi, props):
    """Whether channels below 0 are 0: where it is not said, in scalar variants of colours alone, which warn of each such sample."""
    return bool(props["clamp"]) if "clamp" in props else mi.variant().startswith("scalar") and not mi.is_spectral


def _compiled(props, content):
    """For scalar variants: the plugin in C++, which `python -m srbf_brdf.scalar` has made."""
    import mitsuba as mi

    return scalar.load(mi, content, tint=_tint(props), clamp=_clamp(mi, props))


def _flags(mi, material):
    flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
    return flags if material.is_isotropic else flags | mi.BSDFFlags.Anisotropic


def _unpolarized(mi, value):
    """What leaves a surface that takes all polarization away."""
    return mi.depolarizer(value) if mi.is_polarized else mi.Spectrum(value)


# Wavelengths between which spectra are linear in spectral variants of Dr.Jit, nm.
FIRST, STEP, LAST = 360, 5, 830


def _scalar_class(mi):
    """For scalar variants: single calls of the library."""

    class ScalarSrbf(mi.BSDF):
        def __init__(self, props, material):
            mi.BSDF.__init__(self, props)
            self.material = material
            self.tint, self.clamp = _tint(props), _clamp(mi, props)
            flags = _flags(mi, self.material)
            self.m_components, self.m_flags = [flags], flags

        def traverse(self, callback):
            callback.put("tint", self.tint, mi.ParamFlags.Differentiable)

        def _spectrum(self, si, rgb, active):
            if mi.is_monochromatic:
                rgb = [np.dot(rgb, LUMINANCE)]
            elif mi.is_spectral:
                rgb = self.material.primaries(list(si.wavelengths)).of(rgb)
            value = mi.UnpolarizedSpectrum(*map(float, np.maximum(rgb, 0) if self.clamp else rgb))
            return _unpolarized(mi, value * (self.tint.eval_1(si, active) if mi.is_monochromatic else self.tint.eval(si, active)))

        def eval_pdf(self, ctx, si, wo, active=True):
            if not active or si.wi.z <= 0 or wo.z <= 0:
                return mi.Spectrum(0.0), 0.0
            value, pdf = self.material.evaluate_and_pdf(list(si.wi), list(wo))
            return self._spectrum(si, value, active), float(pdf)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs = mi.BSDFSample3f()
            bs.eta, bs.sampled_type, bs.sampled_component = 1.0, +mi.BSDFFlags.GlossyReflection, 0
            if not active or si.wi.z <= 0:
                return bs, mi.Spectrum(0.0)
            drawn = self.material.sample(list(si.wi), [sample1, *sample2])
            bs.wo, bs.pdf = mi.Vector3f(*map(float, drawn.direction)), float(drawn.pdf)
            return bs, self._spectrum(si, drawn.weight, active)

        def eval_diffuse_reflectance(self, si, active=True):
            if not active or si.wi.z <= 0:
                return mi.Spectrum(0.0)
            return self._spectrum(si, self.material.albedo(list(si.wi)), active)

        def to_string(self):
            return f"Srbf[{self.material!r}]"

    return ScalarSrbf


def _traced_class(mi):
    import drjit as dr

    Float, UInt32, Vector3f, Vector4f, Color3f = mi.Float, mi.UInt32, mi.Vector3f, mi.Vector4f, mi.Color3f

    def exp2(x):
        return dr.exp2(x)

    def colour(rho, beta):
        return Color3f(1 + rho, 1 - (LUMINANCE[0] * rho + LUMINANCE[2] * beta) / LUMINANCE[1], 1 + beta)

    def inside(sharpness):
        """1 - exp(-2 s)"""
        s = sharpness
        series = 2 * s * (1 - s * (1 - s * (2 / 3 - s * (1 / 3 - s * (2 / 15)))))
        return dr.select(s < 0.05, series, 1 - exp2(-2 / math.log(2) * s))

    class TracedSrbf(mi.BSDF):
        def __init__(self, props, material):
            mi.BSDF.__init__(self, props)
            self.material = material
            self.tint, self.clamp = _tint(props), _clamp(mi, props)
            self.has_tint = "tint" in props
            flags = _flags(mi, material)
            self.m_components, self.m_flags = [flags], flags
            a = material.arrays()
            views, lobes = a["log2_sharpness"].shape
            self.is_line = material.is_isotropic
            self.lobes, self.squeezed, self.mirrored, self.views = lobes, a["squeezed"], a["mirrored"], views
            self.count = lobes + self.mirrored
            # Rows of four numbers, which one gather takes: those of a view alone, then those of each lobe.
            self.stride = 2 * (1 + lobes)
            rows = np.zeros((views, 1 + lobes, 8), np.float32)
            rows[:, 0, 0:3] = a["diffuse"]
            if self.is_line:
                rows[:, 0, 3] = -a["log2_squeeze"]
            else:
                rows[:, 0, 4:7] = a["log2_squeeze"]
            rows[:, 1:, 0:2] = a["tilt"]
            rows[:, 1:, 2] = a["log2_sharpness"]
            rows[:, 1:, 3:6] = a["color"]
            self.rows = Float(rows.ravel())
            theta = a["theta"] if self.is_line else np.unique(a["theta"])
            self.theta, self.angles = Float(theta), len(theta)
            if not self.is_line:
                self.azimuths = (views - 1) // max(self.angles - 1, 1)
                # Views over a quarter of the turn have mirror images elsewhere.
                self.has_mirrors = a["turns"] == 4
                self.turn_views = a["turns"] * (self.azimuths - 1 if self.has_mirrors else self.azimuths)
                self.axis = math.cos(a["axis"]), math.sin(a["axis"])
            self.nodes_shape = a["factors"].shape[:3]
            nodes = np.zeros((*self.nodes_shape, 4), np.float32)
            nodes[..., :3] = a["factors"]
            self.nodes = Float(nodes.ravel()) if nodes.size else None
            differences = np.zeros((len(a["albedo_difference"]), 4), np.float32)
            differences[:, :3] = a["albedo_difference"]
            self.differences = Float(differences.ravel()) if differences.size else None
            self.has_sign = material.has_signed_factors
            columns = material.primaries(np.arange(FIRST, LAST + STEP, STEP)).columns
            self.columns = Float(columns.ravel()) if mi.is_spectral else None

        def traverse(self, callback):
            callback.put("tint", self.tint, mi.ParamFlags.Differentiable)

        # The mixture for an outgoing direction, which Mitsuba calls wi.

        def _row(self, view, row, active):
            return dr.gather(Vector4f, self.rows, view * self.stride + row, active)

        def _interpolated(self, place, row, active):
            """Four numbers of the views round the direction, as pairs within and beyond."""
            a = self._row(place["views"][0], row, active)
            b = self._row(place["views"][1], row, active)
            return dr.fma(b - a, place["onward"], a)

        def _beyond(self, place, row, active):
            c = self._row(place["views"][2], row, active)
            d = self._row(place["views"][3], row, active)
            return dr.fma(d - c, place["onward"], c)

        def _place(self, wo, active):
            across = dr.safe_sqrt(dr.fma(wo.x, wo.x, wo.y * wo.y))
            is_tilted = across > 1e-18
            inverse = dr.rcp(dr.maximum(across, 1e-18))
            cos = dr.select(is_tilted, -wo.x * inverse, 1)
            sin = dr.select(is_tilted, -wo.y * inverse, 0)
            # Not an arc cosine, which has no digits near the normal.
            theta = dr.atan2(across, wo.z)
            place = {"cos": cos, "sin": sin}
            if self.angles > 1:
                passed = dr.binary_search(0, self.angles - 1, lambda i: dr.gather(Float, self.theta, i, active) <= theta)
                after = dr.clip(passed, 1, self.angles - 1)
                before = after - 1
                low, high = dr.gather(Float, self.theta, before, active), dr.gather(Float, self.theta, after, active)
                blend = dr.clip((theta - low) / dr.maximum(high - low, 1e-9), 0, 1)
            else:
                before = after = dr.zeros(UInt32, dr.width(theta))
                blend = dr.zeros(Float, dr.width(theta))
            if self.is_line:
                place |= {"views": (before, after), "onward": blend}
                return place
            # From the axis, and of the image in the first quarter where there are mirrors.
            c = dr.fma(cos, self.axis[0], sin * self.axis[1])
            s = dr.fma(sin, self.axis[0], -cos * self.axis[1])
            image = Float(1)
            if self.has_mirrors:
                image = dr.select((c < 0) == (s < 0), Float(1), -1)
                c, s = -dr.abs(c), -dr.abs(s)
            azimuth = dr.atan2(-s, -c)
            at = dr.select(azimuth < 0, azimuth + 2 * dr.pi, azimuth) * (self.turn_views / (2 * math.pi))
            whole = dr.floor(at)
            if self.has_mirrors:
                first = dr.minimum(UInt32(whole), self.azimuths - 1)
                second = dr.minimum(first + 1, self.azimuths - 1)
            else:
                first = UInt32(whole) % self.azimuths
                second = (UInt32(whole) + 1) % self.azimuths
            view = lambda ring, along: dr.select(ring > 0, 1 + (ring - 1) * self.azimuths + along, 0)
            place |= {
                "views": (view(before, first), view(before, second), view(after, first), view(after, second)),
                "onward": at - whole,
                "outward": blend,
                "is_normal": before == 0,
                "along": (c, s),
                "image": image,
            }
            return place

        def _mixture(self, wo, active):
            place = self._place(wo, active)
            c, s = place["cos"], place["sin"]
            head = self._interpolated(place, 0, active)
            if self.is_line:
                squeeze = (None, exp2(head.w))
                tilt = None
            else:
                # The squeeze matrix, of the normal's view turned into the plane of incidence; its eigenvectors are the frame.
                outward, image = place["outward"], place["image"]
                a, b = place["along"]
                m = self._interpolated(place, 1, active)
                turned = Vector3f(
                    a * a * m.x + b * b * m.z + 2 * a * b * m.y,
                    a * b * (m.z - m.x) + (a * a - b * b) * m.y,
                    b * b * m.x + a * a * m.z - 2 * a * b * m.y,
                )
                m = dr.select(place["is_normal"], turned, Vector3f(m.x, m.y, m.z))
                far = self._beyond(place, 1, active)
                m = dr.lerp(m, Vector3f(far.x, far.y, far.z), outward)
                m.y *= image
                head = dr.lerp(head, self._beyond(place, 0, active), outward)
                half, middle = 0.5 * (m.x - m.z), 0.5 * (m.x + m.z)
                reach = dr.sqrt(dr.fma(half, half, m.y * m.y))
                is_there = reach > 0
                tilt_cos = dr.select(is_there, dr.sqrt(0.5 * (1 + dr.abs(half) / reach)), 1)
                tilt_sin = dr.select(is_there, dr.select(half < 0, -m.y, m.y) / (2 * reach * tilt_cos), 0)
                reach = dr.select(half < 0, -reach, reach)
                squeeze = (exp2(middle + reach), exp2(middle - reach))
                tilt = (tilt_cos, tilt_sin)
            frame = (c, s) if tilt is None else (c * tilt[0] - s * tilt[1], s * tilt[0] + c * tilt[1])
            return {"place": place, "squeeze": squeeze, "tilt": tilt, "frame": frame, "head": head, "diffuse": exp2(head.x), "active": active}

        def _over_lobes(self, body, known, *sums):
            """The sums that a body makes, lobe by lobe: a loop of Dr.Jit, so that the code is as long for one lobe as for many."""
            step = lambda k, known, *sums: (k + 1, known, *body(k, known, *sums))
            # Derivatives need the body's knowledge among its arguments, and sums that begin with 0: their order does not matter then.
            state, labels = (UInt32(0), known, *sums), ("k", "known", *map(str, range(len(sums))))
            return dr.while_loop(state, lambda k, *_: k < self.count, step, labels=labels, max_iterations=-1)[2:]

        def _lobe(self, mixture, k):
            """Axis, sharpness, luminance, the rest of the row with the colour, power, and whether it is squeezed."""
            place, squeeze, tilt, active = (mixture[name] for name in ("place", "squeeze", "tilt", "active"))
            # The second images of mirrored lobes are last.
            own = dr.select(k < self.lobes, k, k - self.mirrored) if self.mirrored else k
            a, b = (self._interpolated(place, 2 + 2 * own + n, active) for n in (0, 1))
            is_squeezed = own < self.squeezed
            if self.is_line:
                sin_a, cos_a = dr.sincos(a.x)
                if self.mirrored:
                    sin_o, cos_o = dr.sincos(dr.select(own < self.lobes - self.mirrored, 0, a.y))
                    axis = Vector3f(sin_a * cos_o, dr.select(k < self.lobes, sin_o, -sin_o), dr.abs(cos_a * cos_o))
                else:
                    axis = Vector3f(sin_a, 0, dr.abs(cos_a))
            else:
                turn, outward = place["is_normal"], place["outward"]
                along, across = place["along"]
                x = dr.select(turn, a.x * along + a.y * across, a.x)
                y = dr.select(turn, a.y * along - a.x * across, a.y)
                far, far_b = (self._beyond(place, 2 + 2 * own + n, active) for n in (0, 1))
                x, y = dr.lerp(x, far.x, outward), dr.lerp(y, far.y, outward) * place["image"]
                a, b = dr.lerp(a, far, outward), dr.lerp(b, far_b, outward)
                angle = dr.sqrt(dr.fma(x, x, y * y))
                sin_a, cos_a = dr.sincos(angle)
                scale = sin_a / dr.maximum(angle, 1e-30)
                axis = Vector3f((x * tilt[0] + y * tilt[1]) * scale, (y * tilt[0] - x * tilt[1]) * scale, dr.abs(cos_a))
                if self.squeezed:
                    axis = dr.select(is_squeezed, dr.normalize(self._squeezed(axis, squeeze)), axis)
            sharpness = dr.maximum(exp2(a.z), 1e-7)
            y = exp2(a.w)
            power = y * (2 * dr.pi) * inside(sharpness) / sharpness
            return axis, sharpness, y, colour(b.x, b.y), power, is_squeezed

        def _squeezed(self, d, squeeze):
            return Vector3f(d.x if squeeze[0] is None else d.x * squeeze[0], d.y * squeeze[1], d.z)

        def _value(self, mixture, wi):
            """The value of the lobes without factors, its luminance, and the power of all lobes."""
            (c, s), squeeze = mixture["frame"], mixture["squeeze"]
            d = Vector3f(dr.fma(wi.x, c, wi.y * s), dr.fma(wi.y, c, -wi.x * s), wi.z)
            u = self._squeezed(d, squeeze)
            length2 = dr.squared_norm(u)
            inverse = dr.rsqrt(length2)
            length = length2 * inverse
            scale = inverse * inverse * inverse * (squeeze[1] if squeeze[0] is None else squeeze[0] * squeeze[1])

            def add(k, known, value, y, power):
                mixture, d, u, length, inverse, scale = known
                axis, sharpness, height, rgb, own, is_squeezed = self._lobe(mixture, k)
                e = dr.select(is_squeezed, dr.fma(-axis, length, u), d - axis)
                rate = sharpness * (-0.5 / math.log(2))
                t = rate * dr.squared_norm(e) * dr.select(is_squeezed, inverse * inverse, 1)
                up = d.z * axis.z * dr.select(is_squeezed, inverse, 1)
                g = height * dr.fma(exp2(t), exp2(4 * rate * up), exp2(t)) * dr.select(is_squeezed, scale, 1)
                return dr.fma(rgb, g, value), y + g, power + own

            value, y, power = self._over_lobes(add, (mixture, d, u, length, inverse, scale), Color3f(0), Float(0), Float(0))
            flat = mixture["diffuse"] * wi.z * dr.inv_pi
            return dr.fma(self._diffuse(mixture), flat, value), y + flat, power + mixture["diffuse"]

        @staticmethod
        def _diffuse(mixture):
            return colour(mixture["head"].y, mixture["head"].z)

        def _factor(self, wo, wi, active):
            """The factors on the lobes, over (1 - h.z)^(1/4), (1 - h.wo)^(1/2) and the squared cosine of the azimuth."""
            azimuths, halves, differences = self.nodes_shape
            s, d = wi + wo, wi - wo
            n2, d2 = dr.squared_norm(s), dr.squared_norm(d)
            n = dr.sqrt(n2)
            across = dr.fma(s.x, s.x, s.y * s.y)
            a = dr.safe_sqrt(dr.safe_sqrt(across / dr.maximum(dr.fma(dr.maximum(s.z, 0), n, n2), 1e-30))) * (halves - 1)
            b = dr.safe_sqrt(d2 / dr.fma(2, n, 4)) * (differences - 1)
            i, j = dr.clip(UInt32(a), 0, halves - 2), dr.clip(UInt32(b), 0, differences - 2)
            x, y = dr.minimum(a - i, 1), dr.minimum(b - j, 1)
            first = i * differences + j

            def plane(first):
                node = lambda at: dr.gather(Vector4f, self.nodes, first + at, active)
                return dr.lerp(dr.lerp(node(0), node(1), y), dr.lerp(node(differences), node(differences + 1), y), x)

            if azimuths == 1:
                found = plane(first)
            else:
                c = dr.minimum(d.z * d.z * n2 / dr.maximum(d2 * across, 1e-30), 1)
                if self.has_sign:
                    c = dr.fma(dr.mulsign(c, d.z), 0.5, 0.5)
                c *= azimuths - 1
                k = dr.clip(UInt32(c), 0, azimuths - 2)
                size = halves * differences
                found = dr.lerp(plane(first + k * size), plane(first + (k + 1) * size), c - k)
            return Color3f(found.x, found.y, found.z)

        def _with_factors(self, wo, wi, value, active):
            return value if self.nodes is None else value * self._factor(wo, wi, active)

        def _spectrum(self, si, value, active):
            if mi.is_monochromatic:
                grey = mi.UnpolarizedSpectrum(dr.dot(Vector3f(value), Vector3f(LUMINANCE)))
                return _unpolarized(mi, (dr.maximum(grey, 0) if self.clamp else grey) * self.tint.eval_1(si, active))
            if mi.is_spectral:
                value = self._spectral(si, value, active)
            if self.clamp:
                value = dr.maximum(value, 0)
            return _unpolarized(mi, value * self.tint.eval(si, active) if self.has_tint else value)

        def _spectral(self, si, rgb, active):
            """A colour at the wavelengths of a path."""
            found = mi.UnpolarizedSpectrum(0)
            for w in range(len(found)):
                at = dr.clip((si.wavelengths[w] - FIRST) / STEP, 0, (LAST - FIRST) / STEP)
                place = dr.minimum(UInt32(at), (LAST - FIRST) // STEP - 1)
                share = at - Float(place)
                for c in range(3):
                    here = dr.gather(Float, self.columns, 3 * place + c, active)
                    there = dr.gather(Float, self.columns, 3 * place + 3 + c, active)
                    found[w] = dr.fma(rgb[c], dr.lerp(here, there, share), found[w])
            return dr.maximum(found, 0)

        # The interface of Mitsuba. Its wi is towards the viewer here, its wo the sample.

        def eval_pdf(self, ctx, si, wo, active=True):
            active = active & (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
            value, y, power = self._value(self._mixture(si.wi, active), wo)
            return self._spectrum(si, self._with_factors(si.wi, wo, value, active), active) & active, dr.select(active, y / power, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_diffuse_reflectance(self, si, active=True):
            """The albedo: of light from everywhere, the share that leaves towards the viewer."""
            active = active & (mi.Frame3f.cos_theta(si.wi) > 0)
            mixture = self._mixture(si.wi, active)

            def add(k, mixture, albedo, power):
                _, _, _, rgb, own, _ = self._lobe(mixture, k)
                return dr.fma(rgb, own, albedo), power + own

            albedo, power = self._over_lobes(add, mixture, Color3f(0), Float(0))
            albedo, power = dr.fma(self._diffuse(mixture), mixture["diffuse"], albedo), power + mixture["diffuse"]
            if self.differences is not None:
                place, rows = mixture["place"], [dr.gather(Vector4f, self.differences, view, active) for view in mixture["place"]["views"]]
                difference = dr.lerp(rows[0], rows[1], place["onward"])
                if not self.is_line:
                    difference = dr.lerp(difference, dr.lerp(rows[2], rows[3], place["onward"]), place["outward"])
                albedo = dr.fma(Color3f(difference.x, difference.y, difference.z), power, albedo)
            return self._spectrum(si, albedo, active) & active

        def sample(self, ctx, si, sample1, sample2, active=True):
            active = active & (mi.Frame3f.cos_theta(si.wi) > 0)
            mixture = self._mixture(si.wi, active)
            (c, s), squeeze = mixture["frame"], mixture["squeeze"]
            # The lobe, by a running sum of powers; the rest is the diffuse term.
            power_to = lambda k, known, power: power + self._lobe(known, k)[4]
            known = dr.detach(mixture)
            (power,) = self._over_lobes(lambda *state: (power_to(*state),), known, Float(0))
            power += known["diffuse"]
            goal = sample1 * power

            # Twice, as arrays of a thread's own are not to be had in calls of Dr.Jit.
            def pass_by(k, known, sum, chosen):
                sum = power_to(k, known, sum)
                return sum, chosen + dr.select(goal >= sum, UInt32(1), 0)

            _, chosen = self._over_lobes(pass_by, known, Float(0), UInt32(0))
            is_lobe = chosen < self.count
            axis, sharpness, _, _, _, is_squeezed = dr.detach(self._lobe(mixture, dr.minimum(chosen, self.count - 1)))
            is_squeezed = is_squeezed & is_lobe
            # The direction in it.
            x = sample2.x * inside(sharpness)
            series = x * (1 + x * (1 / 2 + x * (1 / 3 + x * (1 / 4 + x * (1 / 5 + x / 6)))))
            # 1 - u is exact for large u, where 1 - x would lose digits.
            left = dr.fma(sample2.x, exp2(-2 / math.log(2) * sharpness), 1 - sample2.x)
            w = dr.minimum(dr.select(x < 0.05, series, -dr.log(dr.maximum(left, 1e-37))) / sharpness, 2)
            sin_phi, cos_phi = dr.sincos(2 * dr.pi * sample2.y)
            across = dr.safe_sqrt(w * (2 - w))
            q = (axis.x * cos_phi + axis.y * sin_phi) / (1 + axis.z)
            side = Vector3f(cos_phi - axis.x * q, sin_phi - axis.y * q, -q * (1 + axis.z))
            d = dr.fma(side, across, axis * (1 - w))
            if squeeze[0] is not None:
                d.x = dr.select(is_squeezed, d.x / squeeze[0], d.x)
            d.y = dr.select(is_squeezed, d.y / squeeze[1], d.y)
            d.z = dr.abs(d.z)
            r = dr.safe_sqrt(sample2.x)
            flat = Vector3f(r * cos_phi, r * sin_phi, dr.safe_sqrt(1 - sample2.x))
            d = dr.select(is_lobe, dr.normalize(d), flat)
            bs = mi.BSDFSample3f()
            bs.wo = dr.detach(Vector3f(d.x * c - d.y * s, d.x * s + d.y * c, d.z))
            value, y, _ = self._value(mixture, bs.wo)
            bs.pdf = dr.detach(y / power)
            bs.eta, bs.sampled_type, bs.sampled_component = 1.0, +mi.BSDFFlags.GlossyReflection, 0
            active &= (bs.wo.z > 0) & (bs.pdf > 0)
            bs.pdf = dr.select(active, bs.pdf, 0)
            return bs, (self._spectrum(si, self._with_factors(si.wi, bs.wo, value, active), active) / bs.pdf) & active

        def to_string(self):
            return f"Srbf[{self.material!r}]"

    return TracedSrbf


QUARTERS = ("front_reflection", "front_transmission", "back_reflection", "back_transmission")


def _sheet_class(mi, of_material):
    """Of a sheet: a BSDF for each quarter, seen through a frame whose +z is the side of each direction."""
    import drjit as dr

    # Heights between which the share of reflected draws is linear.
    heights = 16

    class SheetSrbf(mi.BSDF):
        def __init__(self, props, sheet):
            mi.BSDF.__init__(self, props)
            self.sheet = sheet
            quarters = [sheet.quarter(name) for name in QUARTERS]
            self.quarters = [None if quarter is None else of_material(props, quarter) for quarter in quarters]
            wo = np.zeros((2, heights, 3), np.float32)
            wo[..., 2] = np.arange(heights) / (heights - 1) * np.array([[1], [-1]])
            wo[:, 0, 2] = 1e-9, -1e-9
            wo[..., 0] = np.sqrt(1 - wo[..., 2] ** 2)
            self.shares = sheet.reflected_share(wo.reshape(-1, 3))
            self.traced_shares = None if mi.variant().startswith("scalar") else mi.Float(self.shares)
            sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            if not all(quarter is None or quarter.is_isotropic for quarter in quarters):
                sides = sides | mi.BSDFFlags.Anisotropic
            self.kinds = mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.GlossyTransmission
            self.m_components = [kind | sides for kind in self.kinds]
            self.m_flags = self.m_components[0] | self.m_components[1]

        def traverse(self, callback):
            for name, quarter in zip(QUARTERS, self.quarters):
                if quarter is not None:
                    callback.put(name, quarter, mi.ParamFlags.Differentiable)

        def _reflected(self, wi, active):
            """The share of draws that are reflected, as the library has it."""
            side = dr.select(wi.z < 0, heights, 0)
            place = dr.minimum(dr.abs(wi.z), 1) * (heights - 1)
            below = dr.minimum(mi.UInt32(place), heights - 2)
            if self.traced_shares is None:
                low, high = (float(self.shares[side + below + n]) for n in (0, 1))
            else:
                low, high = (dr.gather(mi.Float, self.traced_shares, mi.UInt32(side) + below + n, active) for n in (0, 1))
            return dr.fma(high - low, place - below, low)

        @staticmethod
        def _up(d):
            return mi.Vector3f(d.x, d.y, dr.abs(d.z))

        def _asked(self, si, is_through, active):
            """The quarters that are seen, with the lanes that see them."""
            seen = mi.SurfaceInteraction3f(si)
            seen.wi = self._up(si.wi)
            is_back = si.wi.z < 0
            for place, quarter in enumerate(self.quarters):
                if quarter is not None:
                    through = place % 2 == 1
                    yield quarter, seen, through, active & (is_back == (place >= 2)) & (is_through == through)

        def eval_pdf(self, ctx, si, wo, active=True):
            is_through = (si.wi.z < 0) != (wo.z < 0)
            reflected = self._reflected(si.wi, active)
            value, pdf = mi.Spectrum(0.0), mi.Float(0)
            for quarter, seen, through, here in self._asked(si, is_through, active):
                found, density = quarter.eval_pdf(ctx, seen, self._up(wo), here)
                value, pdf = value + found, dr.fma(density, 1 - reflected if through else reflected, pdf)
            return value, pdf

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def sample(self, ctx, si, sample1, sample2, active=True):
            reflected = self._reflected(si.wi, active)
            is_through = sample1 >= reflected
            first = dr.select(is_through, (sample1 - reflected) / dr.maximum(1 - reflected, 1e-9), sample1 / dr.maximum(reflected, 1e-9))
            first = dr.minimum(first, 1 - 2**-24)
            bs, weight = mi.BSDFSample3f(), mi.Spectrum(0.0)
            bs.eta, bs.wo, bs.pdf = 1.0, mi.Vector3f(0, 0, 1), 0.0
            for quarter, seen, through, here in self._asked(si, is_through, active):
                drawn, found = quarter.sample(ctx, seen, first, sample2, here)
                share = 1 - reflected if through else reflected
                bs.wo, bs.pdf = dr.select(here, drawn.wo, bs.wo), dr.select(here, drawn.pdf * share, bs.pdf)
                weight = dr.select(here, found / dr.maximum(share, 1e-9), weight)
            is_behind = (si.wi.z < 0) != is_through
            bs.wo = mi.Vector3f(bs.wo.x, bs.wo.y, dr.select(is_behind, -bs.wo.z, bs.wo.z))
            bs.sampled_type = dr.select(is_through, +self.kinds[1], +self.kinds[0])
            bs.sampled_component = dr.select(is_through, 1, 0)
            return bs, weight

        def eval_diffuse_reflectance(self, si, active=True):
            albedo = mi.Spectrum(0.0)
            for through in (False, True):
                for quarter, seen, _, here in self._asked(si, through, active):
                    albedo = albedo + quarter.eval_diffuse_reflectance(seen, here)
            return albedo

        def to_string(self):
            return f"Srbf[{self.sheet!r}]"

    return SheetSrbf
