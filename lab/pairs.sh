#!/usr/bin/env bash
# Pairs of balls, fit and table, under the five suns of a verdict: each table is fitted as usual, and without factors.
# `bash lab/pairs.sh FOLDER TABLE...` writes a picture of each pair and `pairs.csv`, with the numbers and the sentence that is said.
# docs/judging.md has the words of a person about twenty.
set -eu
place=$1
shift
mkdir -p "$place"
srbf=${CARGO_TARGET_DIR:-target}/release/srbf
echo "pair,bytes,visible_difference,of_noise,lines,lines_of_table,bite,ring,ring_of_table,darker_table,sentence" >"$place/pairs.csv"
for table in "$@"; do
    name=$(basename "${table%%,*}" | sed 's/_rgb\.bsdf$//; s/.*://')
    for factors in chosen none; do
        fit=$place/$name-$factors
        "$srbf" fit "$table" --factors $factors --quiet --no-picture --force -o "$fit.srbf"
        "$srbf" ball "$fit.srbf" --against "$table" --spp 32 --env sun:20,sun:60,sun:100,sun:120,sun:140 -o "$fit.png"
        python3 - "$fit" >>"$place/pairs.csv" <<'PYTHON'
import csv, json, os, sys
fit = sys.argv[1]
report = json.load(open(fit + ".json"))
found = report["appearance"]
grain = [found["grain"][of]["nine_tenths_below"] for of in ("fit", "table")]
numbers = [found["visible_difference"], found["visible_difference_of_noise"], *grain, found["bite"], *found["ring"], found["ghost"]["visible_difference"]]
sentence = report["verdict"]["sentence"]
csv.writer(sys.stdout, lineterminator="\n").writerow([os.path.basename(fit), os.path.getsize(fit + ".srbf"), *(f"{n:.3f}" for n in numbers), sentence])
PYTHON
    done
done
