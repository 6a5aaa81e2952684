#!/usr/bin/env bash
# Fits five materials and draws the balls of README: `bash lab/balls.sh DATA OUT.jpg`, by a Python with Pillow. DATA has rgl/ and merl/; the fits
# and the single pictures stay in out/balls.
set -eu
data=$1 picture=$2
srbf=${CARGO_TARGET_DIR:-target}/release/srbf
folder=out/balls
mkdir -p "$folder"
# ball NAME TABLE STOPS
ball() {
    "$srbf" ball "$folder/$1.srbf" --against "$2" --exposure "$3" --spp 256 --quiet -o "$folder/$1.png"
}
for name in alum-bronze nickel red-fabric2; do
    [ -e "$folder/$name.srbf" ] ||
        SRBF_DATA_DIR=$data "${srbf}-lab" survey --only "$name" --no-thesis --materials "$folder" --csv "$folder/survey.csv"
done
for name in chm_mint irid_flake_paint1; do
    [ -e "$folder/$name.srbf" ] || "$srbf" fit "$data/rgl/${name}_rgb.bsdf" --no-picture -o "$folder/$name.srbf"
done
networks=$data/merl/nbrdf_merl80.f32le
ball alum-bronze "$networks:alum-bronze" 0
ball nickel "$networks:nickel" 0
ball chm_mint "$data/rgl/chm_mint_rgb.bsdf" 0
ball irid_flake_paint1 "$data/rgl/irid_flake_paint1_rgb.bsdf" 0
ball red-fabric2 "$networks:red-fabric2" -1
python3 lab/balls.py "$folder" "$picture"
