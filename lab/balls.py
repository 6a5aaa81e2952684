#!/usr/bin/env python3
"""Puts the balls that lab/balls.sh drew into one picture: `python3 lab/balls.py FOLDER OUT.jpg`, by a Python with Pillow."""
import sys

from PIL import Image, ImageDraw, ImageFont

folder, picture = sys.argv[1:]
BALLS = [
    ("alum-bronze", "bronze"),
    ("nickel", "nickel"),
    ("chm_mint", "chrome paint"),
    ("irid_flake_paint1", "flake paint"),
    ("red-fabric2", "red fabric"),
]
# Places of the three balls in the picture of one material, in the order of the rows.
ROWS = [("measured", 256), ("fitted", 0), ("4 x difference", 512)]
SIDE, LEFT, TOP = 168, 132, 30
# Pixels round a ball that are cut off.
MARGIN = 16
BACKGROUND = (41, 41, 41)

font = ImageFont.load_default(size=17)
sheet = Image.new("RGB", (LEFT + SIDE * len(BALLS) + 8, TOP + SIDE * len(ROWS) + 8), BACKGROUND)
draw = ImageDraw.Draw(sheet)
for row, (label, _) in enumerate(ROWS):
    draw.text((12, TOP + SIDE * row + SIDE / 2), label, font=font, fill="white", anchor="lm")
for column, (name, label) in enumerate(BALLS):
    draw.text((LEFT + SIDE * (column + 0.5), TOP / 2 + 2), label, font=font, fill="white", anchor="mm")
    balls = Image.open(f"{folder}/{name}.png").convert("RGB")
    for row, (_, left) in enumerate(ROWS):
        ball = balls.crop((left + MARGIN, 22 + MARGIN, left + 256 - MARGIN, 278 - MARGIN)).resize((SIDE, SIDE), Image.Resampling.LANCZOS)
        sheet.paste(ball, (LEFT + SIDE * column, TOP + SIDE * row))
sheet.save(picture, optimize=True, quality=88)
