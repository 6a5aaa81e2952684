#!/usr/bin/env bash
# Seconds of processor that compilers take for the command `srbf`, the C library, and the C library with the fits, from nothing:
# bash lab/compile-times.sh. Machines differ, so each crate of ours has its share of the seconds that the crates of others take, which
# Cargo.lock keeps the same. `.ci/checks/18-weight` holds the bytes that compilers write, which machines agree about.
set -eu
cd "$(dirname "$0")/.."
place=$(realpath -m "${CARGO_TARGET_DIR:-target}")/compile-times
rm -rf "$place"
mkdir -p "$place"
export SRBF_SECONDS=$place/seconds RUSTC_WRAPPER=$PWD/lab/rustc-seconds CARGO_TARGET_DIR=$place
for package in srbf-reference-renderer srbf-capi srbf-fit-capi; do cargo build --quiet --release --locked --package $package; done
awk '
    # Most seconds of one compilation of each, and all of ours together.
    $2 ~ /^srbf/ { all += $1; if ($1 > got[$2]) got[$2] = $1; next }
    { others += $1 }
    END {
        printf "crates of others: %.1f s\n", others
        got["all"] = all
        for (name in got) printf "%s: %.1f s, a share of %.2f\n", name, got[name], got[name] / others
    }' "$SRBF_SECONDS"
