#!/usr/bin/env bash
# Seconds of processor of fits, at AVX2 and at the best level of this machine, as CSV with the mean errors: bash lab/fit-times.sh FILE...
# A file `made:N` is N samples of a rough coat at random directions, with 2 % of noise.
# The program is that of the whole workspace, whose level the variable SRBF_LEVEL caps. Both levels give the same bytes.
set -eu
root=$(realpath "$(dirname "$0")/..")
(cd "$root" && .ci/built)
srbf=$(realpath "${CARGO_TARGET_DIR:-$root/target}")/release/srbf
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
TIMEFORMAT='%U %S'

made() { # NUMBER
    python3 - "$1" <<'END'
import math
import random
import sys

random.seed(7)
print("theta_i,phi_i,theta_o,phi_o,red,green,blue")
for _ in range(int(sys.argv[1])):
    theta_i, theta_o, phi = random.uniform(0, 80), random.uniform(0, 80), random.uniform(0, 180)
    i, o, p = (math.radians(angle) for angle in (theta_i, theta_o, phi))
    wi = [math.sin(i), 0.0, math.cos(i)]
    wo = [math.sin(o) * math.cos(p), math.sin(o) * math.sin(p), math.cos(o)]
    half = [a + b for a, b in zip(wi, wo)]
    length = math.sqrt(sum(x * x for x in half))
    half = [x / length for x in half]
    cos, towards = half[2], max(sum(a * b for a, b in zip(half, wi)), 1e-6)
    # Beckmann's distribution of roughness .2, Schlick's Fresnel term of .04, the shadows of V-shaped grooves.
    facets = math.exp(-(1 - cos * cos) / (cos * cos) / 0.04) / (math.pi * 0.04 * cos**4)
    coat = facets * (0.04 + 0.96 * (1 - towards) ** 5) * min(1, 2 * cos * wi[2] / towards, 2 * cos * wo[2] / towards) / (4 * wi[2] * wo[2])
    rgb = [(body + coat) * random.gauss(1, 0.02) for body in (0.1, 0.05, 0.02)]
    print(f"{theta_i:.3f},0,{theta_o:.3f},{phi:.3f},{rgb[0]:.6g},{rgb[1]:.6g},{rgb[2]:.6g}")
END
}

seconds() { # LEVEL FILE
    { time SRBF_LEVEL=$1 "$srbf" fit "$2" --quiet --no-picture --force -o "$place/$1.srbf"; } 2>&1 | awk '{ printf "%.1f", $1 + $2 }'
}

echo "file,at AVX2 (s),at the best level (s),\"at the views, relative L2 (%)\",\"halfway between them (%)\",measure (%)"
for file in "$@"; do
    name=$(basename "$file" | sed 's/\..*//')
    case $file in made:*)
        made "${file#made:}" >"$place/made.csv"
        file=$place/made.csv
        ;;
    esac
    row="$name,$(seconds avx2 "$file"),$(seconds avx512 "$file")"
    cmp "$place/avx2.srbf" "$place/avx512.srbf"
    python3 - "$row" "$place/avx512.json" <<'END'
import json
import sys

report = json.load(open(sys.argv[2]))
mean = lambda views, key: 100 * sum(v[key] for v in views if v[key] is not None) / max(1, sum(v[key] is not None for v in views))
views, between = report["views"], report["held_out"] or []
print(f"{sys.argv[1]},{mean(views, 'relative_l2'):.2f},{mean(between, 'relative_l2'):.2f},{mean(views, 'measure'):.2f}")
END
done
