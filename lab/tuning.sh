#!/usr/bin/env bash
# The gain of a number of a tuning table: fits with it, and with another value, from a copy of the code.
#
#     bash lab/tuning.sh fit/src/isotropic/tuning.rs exchange::FAMILIES 30 [FILE...]
#
# Prints the mean relative L2 error at the stored views, the error halfway between them, the measure and the processor seconds of both
# fits of each file, which may be a model. The copy and its builds lie in target/tuning.
set -eu
cd "$(dirname "$0")/.."
[ $# -ge 3 ] || { echo "three arguments are expected: TABLE MODULE::NAME VALUE, then files" >&2; exit 2; }
table=$1 module=${2%%::*} name=${2##*::} value=$3
shift 3
[ $# -gt 0 ] || set -- model:ggx:alpha=0.2,f0=0.9 model:ggx:alpha=0.05,f0=0.04 "${SRBF_DATA_DIR:-../shared/data}/rgl/vch_golden_yellow_rgb.bsdf"
[ -f "$table" ] || { echo "$table: there is no such table" >&2; exit 2; }

copy=target/tuning/source
rm -rf "$copy"
mkdir -p "$copy"
git ls-files -z --cached | xargs -0 cp -a --parents -t "$copy"
# The constant of that name in that module, up to its semicolon.
changed=$(awk -v module="$module" -v name="$name" -v value="$value" '
    $0 ~ "^pub\\(crate\\) mod " module " \\{" { inside = 1 }
    /^}/ { inside = 0 }
    inside && $0 ~ "pub const " name ": .* = .*;$" { sub(/ = .*;$/, " = " value ";"); found = 1 }
    { print }
    END { exit !found }' "$table") || { echo "$table: no constant $module::$name on a line of its own" >&2; exit 2; }

build() {
    (cd "$copy" && CARGO_TARGET_DIR=../build cargo build --quiet --release --package srbf-reference-renderer)
    cp target/tuning/build/release/srbf "target/tuning/$1"
}
build before
printf '%s\n' "$changed" >"$copy/$table"
build after

printf '%-40s %-7s %8s %8s %8s %8s\n' file value 'L2 %' 'held %' measure seconds
for file in "$@"; do
    for which in before after; do
        TIMEFORMAT=%U
        { time "target/tuning/$which" fit "$file" -o target/tuning/fit.srbf --force --json >target/tuning/printed.json; } 2>target/tuning/seconds
        awk -v file="$file" -v which="$which" -v seconds="$(tail -n 1 target/tuning/seconds)" '
            { gsub(/[",]/, "") }
            $1 == "mean_relative_l2:" { error = 100 * $2 }
            $1 == "mean_relative_l2_held_out:" { held = 100 * $2 }
            $1 == "measure:" { measure += $2; count += 1 }
            END { printf "%-40s %-7s %8.3f %8.3f %8.4f %8.1f\n", substr(file, length(file) > 40 ? length(file) - 39 : 1), which,
                  error, held, count ? measure / count : 0, seconds }' target/tuning/printed.json
    done
done
