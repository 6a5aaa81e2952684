#!/usr/bin/env python3
"""What each instruction set costs in bytes of the C library.

Adds up the functions of a library whose names tell their purpose:

    RUSTFLAGS="-C symbol-mangling-version=v0" cargo build --release -p srbf-capi --target-dir target/bytes
    python3 benches/bytes.py

Code that was inlined counts where it stands. What belongs to no level is the C interface, the fit and their libraries.
"""

import re
import subprocess
import sys
from collections import Counter

LIBRARY = sys.argv[1] if len(sys.argv) > 1 else "target/bytes/release/libsrbf.so"
LEVELS = ["scalar", "portable", "avx2", "avx512"]


def functions():
    """Size and name of each function, once for each address."""
    table = subprocess.run(["nm", "-S", "-C", "--defined-only", LIBRARY], check=True, capture_output=True, text=True).stdout
    seen = set()
    for line in table.splitlines():
        parts = line.split(" ", 3)
        if len(parts) == 4 and parts[2] in "tTwW" and parts[0] not in seen:
            seen.add(parts[0])
            yield int(parts[1], 16), parts[3]


def main():
    levels, crates = Counter(), Counter()
    for size, name in functions():
        level = re.search(r"\bsimd::(scalar|portable|avx2|avx512)\b", name)
        if level:
            levels[level[1]] += size
        else:
            crate = re.search(r"[a-z_][a-z_0-9]*", name.lstrip("<&*"))
            crates[crate[0] if crate else name] += size
    if not levels:
        sys.exit(f"{LIBRARY}: no names of levels: build it with symbol-mangling-version=v0")
    print("level      kB")
    for name in LEVELS:
        print(f"{name:9} {levels[name] / 1000:4.0f}")
    print("no level   kB")
    for name, size in crates.most_common(8):
        print(f"{name:9} {size / 1000:4.0f}")


main()
