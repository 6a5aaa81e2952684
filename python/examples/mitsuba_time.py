"""Times the BSDF beside Mitsuba's own, one thread, processor time, the least of five: `mitsuba_time.py [--spectral] MATERIAL.srbf... [TABLE.bsdf...]`.

The pictures of a `.bsdf` file have to be square, or Mitsuba refuses it.
"""

import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

N = 1 << 18


def directions(random):
    z = 1 - 0.98 * random.random(N)
    r, phi = np.sqrt(1 - z * z), 2 * np.pi * random.random(N)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z]).astype(np.float32)


def main(files):
    is_spectral = files[:1] == ["--spectral"]
    files = files[int(is_spectral) :]
    mi.set_variant("llvm_ad_spectral" if is_spectral else "llvm_ad_rgb")
    import srbf_brdf.mitsuba

    srbf_brdf.mitsuba.register()
    dr.set_thread_count(1)
    random = np.random.default_rng(1)
    wo, wi, u = directions(random), directions(random), random.random((3, N)).astype(np.float32)
    si = dr.zeros(mi.SurfaceInteraction3f, N)
    si.wi, towards = mi.Vector3f(wo), mi.Vector3f(wi)
    if is_spectral:
        nm = 400 + 75 * (np.arange(4)[:, None] + random.random(N))
        si.wavelengths = type(si.wavelengths)(nm.astype(np.float32))
    u1, u2, context = mi.Float(u[0]), mi.Point2f(u[1:]), mi.BSDFContext()
    dr.eval(si, towards, u1, u2)

    def evaluate(bsdf):
        dr.eval(bsdf.eval_pdf(context, si, towards))

    def sample(bsdf):
        drawn, weight = bsdf.sample(context, si, u1, u2)
        dr.eval(drawn.wo, drawn.pdf, weight)

    kinds = {"bsdf": "measured", "srbf": "srbf"}
    named = [(kinds[f.rsplit(".", 1)[1]] + " " + f.rsplit("/", 1)[-1], {"type": kinds[f.rsplit(".", 1)[1]], "filename": f}) for f in files]
    plain = [(kind, {"type": kind}) for kind in ("roughconductor", "principled")]
    for name, description in plain + named:
        bsdf, times = mi.load_dict(description), []
        for call in (evaluate, sample):
            each = []
            for _ in range(6):
                start = time.process_time()
                call(bsdf)
                dr.sync_thread()
                each.append(time.process_time() - start)
            times += [each[0], min(each[1:]) / N * 1e9]
        print("{:32} evaluate {:.2f} s first, {:.0f} ns a pair; sample {:.2f} s first, {:.0f} ns".format(name, *times), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
