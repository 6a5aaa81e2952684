#!/usr/bin/env bash
# The gain of numbers of the tuning tables: fits with the tables as they stand, and with each number changed.
#
#     bash lab/tuning.sh isotropic::exchange::FAMILIES=30 complete::robust::ROUNDS=1 [-- FILE...]
#
# A change names the table (isotropic: fit/src/isotropic/tuning.rs), the module in it, the constant and its other value. Each line has the change,
# the file, the mean relative L2 error at the stored views and halfway between them in %, the mean of the measure at the stored views,
# the L2 error of the completion at left-out views in %, the bytes, and the processor seconds. A file may be a model.
#
# One build serves all changes: in a copy of the code each of these constants is a function, which looks at SRBF_TUNING for the number
# of the change. The copy and its build lie in target/tuning. A constant that the compiler has to know, as the length of an array,
# cannot be changed this way; the build fails then.
set -eu
cd "$(dirname "$0")/.."
changes=() is_file=0 files=()
for argument in "$@"; do
    if [ "$argument" = -- ]; then is_file=1; elif [ $is_file = 1 ]; then files+=("$argument"); else changes+=("$argument"); fi
done
[ ${#changes[@]} -gt 0 ] || { echo "at least one change is expected, such as isotropic::exchange::FAMILIES=30; then -- and files" >&2; exit 2; }
data=${SRBF_DATA_DIR:-../shared/data}
[ ${#files[@]} -gt 0 ] || files=(model:ggx:alpha=0.2,f0=0.9 "$data/rgl/vch_golden_yellow_rgb.bsdf" "$data/cornell/garnet_red.brdf")
for file in "${files[@]}"; do
    case $file in model:*) ;; *) [ -f "$file" ] || { echo "$file: there is no such file" >&2; exit 2; } ;; esac
done

copy=target/tuning/source
# Makes a function of the constant of change number $1, $2, in the copy: the one of that name in that module, on a line of its own.
make_function() {
    local number=$1 path=${2%%=*} value=${2#*=} room module name table file
    room=${path%%::*} name=${path##*::} module=${path#*::} module=${module%::*}
    table=fit/src/$room/tuning.rs
    [ -f "$table" ] || table=measured/src/$room/tuning.rs
    [ "$path" != "$2" ] && [ -f "$table" ] || { echo "$2: expected TABLE::MODULE::NAME=VALUE, TABLE one of family, isotropic, anisotropic, complete" >&2; exit 2; }
    awk -v module="$module" -v name="$name" -v value="$value" -v number="$number" '
        $0 ~ "^pub\\(crate\\) mod " module " \\{" { inside = 1 }
        /^}/ { inside = 0 }
        inside && $0 ~ "pub const " name ": .* = .*;$" {
            sub("pub const " name ": ", "#[allow(non_snake_case)] pub fn " name "() -> ")
            sub(/ = /, " { if crate::tuning_number() == " number " { " value " } else { ")
            sub(/;$/, " } }")
            found = 1
        }
        inside && $0 ~ "pub fn " name "\\(\\)" && !found { sub(/\{ if/, "{ if crate::tuning_number() == " number " { " value " } else if"); found = 1 }
        { print }
        END { exit !found }' "$copy/$table" >target/tuning/table.rs ||
        { echo "$table: no constant $module::$name on a line of its own" >&2; exit 2; }
    cp target/tuning/table.rs "$copy/$table"
    # The files that import it.
    for file in $(grep -lrE "\b$room::tuning::$module::" "$copy"/{fit,measured}/src); do
        tr '\n' ' ' <"$file" | grep -qE "\b$room::tuning::$module::(\{[^}]*\b$name\b|$name\b)" || continue
        sed -i -E "/^ *use .*\{\$/,/\};\$/!{/^ *use /!s/\b$name\b(\(\))?/$name()/g}" "$file"
    done
}

rm -rf "$copy"
mkdir -p "$copy"
git ls-files -z --cached | xargs -0 cp -a --parents -t "$copy"
cat >>"$copy/measured/src/lib.rs" <<'RUST'

/// The number of the change that a run is made with; 0 for none.
pub fn tuning_number() -> usize {
    static NUMBER: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    *NUMBER.get_or_init(|| std::env::var("SRBF_TUNING").ok().and_then(|text| text.parse().ok()).unwrap_or(0))
}
RUST
echo "pub(crate) use srbf_measured::tuning_number;" >>"$copy/fit/src/lib.rs"
for i in "${!changes[@]}"; do make_function $((i + 1)) "${changes[i]}"; done
# Files that were copied are older than a build of them that another change has altered.
find "$copy"/{fit,measured}/src -name '*.rs' -exec touch {} +
(cd "$copy" && CARGO_TARGET_DIR=../build cargo build --quiet --release --package srbf-reference-renderer)

echo '| change | file | stored views, L2 % | between, L2 % | measure | completion, L2 % | bytes | seconds |'
echo '|---|---|---|---|---|---|---|---|'
for file in "${files[@]}"; do
    for number in $(seq 0 ${#changes[@]}); do
        [ "$number" = 0 ] && change=none || change=${changes[number - 1]}
        TIMEFORMAT=%U
        { time SRBF_TUNING=$number target/tuning/build/release/srbf fit "$file" -o target/tuning/fit.srbf --force --no-picture --json \
            >target/tuning/printed.json; } 2>target/tuning/seconds || { cat target/tuning/seconds >&2; exit 1; }
        awk -v change="$change" -v file="${file##*/}" -v seconds="$(tail -n 1 target/tuning/seconds)" '
            function percent(x) { return x == "" ? "-" : sprintf("%.3f", 100 * x) }
            { gsub(/[",]/, "") }
            $1 == "views_left_out:" { is_completion = 1 }
            is_completion && $1 == "mean_relative_l2:" { completion = $2; is_completion = 0; next }
            /^  mean_relative_l2:/ { error = $2 }
            /^  mean_relative_l2_held_out:/ { held = $2 }
            /^  views:/ { is_stored = 1 }
            is_stored && $1 == "measure:" { measure += $2; count += 1 }
            /^  bytes:/ { bytes = $2 }
            END { printf "| %s | %s | %s | %s | %.4f | %s | %d | %.1f |\n", change, file, percent(error), percent(held),
                  count ? measure / count : 0, percent(completion), bytes, seconds }' target/tuning/printed.json
    done
done
