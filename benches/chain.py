#!/usr/bin/env python3
"""The chain of a hit: instructions of its stages at each level, counted one by one, by kind.

Steps the example `fixed-work` through an operation by ptrace, which counts the instructions of AVX-512 too, and finds by the
symbols of lines which function each one was inlined from. Prints rows of docs/figures/hit-chain.csv: a stage's instructions a hit; of those
the vector operations; those that read or write vectors in memory, and in the stack; and branches. SRBF_LEVELS names other levels, SRBF_TIMES
the number of hits.

    CARGO_PROFILE_RELEASE_DEBUG=1 cargo build --release -p srbf-benches --example fixed-work --target-dir target/lines
    python3 benches/chain.py target/lines/release/examples/fixed-work [OPERATION...]
"""

import collections
import ctypes
import os
import re
import subprocess
import sys

BINARY = os.path.abspath(sys.argv[1])
OPERATIONS = sys.argv[2:] or ["hit", "hits", "packed-hits"]
LEVELS = os.environ.get("SRBF_LEVELS", "avx2 avx512").split()
TIMES = int(os.environ.get("SRBF_TIMES", "256"))
# The innermost of these functions that an instruction stands in names its stage. A path is the end of a file's.
STAGES = [
    ("material/codes.rs", None, "codes"),
    ("outgoing.rs", None, "angle of the outgoing direction"),
    ("between_views.rs", "views_passed", "the views beside it"),
    ("one_lobe.rs", "views_passed", "the views beside it"),
    ("between_views.rs", "after", "the views beside it"),
    ("between_views.rs", "head_at", "squeeze and diffuse term"),
    ("between_views.rs", "head_numbers", "squeeze and diffuse term"),
    ("streamed/block.rs", "heads", "squeeze and diffuse term"),
    ("streamed/lobes.rs", "fill_first", "lobes: axes, sharpness, colours"),
    ("streamed/lobes.rs", "store_powers", "lobes: powers and running sum"),
    ("streamed/lobes.rs", "fill_second", "lobes: powers and running sum"),
    ("streamed/lobes.rs", "fill", "lobes: axes, sharpness, colours"),
    ("squeeze.rs", "see", "direction as lobes see it"),
    ("squeeze.rs", "new", "direction as lobes see it"),
    ("sights.rs", "sights", "direction as lobes see it"),
    ("block.rs", "sum_lobes", "sums over lobes"),
    ("block.rs", "sums", "sums over lobes"),
    ("streamed/one.rs", "sums", "sums over lobes"),
    ("streamed/one.rs", "towards", "sums over lobes"),
    ("block.rs", "chosen_lobe", "choice of a lobe"),
    ("block.rs", "new", "choice of a lobe"),
    ("draw.rs", "draw_unscaled", "direction in the lobe"),
    ("draw.rs", "draw", "direction in the lobe"),
    ("block.rs", "draw", "direction in the lobe"),
    ("block.rs", "finish", "diffuse term, density"),
]
REST = "call, request, copies"
LIBRARY = "C library"


def counts(level, operation, start):
    """How often each address of the program was executed from `start` on, until that function returns."""
    libc = ctypes.CDLL(None, use_errno=True)
    ptrace, wait = libc.ptrace, os.waitpid
    ptrace.restype = ctypes.c_long
    ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    trace_me, peek_text, peek_user, poke_text, poke_user, go_on, step, rip, rsp = 0, 1, 3, 4, 6, 7, 9, 128, 152
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        ptrace(trace_me, 0, None, None)
        os.execv(BINARY, [BINARY, level, operation, str(TIMES)])
    wait(child, 0)
    maps = (line.split() for line in open(f"/proc/{child}/maps"))
    base = next(int(line[0].split("-")[0], 16) for line in maps if line[-1] == BINARY)
    word = ptrace(peek_text, child, base + start, None)
    ptrace(poke_text, child, base + start, word & ~0xFF | 0xCC)
    ptrace(go_on, child, None, None)
    wait(child, 0)
    ptrace(poke_text, child, base + start, word)
    ptrace(poke_user, child, rip, base + start)
    top, seen = ptrace(peek_user, child, rsp, None), collections.Counter()
    while ptrace(peek_user, child, rsp, None) <= top:
        seen[ptrace(peek_user, child, rip, None) - base] += 1
        ptrace(step, child, None, None)
        wait(child, 0)
    ptrace(go_on, child, None, None)
    wait(child, 0)
    return seen


