#!/usr/bin/env bash
# Seconds of processor of fits, at AVX2 and at the best level of this machine, as CSV with the mean errors: bash lab/fit-times.sh FILE...
# The program is that of the whole workspace, whose level the variable SRBF_LEVEL caps. Both levels give the same bytes.
set -eu
root=$(realpath "$(dirname "$0")/..")
(cd "$root" && .ci/built)
srbf=$(realpath "${CARGO_TARGET_DIR:-$root/target}")/release/srbf
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
TIMEFORMAT='%U %S'

seconds() { # LEVEL FILE
    { time SRBF_LEVEL=$1 "$srbf" fit "$2" --quiet --no-picture --force -o "$place/$1.srbf"; } 2>&1 | awk '{ printf "%.1f", $1 + $2 }'
}

echo "file,at AVX2 (s),at the best level (s),\"at the views, relative L2 (%)\",\"halfway between them (%)\",measure (%)"
for file in "$@"; do
    row="$(basename "$file" | sed 's/\..*//'),$(seconds avx2 "$file"),$(seconds avx512 "$file")"
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
