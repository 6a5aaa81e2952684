"""Balls by Mitsuba 3: a table of RGL, its fit, and four times their difference: `mitsuba_balls.py TABLE.bsdf FIT.srbf OUT.png [SIDE [SPP]]`.

The light is a wide lamp, a small one and a dim sky. Both balls have the same seed. Prints their mean difference over the mean radiance, and that of
two pictures of the table with seeds of their own.
"""

import sys

import mitsuba as mi
import numpy as np


def scene(bsdf, side):
    look = mi.ScalarTransform4f().look_at
    lamp = lambda at, size, radiance: {
        "type": "rectangle",
        "to_world": look(origin=at, target=[0, 0, 0], up=[0, 1, 0.1]) @ mi.ScalarTransform4f().scale(size),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}},
    }
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "direct"},
        "sensor": {
            "type": "perspective",
            "fov": 24,
            "to_world": look(origin=[0, 0, 6], target=[0, 0, 0], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}},
        },
        "ball": {"type": "sphere", "bsdf": bsdf},
        "wide": lamp([-4, 5, 5], 1.5, [4, 4, 4]),
        "small": lamp([6, 1, 2], 0.2, [60, 60, 60]),
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.1, 0.12, 0.15]}},
    })


def main(table, fit, out, side=256, samples=256):
    mi.set_variant("llvm_ad_rgb")
    import srbf_brdf.mitsuba
    from srbf_brdf.picture import png, srgb

    srbf_brdf.mitsuba.register()
    side, samples = int(side), int(samples)
    scenes = [scene({"type": kind, "filename": name}, side) for kind, name in (("measured", table), ("srbf", fit))]
    shot = lambda scene, seed: np.array(mi.render(scene, spp=samples, seed=seed))[:, :, :3]
    ours, theirs, again = shot(scenes[1], 0), shot(scenes[0], 0), shot(scenes[0], 1)
    x, y = np.meshgrid(*2 * [(np.arange(side) + 0.5) * 2 / side - 1])
    ball = np.hypot(x, y) < 0.76
    apart = lambda a, b: 100 * np.abs(a[ball] - b[ball]).mean() / b[ball].mean()
    print(f"difference {apart(ours, theirs):.2f} %, of two seeds of the table {apart(again, theirs):.2f} %")
    exposure = 0.6 / np.quantile(theirs[ball], 0.9)
    difference = np.clip(0.5 + 4 * exposure * (ours - theirs), 0, 1)
    with open(out, "wb") as file:
        file.write(png(srgb(np.concatenate([exposure * ours, exposure * theirs, difference], axis=1))))


if __name__ == "__main__":
    if not 4 <= len(sys.argv) <= 6:
        sys.exit(__doc__)
    main(*sys.argv[1:])
