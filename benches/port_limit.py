#!/usr/bin/env python3
"""How far the inner loops of `evaluate` are from the limit of the ports of a processor.

Finds the loops over general round lobes in the example `fixed-work` (RGB), one on AVX-512 and one for each stage on AVX2, and asks
llvm-mca of LLVM 19 (Debian: llvm-19) for their reciprocal throughput on models of processors. Cycles are for one lobe and one direction.

    cargo build --release -p srbf-benches --example fixed-work && python3 benches/port_limit.py
"""

import re
import subprocess
import sys

BINARY = sys.argv[1] if len(sys.argv) > 1 else "target/release/examples/fixed-work"
# Directions; of the loops, how often each runs for a lobe, and its operations; models. Fused operations of chord (2 a vector), polynomial
# (5) and colours (3: two in a loop, which loads its factors, the third in one that takes two lobes); subtractions of axis (3) and,
# on AVX2, exponent (1); multiplications of chord and exponent (2); and what puts the exponent in place.
LEVELS = {
    "simd::portable::run": (
        16,
        [
            (1, {"mulps": 16, "addps": 8, "subps": 12}),
            (1, {"mulps": 20, "addps": 28, "subps": 4, "pslld": 4}),
            (1, {"mulps": 8, "addps": 8, "subps": 0}),
            (1, {"mulps": 4, "addps": 4, "subps": 0}),
        ],
        ["znver2", "znver3", "znver4", "skylake", "icelake-server", "sapphirerapids"],
    ),
    "simd::avx2::run": (
        32,
        [
            (1, {"vfmadd": 8, "vsubps": 12, "vmulps": 8, "vpslld": 0}),
            (1, {"vfmadd": 20, "vsubps": 4, "vmulps": 0, "vpslld": 4}),
            (1, {"vfmadd": 8, "vsubps": 0, "vmulps": 0, "vpslld": 0, "vmovaps": 4}),
            (0.5, {"vfmadd": 8, "vsubps": 0, "vmulps": 0, "vpslld": 0, "vmovaps": 0}),
        ],
        ["znver2", "znver3", "znver4", "skylake", "icelake-server", "alderlake"],
    ),
    "simd::avx512::run": (
        32,
        [(1, {"vfmadd": 20, "vsubps": 6, "vmulps": 4, "vscalefps": 2})],
        ["znver4", "skylake-avx512", "icelake-server", "sapphirerapids"],
    ),
}


def functions():
    text = subprocess.run(["objdump", "-dC", "--no-show-raw-insn", BINARY], capture_output=True, text=True, check=True).stdout
    name, found = None, {}
    for line in text.splitlines():
        if head := re.match(r"^[0-9a-f]+ <(.*)>:", line):
            name = head[1]
        elif name and (row := re.match(r"^\s+([0-9a-f]+):\s+(.*)", line)):
            found.setdefault(name, []).append((int(row[1], 16), row[2].split("#")[0].strip()))
    return found


def loops_of(body):
    index = {address: i for i, (address, _) in enumerate(body)}
    found = []
    for i, (_, text) in enumerate(body):
        jump = re.match(r"^j\w+\s+([0-9a-f]+)", text)
        start = index.get(int(jump[1], 16), i) if jump else i
        if start < i:
            found.append([text for _, text in body[start : i + 1]])
    return found


def matching(level, parts, found):
    """The loops of the function that has all of them, each the shortest that will do."""
    is_it = lambda loop, operations: all(sum(word in text for text in loop) == n for word, n in operations.items())
    sets = []
    for name, body in found.items():
        if level in name:
            loops = loops_of(body)
            sets.append([min((loop for loop in loops if is_it(loop, operations)), key=len, default=None) for _, operations in parts])
    whole = [chosen for chosen in sets if all(chosen)]
    if not whole:
        sys.exit(f"{level}: no such loops in {BINARY}")
    return min(whole, key=lambda chosen: sum(map(len, chosen)))


def simulated(loop, model):
    straight = [re.sub(r"<[^>]*>", "", re.sub(r"-?0x[0-9a-f]+\(%rip\)", "8(%rip)", text)) for text in loop if not text.startswith("j")]
    run = subprocess.run(["llvm-mca-19", "-mtriple=x86_64", f"-mcpu={model}", "-iterations=200"], input="\n".join(straight) + "\n", capture_output=True, text=True, check=True).stdout
    return float(re.search(r"Block RThroughput:\s*([\d.]+)", run)[1]), int(re.search(r"Total Cycles:\s*(\d+)", run)[1]) / 200


found = functions()
for level, (directions, parts, models) in LEVELS.items():
    loops = matching(level, parts, found)
    times = [times for times, _ in parts]
    count = sum(n * len(loop) for n, loop in zip(times, loops))
    print(f"{level}: {count:.0f} instructions for {directions} directions, {count / directions:.2f} for one")
    for model in models:
        limit, cycles = (sum(n * value for n, value in zip(times, column)) / directions for column in zip(*(simulated(loop, model) for loop in loops)))
        print(f"  {model:16} port limit {limit:.2f} cycles, simulated {cycles:.2f}")
