#!/usr/bin/env python3
"""Time and memory of readers against the size of their input, on files of their worst kinds.

    python3 lab/resources.py target/release/srbf [MEGABYTES...] [WORD...] > docs/figures/resources.csv

Words choose the kinds that have one in their name. Every kind is made of the sizes that are given (1, 10, 100 MB), read by one command, and has a row a size: seconds of processors, the largest
memory in MB, the exit status, and the exponent by which the seconds grow from the size before. The exit status is 1 if an exponent is above
1.2, where the seconds are more than noise, if a command ends otherwise than by 0 or 2, or if it takes over 30 bytes a byte. The last row is
that of a thousand materials, which the C library beside the program loads and keeps.
"""

import ctypes
import gzip
import math
import multiprocessing
import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Seconds below which a time is noise.
NOISE = 0.5


def spread(i, step):
    """A number in [0, 1): steps of the golden ratio."""
    return (0.5 + i * step) % 1.0


def rows(head, line, size):
    """A head, and lines of numbers until the size is reached."""
    out, length, i = [head], len(head), 0
    while length < size:
        out.append(line(i))
        length += len(out[-1])
        i += 1
    return "".join(out).encode()


def sample(i):
    return f"{80 * spread(i, .618034):.4f},{360 * spread(i, .754878):.3f},{80 * spread(i, .569840):.4f},0,{.1 + spread(i, .3):.5f}\n"


def numbers(i):
    return f"{spread(i, .618034):.6f} "


