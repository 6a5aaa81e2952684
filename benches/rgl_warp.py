#!/usr/bin/env python3
"""The cost of a hit with RGL's measured tables: the `measured` BSDF of Mitsuba 3, vectorised by LLVM, one thread.

A million pairs of directions, each with its own outgoing one, uniform on the hemisphere; ns a pair, the least and the median of 15 rounds.

    pip install mitsuba==3.9.1 numpy          # and LLVM, Debian: libllvm19
    DRJIT_LIBLLVM_PATH=LIBLLVM python3 benches/rgl_warp.py DATA/rgl/aurora_white_rgb.bsdf

Beside it, on the same core: `cargo run --release -p srbf-benches --example expanded avx512 FIT.srbf`.
"""

import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

PAIRS, ROUNDS = 1 << 20, 15


def directions(random):
    z, phi = random.random(PAIRS), random.random(PAIRS) * 2 * np.pi
    r = np.sqrt(1 - z * z)
    return mi.Vector3f(mi.Float(r * np.cos(phi)), mi.Float(r * np.sin(phi)), mi.Float(z))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(1)
    bsdf = mi.load_dict({"type": "measured", "filename": sys.argv[1]})
    random = np.random.default_rng(1)
    hit = dr.zeros(mi.SurfaceInteraction3f, PAIRS)
    hit.wi, incident = directions(random), directions(random)
    u1, u2 = mi.Float(random.random(PAIRS)), mi.Point2f(mi.Float(random.random(PAIRS)), mi.Float(random.random(PAIRS)))
    dr.eval(hit, incident, u1, u2)
    context = mi.BSDFContext()

    def sample():
        drawn, weight = bsdf.sample(context, hit, u1, u2)
        dr.eval(drawn.wo, drawn.pdf, weight)

    verbs = {
        "sample": sample,
        "value": lambda: dr.eval(bsdf.eval(context, hit, incident)),
        "value + pdf": lambda: dr.eval(*bsdf.eval_pdf(context, hit, incident)),
        "pdf": lambda: dr.eval(bsdf.pdf(context, hit, incident)),
    }
    for name, verb in verbs.items():
        rounds = []
        for _ in range(ROUNDS):
            dr.sync_thread()
            start = time.perf_counter()
            verb()
            dr.sync_thread()
            rounds.append((time.perf_counter() - start) / PAIRS * 1e9)
        print(f"{name:12} {min(rounds):6.1f} {sorted(rounds)[ROUNDS // 2]:6.1f}")


main()
