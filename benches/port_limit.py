#!/usr/bin/env python3
"""How far the inner loop of `evaluate` is from what the ports of a processor allow.

Finds the loop over general round lobes in the example `fixed-work` (two vectors of directions, RGB), and asks llvm-mca of LLVM 19
(Debian: llvm-19) for its reciprocal throughput on models of processors. Cycles are for one lobe and one direction.

    cargo build --release -p srbf-benches --example fixed-work && python3 benches/port_limit.py
"""

import re
import subprocess
import sys

BINARY = sys.argv[1] if len(sys.argv) > 1 else "target/release/examples/fixed-work"
# Of one lobe for two vectors: fused operations of chord (2), polynomial (5) and colours (3); subtractions of axis (3) and, on AVX2,
# exponent (1); multiplications of chord and exponent (2); and what puts the exponent in place.
LEVELS = {
    "run_avx2": (
        16,
        {"vfmadd": 20, "vsubps": 8, "vmulps": 4, "vpslld": 2},
        ["znver2", "znver3", "znver4", "skylake", "alderlake"],
    ),
    "run_avx512": (
        32,
        {"vfmadd": 20, "vsubps": 6, "vmulps": 4, "vscalefps": 2},
        ["znver4", "skylake-avx512", "icelake-server", "sapphirerapids"],
    ),
}


def functions():
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", BINARY], capture_output=True, text=True, check=True).stdout
    name, found = None, {}
    for line in text.splitlines():
        if head := re.match(r"^[0-9a-f]+ <(.*)>:", line):
            name = head[1]
        elif name and (row := re.match(r"^\s+([0-9a-f]+):\s+(.*)", line)):
            found.setdefault(name, []).append((int(row[1], 16), row[2].split("#")[0].strip()))
    return found


def innermost_loop(level, operations, found):
    for name, body in found.items():
        if level not in name:
            continue
        index = {address: i for i, (address, _) in enumerate(body)}
        for i, (_, text) in enumerate(body):
            jump = re.match(r"^j\w+\s+([0-9a-f]+)", text)
            start = index.get(int(jump[1], 16), i) if jump else i
            loop = [text for _, text in body[start : i + 1]]
            count = lambda word: sum(word in text for text in loop)
            if start < i and all(count(word) == n for word, n in operations.items()):
                return loop
    sys.exit(f"{level}: no such loop in {BINARY}")


found = functions()
for level, (directions, operations, models) in LEVELS.items():
    loop = innermost_loop(level, operations, found)
    straight = [re.sub(r"<[^>]*>", "", re.sub(r"-?0x[0-9a-f]+\(%rip\)", "8(%rip)", text)) for text in loop if not text.startswith("j")]
    print(f"{level}: {len(loop)} instructions for {directions} directions, {len(loop) / directions:.2f} for one")
    for model in models:
        run = subprocess.run(["llvm-mca-19", "-mtriple=x86_64", f"-mcpu={model}", "-iterations=200"], input="\n".join(straight) + "\n", capture_output=True, text=True, check=True).stdout
        limit = float(re.search(r"Block RThroughput:\s*([\d.]+)", run)[1]) / directions
        simulated = int(re.search(r"Total Cycles:\s*(\d+)", run)[1]) / 200 / directions
        print(f"  {model:16} port limit {limit:.2f} cycles, simulated {simulated:.2f}")
