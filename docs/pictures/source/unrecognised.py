"""Draws the six of the paper's images that no network recognises. The images have no licence, so the repository holds what was measured of
them (unrecognised.csv), and pictures of the images themselves stay with whoever has them.

    python3 docs/pictures/source/unrecognised.py FOLDER unrecognised.svg     draws the images; needs ImageMagick
    python3 docs/pictures/source/unrecognised.py FOLDER unrecognised.csv     measures them and their classes
"""
import csv
import math
import pathlib
import statistics
import subprocess
import sys

from sheet import sheet
from svg import follow_theme, light

SIX = (("rock", 4), ("pen", 22), ("pen", 24), ("tube", 21), ("highlighter", 20), ("hand", 26))


def counts_of(folder, name, number):
    file = pathlib.Path(folder, name, f"{name}{number}.jpg")
    counts = subprocess.run(["convert", file, "-colorspace", "Gray", "-depth", "8", "gray:-"], check=True, capture_output=True).stdout
    if len(counts) != 28 * 50:
        sys.exit(f"{file}: expected 28 × 50 tactels, found {len(counts)} counts")
    return counts


def ellipse_of(counts):
    """Of the uniform ellipse with the moments of the pressure: centre, length and width in tactels, angle in degrees."""
    points = [(i % 50 + 0.5, i // 50 + 0.5, count) for i, count in enumerate(counts) if count >= 16] # above what air and JPEG leave
    whole = sum(p for _, _, p in points)
    x, y = sum(x * p for x, _, p in points) / whole, sum(y * p for _, y, p in points) / whole
    xx, yy, xy = (sum(f(u - x, v - y) * p for u, v, p in points) / whole
                  for f in (lambda a, b: a * a, lambda a, b: b * b, lambda a, b: a * b))
    mean, half = (xx + yy) / 2, math.hypot((xx - yy) / 2, xy)
    return x, y, 4 * math.sqrt(mean + half), 4 * math.sqrt(max(mean - half, 0)), math.degrees(math.atan2(2 * xy, xx - yy) / 2)


def measure(folder, output):
    rows = [["class", "image", "x", "y", "length", "width", "angle", "class_length", "class_width"]]
    for name, number in SIX:
        of_class = [ellipse_of(counts_of(folder, name, i)) for i in range(1, 51)]
        usual = [statistics.median(ellipse[axis] for ellipse in of_class) for axis in (2, 3)]
        rows.append([name, number, *(f"{value:.1f}" for value in (*of_class[number - 1], *usual))])
    with open(output, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def ellipses(measured):
    """A picture of the ellipses of six images, each with that of its class at the same place."""
    cells = []
    for place, row in enumerate(measured):
        size, at = {key: float(row[key]) for key in row if key != "class"}, f'x="{place % 3 * 216}" y="{place // 3 * 146 + 20}"'
        drawn = "".join(f'<ellipse rx="{size[kind + "length"] / 2:g}" ry="{size[kind + "width"] / 2:g}" fill="none" stroke="{colour}" '
                        f'stroke-width="0.6"{dashes}/>' for kind, colour, dashes in (("class_", light["orange"], ' stroke-dasharray="1.5 1"'),
                                                                                     ("", light["blue"], "")))
        cells.append(f'<text x="{place % 3 * 216 + 104}" y="{place // 3 * 146 + 14}">{row["class"]} {row["image"]}</text>'
                     f'<svg {at} width="208" height="116.5" viewBox="0 0 50 28"><rect width="50" height="28" fill="{light["panel"]}"/>'
                     f'<g transform="translate({size["x"]:g},{size["y"]:g}) rotate({size["angle"]:g})">{drawn}</g></svg>')
    words = "\n".join(cells)
    return follow_theme(f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="310" viewBox="0 0 640 310" '
                        f'font-family="Helvetica, Arial, sans-serif" font-size="14" text-anchor="middle" fill="{light["ink"]}">\n{words}\n'
                        f'<text x="320" y="304" font-size="12.5" fill="{light["quiet"]}">Ellipses with the moments of the pressure, 28×50 tactels: '
                        'the image (line), and the median of its class (dashes).</text>\n</svg>\n')


def draw(folder, output):
    page = sheet(3)
    for name, number in SIX:
        counts = counts_of(folder, name, number)
        page.add(f"{name} {number}", [[count / 255 for count in counts[50 * row:50 * row + 50]] for row in range(28)])
    pathlib.Path(output).write_text(page.svg("Images that no network recognises."), encoding="utf-8")


if __name__ == "__main__":
    (measure if sys.argv[2].endswith(".csv") else draw)(*sys.argv[1:])