def text():
    """Instructions by address."""
    out = subprocess.run(["objdump", "-d", "--no-show-raw-insn", BINARY], capture_output=True, text=True, check=True).stdout
    rows = (re.match(r"^\s+([0-9a-f]+):\s+(.*)", line) for line in out.splitlines())
    return {int(row[1], 16): row[2].split("#")[0].strip() for row in rows if row}


def address_of(function):
    out = subprocess.run(["nm", "-C", BINARY], capture_output=True, text=True, check=True).stdout
    return next(int(line.split()[0], 16) for line in out.splitlines() if line.endswith(" " + function))


def stages_of(addresses):
    """The stage of each address."""
    asked = "".join(f"{a:#x}\n" for a in addresses)
    command = ["llvm-symbolizer", "--obj=" + BINARY, "--inlines", "--output-style=LLVM", "--demangle"]
    out = subprocess.run(command, input=asked, capture_output=True, text=True, check=True).stdout
    found = []
    for frames in out.strip().split("\n\n"):
        lines = frames.splitlines()
        stage = REST
        for name, place in zip(lines[::2], lines[1::2]):
            path = re.sub(r":\d+(:\d+)?$", "", place)
            short = re.sub(r"::h[0-9a-f]{16}$", "", name).split("::")[-1]
            hit = next((s for end, function, s in STAGES if path.endswith("/kernel/" + end) or path.endswith("/src/" + end)
                        if function in (None, short)), None)
            if hit:
                stage = hit
                break
        found.append(stage)
    return dict(zip(addresses, found))


def kinds(instruction):
    """Which columns an instruction counts in."""
    name = instruction.split()[0]
    is_vector = "%xmm" in instruction or "%ymm" in instruction or "%zmm" in instruction
    memory = re.search(r"\(([^)]*)\)", instruction)
    is_move = bool(re.match(r"v?(movap|movup|movs[sd]|movd|movq|broadcast|movdq|maskmov)", name))
    yield "instructions"
    if is_vector and not is_move:
        yield "vector operations"
    if is_vector and memory:
        yield "vectors from and to memory"
        if "%rsp" in memory[1] or "%rbp" in memory[1]:
            yield "of the stack"
    if is_move and is_vector and not memory:
        yield "moves between registers"
    if name.startswith("j") or name.startswith("call") or name.startswith("ret"):
        yield "branches"


COLUMNS = ["instructions", "vector operations", "vectors from and to memory", "of the stack", "branches"]


def main():
    instructions, start = text(), address_of("srbf_benches::work::Work::run")
    print("operation,stage," + ",".join(f"{column} ({level})" for column in COLUMNS for level in LEVELS))
    for operation in OPERATIONS:
        table = collections.defaultdict(collections.Counter)
        for level in LEVELS:
            used = counts(level, operation, start)
            stage_of = stages_of(sorted(address for address in used if address in instructions))
            for address, n in used.items():
                for kind in kinds(instructions.get(address, "?")):
                    table[stage_of.get(address, LIBRARY)][kind, level] += n / TIMES
        order = list(dict.fromkeys(stage for _, _, stage in STAGES)) + [REST, LIBRARY]
        total = collections.Counter()
        for stage in order:
            total.update(table[stage])
        for stage, row in [*((stage, table[stage]) for stage in order), ("all", total)]:
            if row["instructions", LEVELS[0]] or row["instructions", LEVELS[1]]:
                print(f"{operation},\"{stage}\"," + ",".join(f"{row[c, level]:.0f}" for c in COLUMNS for level in LEVELS), flush=True)


main()
