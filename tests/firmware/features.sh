#!/usr/bin/env bash
# Code bytes of the run-time road, and of the road with one feature of core more, at opt-level s: a row of
# docs/small-targets.md for each. `bash tests/firmware/features.sh [ROW...]`, of: road hit simd environment zonal.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "$0")/../.."
unset RUSTFLAGS
place=$(realpath -m "${CARGO_TARGET_DIR:-target}/firmware")
here=$PWD/tests/firmware
export CARGO_PROFILE_RELEASE_OPT_LEVEL=s
# The linker and its script for a target.
linked() {
    local name
    name=$(tr 'a-z.-' 'A-Z__' <<<"$1")
    export "CARGO_TARGET_${name}_LINKER=$2" "CARGO_TARGET_${name}_RUSTFLAGS=$3"
}
linked thumbv7em-none-eabihf ld.lld "-Clink-arg=-T$here/cortex-m.ld -Clinker-flavor=ld.lld"
linked riscv32imac-unknown-none-elf ld.lld "-Clink-arg=-T$here/riscv.ld -Clinker-flavor=ld.lld"
linked wasm32-unknown-unknown wasm-ld "-Clinker-flavor=wasm-ld -Clink-arg=--no-entry -Clink-arg=--export=reset -Cstrip=symbols"
linked x86_64-unknown-linux-gnu cc "-Clink-arg=-nostartfiles -Clink-arg=-Wl,-e,reset -Clink-arg=-lc"
# size TARGET FEATURES: bytes of code and constants.
size() {
    local target=$1 features=$2 program
    cargo build --quiet --locked --release --manifest-path "$here/Cargo.toml" --bin size \
        ${features:+--features "$features"} --target "$target" --target-dir "$place/s" >&2
    program=$place/s/$target/release/size
    if [ "$target" = wasm32-unknown-unknown ]; then
        wc -c <"$program.wasm"
    else
        local sum=0 bytes
        for bytes in $(readelf -SW "$program" | sed 's/^ *\[ *[0-9]*\]//' | awk '$1 ~ /^\.s?(text|rodata|data)/ { print $5 }'); do
            sum=$((sum + 0x$bytes))
        done
        echo "$sum"
    fi
}
for row in "${@:-road hit simd environment zonal}"; do
    for row in $row; do
        features=$row
        [ "$row" = road ] && features=
        arm=$(size thumbv7em-none-eabihf "$features")
        risc=$(size riscv32imac-unknown-none-elf "$features")
        wasm=$(size wasm32-unknown-unknown "$features")
        x86=$(size x86_64-unknown-linux-gnu "$features")
        echo "$row $arm $risc $wasm $x86"
    done
done
