#!/usr/bin/env python3
"""Radiance's interpolant of scattered samples beside our fit of the same: `python3 lab/sheet-interpolant.py FOLDER`, by a Python with pyradiance.
Samples are of ground glass, GGX (Walter et al. 2007) in front and smooth behind, index 1.5: eight incidences of some hundred directions of
transmitted light. A tenth of them, and three more incidences, are left out. It prints the table of docs/sheets.md."""
import ctypes
import math
import os
import random
import resource
import subprocess
import sys

import pyradiance

target = os.environ.get("CARGO_TARGET_DIR", "target") + "/release"
folder = sys.argv[1]
os.makedirs(folder, exist_ok=True)
tools = os.path.dirname(pyradiance.__file__)
os.environ["RAYPATH"] = tools + "/lib"
INDEX = 1.5
GIVEN, LEFT = (0, 10, 20, 30, 40, 50, 60, 70), (15, 35, 55)


def direction(theta, phi):
    theta, phi = math.radians(theta), math.radians(phi)
    return [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]


def fresnel(cosine):
    other = math.sqrt(1 - (1 - cosine * cosine) / INDEX**2)
    s, p = (cosine - INDEX * other) / (cosine + INDEX * other), (INDEX * cosine - other) / (INDEX * cosine + other)
    return (s * s + p * p) / 2


def glass(alpha, wi, wo):
    """The BTDF from wi in front to wo behind: through the rough face, and out of the smooth one."""
    inside = [wo[0] / INDEX, wo[1] / INDEX]
    inside.append(-math.sqrt(1 - inside[0] ** 2 - inside[1] ** 2))
    half = [-(a + INDEX * b) for a, b in zip(wi, inside)]
    length = math.sqrt(sum(h * h for h in half))
    half = [h / length for h in half]
    front, behind = (sum(h * d for h, d in zip(half, w)) for w in (wi, inside))
    if front <= 0 or behind >= 0 or half[2] <= 0:
        return 0.0
    shadow = lambda z: 2 / (1 + math.sqrt(1 + alpha**2 * (1 - z * z) / (z * z)))
    normals = alpha**2 / (math.pi * ((alpha**2 - 1) * half[2] ** 2 + 1) ** 2)
    through = (1 - fresnel(front)) * normals * shadow(wi[2]) * shadow(-inside[2]) * INDEX**2 / (front + INDEX * behind) ** 2
    return front * -behind / (wi[2] * -inside[2]) * through * (1 - fresnel(-wo[2])) / INDEX**2


def rows(alpha, theta):
    """Directions behind the sheet, theta and phi, with their values: a spiral over the hemisphere, and rings about the way straight on."""
    places = []
    for n in range(180):
        places.append((180 - math.degrees(math.asin(math.sqrt((n + 0.5) / 184))), math.degrees(2.39996 * n) % 360))
    for ring in range(1, 9):
        away = math.degrees(alpha) * 0.25 * ring
        for n in range(4 * ring):
            turn = 2 * math.pi * (n + 0.5 * ring) / (4 * ring)
            x, y = theta + away * math.cos(turn), away * math.sin(turn)
            d = direction(x, 0)
            d = [d[0] * math.cos(math.radians(y)), math.sin(math.radians(y)), d[2] * math.cos(math.radians(y))]
            if d[2] > 0.05:
                places.append((180 - math.degrees(math.acos(d[2])), (180 + math.degrees(math.atan2(d[1], d[0]))) % 360))
    return [(t, p, glass(alpha, direction(theta, 0), direction(t, p))) for t, p in places]


def timed(command, output=None):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=output or subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def radiance(name, given):
    files = []
    for theta, samples in given:
        files.append(f"{folder}/{name}-{theta}.txt")
        with open(files[-1], "w", encoding="utf-8") as file:
            file.write(f'#sample_name "{name}"\n#format: theta phi BSDF\n#intheta {theta}\n#inphi 0\n#upphi 90\n')
            file.writelines("%.6g %.6g %.7g\n" % row for row in samples)
    sir, xml = f"{folder}/{name}.sir", f"{folder}/{name}.xml"
    with open(sir, "wb") as file:
        seconds = timed([tools + "/bin/pabopto2bsdf", "-n", "1", "-s", "I", *files], file)
    with open(xml, "wb") as file:
        seconds += timed([tools + "/bin/bsdf2ttree", "-g", "7", sir], file)
    data = pyradiance.bsdf.load_file(os.path.abspath(xml))
    value = lambda theta, t, p: float(pyradiance.bsdf.query(data, float(theta), 0.0, t, p)[1])
    return value, f"{os.path.getsize(sir)}, {os.path.getsize(xml)}", seconds


def ours(name, given):
    table, fit = f"{folder}/{name}.csv", f"{folder}/{name}.srbf"
    with open(table, "w", encoding="utf-8") as file:
        file.write("theta_i,phi_i,theta_o,phi_o,value\n")
        for theta, samples in given:
            file.writelines("%g,0,%.6g,%.6g,%.7g\n" % (theta, *row) for row in samples)
    seconds = timed([target + "/srbf", "fit", table, "--sheet", "--no-picture", "--force", "-o", fit])
    library, sheet = ctypes.CDLL(os.path.abspath(target + "/libsrbf.so")), ctypes.c_void_p()
    assert library.srbf_sheet_load(fit.encode(), ctypes.byref(sheet)) == 0

    def value(theta, t, p):
        vector, pdf, wi = ctypes.c_float * 3, ctypes.c_float(), direction(theta, 0)
        out = vector()
        library.srbf_sheet_evaluate_and_pdf(sheet, vector(*direction(t, p)), vector(*wi), out, ctypes.byref(pdf))
        return out[1] / wi[2]

    return value, str(os.path.getsize(fit)), seconds


def errors(value, truth):
    """Relative L2 of f times the outgoing cosine, and the median relative error, %."""
    apart = whole = 0.0
    each = []
    for theta, samples in truth:
        for t, p, f in samples:
            off, cosine = value(theta, t, p) - f, -math.cos(math.radians(t))
            apart, whole = apart + (off * cosine) ** 2, whole + (f * cosine) ** 2
            each.append(abs(off) / f if f > 0 else 0)
    return f"{100 * math.sqrt(apart / whole):.1f}; {100 * sorted(each)[len(each) // 2]:.1f}"


print("| alpha, samples | way | left-out samples, % | left-out incidences, % | bytes | processor time, s |\n|---|---|---|---|---|---|")
chance = random.Random(1)
for alpha in (0.1, 0.3):
    whole = [(theta, rows(alpha, theta)) for theta in GIVEN]
    parts = [(theta, [(row, chance.random() < 0.1) for row in samples]) for theta, samples in whole]
    given, left = ([(theta, [row for row, is_left in both if is_left == wanted]) for theta, both in parts] for wanted in (False, True))
    views = [(theta, rows(alpha, theta)) for theta in LEFT]
    count = sum(len(samples) for _, samples in given)
    for way, make in (("Radiance: interpolant, its tree", radiance), ("srbf", ours)):
        value, size, seconds = make(f"glass-{alpha}", given)
        print(f"| {alpha}, {count} | {way} | {errors(value, left)} | {errors(value, views)} | {size} | {seconds:.1f} |", flush=True)
