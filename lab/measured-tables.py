#!/usr/bin/env python3
"""Fits measured tables and judges them at 5, 30 and 60 degrees: `python3 lab/measured-tables.py FOLDER TABLE...` writes the fits into the
folder and prints docs/figures/measured-tables.csv. Options of the fit may follow `--`."""
import json
import os
import re
import resource
import subprocess
import sys

srbf = os.environ.get("CARGO_TARGET_DIR", "target") + "/release/srbf"
folder, *tables = sys.argv[1:]
options = tables[tables.index("--") + 1 :] if "--" in tables else []
tables = tables[: tables.index("--")] if "--" in tables else tables
os.makedirs(folder, exist_ok=True)
angles = (5, 30, 60)
errors = [("luminance, %", 4), ("colour", 5), ("off-peak L2, %", 3), ("peak, %", 2)]
head = ["material"] + [f'"{name} at {angle} degrees"' if "," in name else f"{name} at {angle} degrees" for name, _ in errors for angle in angles]
print(",".join(head + ["ripple", "ripple over the table's", "skirt", "balls", "balls of its noise", "largest weight", "factors", "bytes", '"processor time, s"']))
for table in tables:
    name = re.sub(r"(_rgb)?\.\w+$", "", os.path.basename(table))
    fit = f"{folder}/{name}"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([srbf, "fit", table, *options, "--quiet", "--no-picture", "--force", "-o", fit + ".srbf"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    judged = subprocess.run([srbf, "judge", fit + ".srbf", "--against", table, "--angles", "5,30,60"], check=True, capture_output=True, text=True).stdout
    rows = {float(line.split("|")[0]): line.replace("|", " ").split() for line in judged.splitlines() if re.match(r" +\d+\.\d \|", line)}
    report = json.load(open(fit + ".json", encoding="utf-8"))
    found, factors = report["appearance"], report["factors"]
    numbers = [rows[float(angle)][column] for _, column in errors for angle in angles]
    ripple = [of["chroma"] for of in (found["ripple"]["fit"], found["ripple"]["table"])]
    numbers += [f"{ripple[0]:.3f}", f"{ripple[0] / max(ripple[1], 1e-4):.1f}", f"{found['skirt']['chroma']:.3f}", f"{found['visible_difference']:.3f}"]
    numbers += [f"{found['visible_difference_of_noise']:.3f}", f"{report['summary']['largest_weight_over_mean']['worst']:.1f}"]
    size = "x".join(map(str, factors["nodes"])) + ("s" if factors["signed"] else "") if factors else "none"
    print(",".join([name, *numbers, size, str(os.path.getsize(fit + ".srbf")), f"{seconds:.0f}"]), flush=True)
