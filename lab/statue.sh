#!/usr/bin/env bash
# The picture of a statue in four metals of docs/blends.md: bash lab/statue.sh DATA OUT.png
#
# DATA is the folder of measured data, with `merl/sgd_fit_params.csv` and `meshes/stanford_dragon_res3.ply`. The metals are models that were
# fitted to measurements of MERL. Two maps choose among them: places in the palette, and the weight of the second one where two meet.
set -eu
[ $# -eq 2 ] || { echo "usage: bash lab/statue.sh DATA OUT.png" >&2; exit 2; }
data=$(realpath "$1") out=$(realpath -m "$2")
cd "$(dirname "$0")/.."
cargo build --release --locked
srbf=$(realpath "${CARGO_TARGET_DIR:-target}/release/srbf")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
metals=(brass alum-bronze nickel black-oxidized-steel)
for metal in "${metals[@]}"; do
    "$srbf" fit "model:sgd:name=$metal,file=$data/merl/sgd_fit_params.csv" --no-picture --quiet -o "$metal.srbf"
done
python3 - <<'PY'
import math
import struct
import zlib

WIDTH, HEIGHT = 512, 256


def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def write(path, kind, rows):
    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, kind, 0, 0, 0)
    rows = b"".join(b"\0" + bytes(row) for row in rows)
    chunks = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunks)


def place(x, y):
    """The first of two metals at a texel, and the share of the next."""
    u, v = (x + 0.5) / WIDTH, (y + 0.5) / HEIGHT
    at = 4 * ((u + 0.9 * v + 0.05 * math.sin(6 * math.pi * u)) % 1)
    share = min(max((at % 1 - 0.85) / 0.15, 0), 1)
    return int(at) % 4, share * share * (3 - 2 * share)


texels = [[place(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]
write("index.png", 2, [[n for first, _ in row for n in (first, (first + 1) % 4, 0)] for row in texels])
write("weight.png", 0, [[round(255 * share) for _, share in row] for row in texels])
PY
palette=$(printf '%s.srbf,' "${metals[@]}")
"$srbf" render --scene statue --mesh "$data/meshes/stanford_dragon_res3.ply" --mesh-up y --palette "${palette%,}" --index-map index.png \
    --weight-map weight.png --size 640x400 --spp 256 --exposure 0.7 -o statue.exr
cp statue.png "$out"
