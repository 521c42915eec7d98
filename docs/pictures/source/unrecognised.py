"""Draws the six of the paper's images that no network recognises. They have no licence, so the picture stays with whoever has them.

    python3 docs/pictures/source/unrecognised.py FOLDER unrecognised.svg     needs ImageMagick
"""
import pathlib
import subprocess
import sys

from sheet import sheet

folder, output = map(pathlib.Path, sys.argv[1:])
page = sheet(3)
for name, number in (("rock", 4), ("pen", 22), ("pen", 24), ("tube", 21), ("highlighter", 20), ("hand", 26)):
    file = folder / name / f"{name}{number}.jpg"
    counts = subprocess.run(["convert", file, "-colorspace", "Gray", "-depth", "8", "gray:-"], check=True, capture_output=True).stdout
    if len(counts) != 28 * 50:
        sys.exit(f"{file}: expected 28 × 50 tactels, found {len(counts)} counts")
    page.add(f"{name} {number}", [[count / 255 for count in counts[50 * row:50 * row + 50]] for row in range(28)])
output.write_text(page.svg("Images that no network recognises."), encoding="utf-8")