def npy(size):
    count = size // 56
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count}, 7), }}"
    head += " " * ((64 - (len(head) + 11) % 64) % 64) + "\n"
    head = head.encode()
    row = [struct.pack("<7d", *direction(i), *direction(i + 7), .3) for i in range(1000)]
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + (b"".join(row) * (count // 1000 + 1))[: 56 * count]


def direction(i):
    theta, phi = 1.4 * spread(i, .618034), math.tau * spread(i, .754878)
    return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)


def radiance_map(size):
    width = max(8, int(math.sqrt(size / 2)) // 8 * 8)
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {width // 2} +X {width}\n".encode()
    return head + bytes([128, 64, 32, 128]) * (width * (width // 2))


def mesh(size):
    return rows("", lambda i: f"v {spread(i, .61):.5f} {spread(i, .75):.5f} {spread(i, .56):.5f}\n" + (f"f {i - 1} {i} {i + 1}\n" if i > 1 else ""), size)


# Name, ending, bytes of a size, arguments of the command.
LOOK = ["look", "--quick", "-q", "FILE"]
KINDS = [
    ("samples", "csv", lambda n: rows("theta_i,phi_i,theta_o,phi_o,value\n", sample, n), LOOK),
    ("samples, all of one view", "csv", lambda n: rows("theta_i,phi_i,theta_o,phi_o,value\n", lambda i: sample(i).split(",")[0] + ",0,30,0,0.5\n", n), LOOK),
    ("numbers in one line", "txt", lambda n: rows("", numbers, n), LOOK),
    ("separators alone", "csv", lambda n: b"," * n, LOOK),
    ("words in one line", "csv", lambda n: rows("", lambda i: f"word{i},", n), LOOK),
    ("empty lines", "csv", lambda n: b"\n" * n, LOOK),
    ("records of JSON", "json", lambda n: rows("", lambda i: '{"theta_i":%.3f,"theta_o":%.3f,"phi":%.2f,"value":0.2}\n' % (80 * spread(i, .61), 80 * spread(i, .75), 180 * spread(i, .57)), n), LOOK),
    ("brackets of JSON", "json", lambda n: b"[" * n, LOOK),
    ("tags of XML", "xml", lambda n: b"<WindowElement>" + b"<a>" * (n // 3), LOOK),
    ("one tag of XML", "xml", lambda n: b"<WindowElement><ScatteringData>" + b"0.1," * (n // 4), LOOK),
    ("zeros in gzip", "csv.gz", lambda n: gzip.compress(bytes(n)), LOOK),
    ("samples in gzip", "csv.gz", lambda n: gzip.compress(rows("theta_i,phi_i,theta_o,phi_o,value\n", sample, n), 1), LOOK),
    ("an array of NumPy", "npy", npy, LOOK),
    ("a head of ASTM without an end", "astm", lambda n: rows("ASTM E1392\n", lambda i: f"KEY{i} {i}\n", n), LOOK),
    ("noise", "bsdf", lambda n: os.urandom(n), LOOK),
    ("a material that goes on", "srbf", lambda n: b"\x89SRBF\r\x1a\n" + bytes(n), ["inspect", "FILE"]),
    ("a map of light", "hdr", radiance_map, ["render", "--material", "matte", "--env", "FILE", "--size", "8x8", "--spp", "1", "-o", "OUT.exr", "--force"]),
    ("triangles", "obj", mesh, ["render", "--scene", "statue", "--material", "matte", "--mesh", "FILE", "--env", "constant:1", "--size", "8x8", "--spp", "1", "-o", "OUT.exr", "--force"]),
]


def write(make, size, file):
    """In a process of its own: a command's largest memory counts that of the process that starts it."""
    process = multiprocessing.get_context("fork").Process(target=lambda: file.write_bytes(make(int(size * 1e6))))
    process.start()
    process.join()
    if process.exitcode != 0:
        sys.exit(f"{file} could not be made")


def run(command, folder):
    """Seconds of processors, MB and exit status."""
    with open(os.devnull, "wb") as nothing:
        child = subprocess.Popen(command, stdout=nothing, stderr=nothing, cwd=folder)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, child.returncode


def load(library, count, answer):
    """Loads presets until there are as many: bytes, seconds and MB of memory."""
    library = ctypes.CDLL(str(library))
    files = sorted(Path(__file__).resolve().parent.parent.glob("presets/*.srbf"))
    loaded = [ctypes.c_void_p() for _ in range(count)]
    names = [str(files[i % len(files)]).encode() for i in range(count)]
    memory = lambda: int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    before, start = memory(), time.process_time()
    for name, material in zip(names, loaded):
        if library.srbf_material_load(name, ctypes.byref(material)) != 0:
            sys.exit(f"{name} is not loaded")
    answer.put((sum(os.path.getsize(name) for name in names), time.process_time() - start, memory() - before))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    srbf = Path(sys.argv[1]).resolve()
    is_size = lambda word: word.replace(".", "").isdigit()
    sizes = [float(word) for word in filter(is_size, sys.argv[2:])] or [1, 10, 100]
    words = [word for word in sys.argv[2:] if not is_size(word)]
    is_asked = lambda name: not words or any(word in name for word in words)
    faults = []
    print("kind,command,megabytes,seconds,memory_mb,status,exponent")
    with tempfile.TemporaryDirectory() as folder:
        for name, ending, make, arguments in KINDS:
            before = None
            if not is_asked(name):
                continue
            for size in sizes:
                file = Path(folder) / f"input.{ending}"
                write(make, size, file)
                command = [srbf, *(word.replace("FILE", str(file)).replace("OUT", f"{folder}/out") for word in arguments)]
                seconds, memory, status = run(command, folder)
                exponent = math.log(seconds / before[1]) / math.log(size / before[0]) if before and before[1] > 0.01 else None
                before = (size, seconds)
                print(f'"{name}",{arguments[0]},{size:g},{seconds:.2f},{memory:.0f},{status},{"" if exponent is None else f"{exponent:.2f}"}', flush=True)
                if status not in (0, 2):
                    faults.append(f"{name}, {size:g} MB: exit status {status}")
                if exponent is not None and exponent > 1.2 and seconds > NOISE:
                    faults.append(f"{name}, {size:g} MB: {seconds:.2f} s, by an exponent of {exponent:.2f}")
                if memory > 200 + 30 * size:
                    faults.append(f"{name}, {size:g} MB: {memory:.0f} MB of memory")
    if is_asked("a thousand materials"):
        answer = multiprocessing.get_context("fork").SimpleQueue()
        process = multiprocessing.get_context("fork").Process(target=load, args=(srbf.parent / "libsrbf.so", 1000, answer))
        process.start()
        process.join()
        if process.exitcode != 0:
            sys.exit("a thousand materials are not loaded")
        size, seconds, memory = answer.get()
        print(f'"a thousand materials",srbf_material_load,{size / 1e6:.1f},{seconds:.3f},{memory:.1f},0,')
        if memory > 2 * size / 1e6 + 1:
            faults.append(f"a thousand materials: {memory:.1f} MB of memory")
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
