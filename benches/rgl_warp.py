#!/usr/bin/env python3
"""The time of a pair of a fit beside the table that it was fitted to: RGL's table is the `measured` BSDF of Mitsuba 3, vectorised by LLVM.

A million pairs of directions, each with its own outgoing one, uniform on the hemisphere. One thread each; both take turns, 15 rounds.
Printed are nanoseconds a pair, the least of all rounds of the table, of the fit's requests and of its expanded form with 1024 rows;
and the medians of the ratios of each round, the table's time over the fit's.

    pip install mitsuba==3.9.1 numpy          # and LLVM, Debian: libllvm19
    cargo build --release -p srbf-capi
    DRJIT_LIBLLVM_PATH=LIBLLVM python3 benches/rgl_warp.py DATA/rgl/aurora_white_rgb.bsdf FIT.srbf target/release/libsrbf.so
"""

import ctypes
import statistics
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

PAIRS, ROUNDS, ROWS = 1 << 20, 15, 1024


def directions(random):
    z, phi = random.random(PAIRS), random.random(PAIRS) * 2 * np.pi
    r = np.sqrt(1 - z * z)
    return np.array([r * np.cos(phi), r * np.sin(phi), z], dtype=np.float32)


class Table:
    """RGL's table in Mitsuba."""

    def __init__(self, file, wo, wi, u):
        self.bsdf = mi.load_dict({"type": "measured", "filename": file})
        self.hit = dr.zeros(mi.SurfaceInteraction3f, PAIRS)
        # Mitsuba calls the outgoing direction `wi`.
        self.hit.wi, self.incident = mi.Vector3f(*map(mi.Float, wo)), mi.Vector3f(*map(mi.Float, wi))
        self.u = mi.Float(u[0]), mi.Point2f(mi.Float(u[1]), mi.Float(u[2]))
        self.context = mi.BSDFContext()
        dr.eval(self.hit, self.incident, *self.u)

    def draw(self):
        drawn, weight = self.bsdf.sample(self.context, self.hit, *self.u)
        dr.eval(drawn.wo, drawn.pdf, weight)
        dr.sync_thread()

    def value_and_density(self):
        dr.eval(*self.bsdf.eval_pdf(self.context, self.hit, self.incident))
        dr.sync_thread()

    def density(self):
        dr.eval(self.bsdf.pdf(self.context, self.hit, self.incident))
        dr.sync_thread()


class Library:
    """The C library, and the material that it asks. A request is 31 words: its size, two of materials, then arrays and strides."""

    def __init__(self, library, file, wo, wi, u):
        self.library = ctypes.CDLL(library)
        self.library.srbf_last_message.restype = ctypes.c_char_p
        self.inputs = wo, wi, u
        self.out = np.zeros((11, PAIRS), dtype=np.float32)
        self.material, self.expanded = ctypes.c_void_p(), ctypes.c_void_p()
        self.check(self.library.srbf_material_load(file.encode(), ctypes.byref(self.material)))
        size = ctypes.c_size_t()
        self.check(self.library.srbf_expanded_size(self.material, ctypes.c_size_t(ROWS), ctypes.byref(size)))
        self.storage = np.zeros(size.value // 16 + 1, dtype=np.complex128)
        place, size = ctypes.c_void_p(self.storage.ctypes.data), ctypes.c_size_t(self.storage.nbytes)
        make = self.library.srbf_expanded_make
        self.check(make(self.material, ctypes.c_size_t(ROWS), place, size, ctypes.byref(self.expanded)))
        sample = self.vectors(self.out[4:]) + self.numbers(self.out[7]) + self.vectors(self.out[8:])
        none = [0] * 10
        self.requests = {
            "draw": self.request([0] * 4, self.vectors(u), [0] * 6, sample),
            "value + density": self.request(self.vectors(wi), [0] * 4, self.vectors(self.out) + self.numbers(self.out[3]), none),
            "density": self.request(self.vectors(wi), [0] * 4, [0] * 4 + self.numbers(self.out[3]), none),
        }

    def check(self, status):
        if status:
            sys.exit(self.library.srbf_last_message().decode())

    def vectors(self, rows):
        return [row.ctypes.data for row in rows[:3]] + [4]

    def numbers(self, row):
        return [row.ctypes.data, 4]

    def request(self, wi, u, evaluate, sample):
        words = [31 * 8, 0, 0] + self.vectors(self.inputs[0]) + wi + u + evaluate + sample
        return (ctypes.c_size_t * 31)(*words)

    def ask(self, verb):
        self.check(self.library.srbf_material_ask(self.material, ctypes.c_size_t(PAIRS), self.requests[verb]))

    def ask_expanded(self, verb):
        self.check(self.library.srbf_expanded_ask(self.expanded, ctypes.c_size_t(PAIRS), self.requests[verb]))


def seconds(call):
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def processor():
    lines = dict(line.split(":", 1) for line in open("/proc/cpuinfo") if ":" in line)
    words = {key.strip(): value.strip() for key, value in lines.items()}
    return f"{words['vendor_id']}, family {words['cpu family']}, model {words['model']}"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(1)
    random = np.random.default_rng(1)
    wo, wi = directions(random), directions(random)
    u = random.random((3, PAIRS), dtype=np.float32)
    table = Table(sys.argv[1], wo, wi, u)
    library = Library(sys.argv[3], sys.argv[2], wo, wi, u)
    print(f"processor: {processor()}")
    print(f"{'ns a pair':18}{'table':>9}{'fit':>9}{'ratio':>8}{'expanded':>10}{'ratio':>8}")
    verbs = {"draw": table.draw, "value + density": table.value_and_density, "density": table.density}
    for name, of_table in verbs.items():
        ways = of_table, lambda: library.ask(name), lambda: library.ask_expanded(name)
        rounds = [[seconds(way) / PAIRS * 1e9 for way in ways] for _ in range(ROUNDS + 2)][2:]
        least = [min(column) for column in zip(*rounds)]
        fit, expanded = (statistics.median(r[0] / r[k] for r in rounds) for k in (1, 2))
        print(f"{name:18}{least[0]:9.1f}{least[1]:9.1f}{fit:8.2f}{least[2]:10.1f}{expanded:8.2f}")


main()
