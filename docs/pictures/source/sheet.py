"""Sheets of pressure images with labels, as SVG: reads the PNG files that the example programs write."""
import base64
import struct
import zlib

# Corners of matplotlib's inferno map (van der Walt and Smith, 2015), as in tactnet_stream: lighter is more pressure.
inferno = [(0, 0, 4), (66, 10, 104), (147, 38, 103), (221, 81, 58), (252, 165, 10), (252, 255, 164)]


def colour_of(share):
    """The colour of a pressure, as a share of full scale."""
    place = min(max(share, 0.0), 1.0) * (len(inferno) - 1)
    below = min(int(place), len(inferno) - 2)
    return tuple(round(a + (place - below) * (b - a)) for a, b in zip(inferno[below], inferno[below + 1]))


def read_png(path):
    """The rows of a grey picture of 8 bits, without interlacing: what the example programs write."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path}: expected a PNG file")
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", data[16:29])
    if (depth, kind, interlaced) != (8, 0, 0):
        raise ValueError(f"{path}: expected grey pixels of 8 bits, found depth {depth}, colour type {kind}")
    packed, place = b"", 8
    while place < len(data):
        length, name = struct.unpack(">I4s", data[place:place + 8])
        if name == b"IDAT":
            packed += data[place + 8:place + 8 + length]
        place += length + 12
    raw, rows, above = zlib.decompress(packed), [], bytearray(width)
    for y in range(height):
        rule, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width):
            left, up, corner = (row[x - 1] if x else 0), above[x], (above[x - 1] if x else 0)
            nearest = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, nearest)[rule]) & 255
        rows.append(row)
        above = row
    return rows


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png_of(rows, palette=None):
    """A PNG file of 8 bits per pixel: numbers of colours in a palette, or grey."""
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3 if palette else 0, 0, 0, 0)
    colours = chunk(b"PLTE", b"".join(map(bytes, palette))) if palette else b""
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + colours + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def coloured(levels, steps=64):
    """A PNG file of pressures between 0 and 1, light ones lifted: a hand presses a tenth of what a key does."""
    return png_of([[round(level ** 0.6 * (steps - 1)) for level in row] for row in levels],
                  [colour_of(i / (steps - 1)) for i in range(steps)])


def tactels(rows, column, row=0, zoom=2, gap=8, shape=(28, 50)):
    """The pressures of one picture of a sheet of examples/support/sheet.hpp, a value per tactel."""
    top, left = gap + row * (shape[0] * zoom + gap), gap + column * (shape[1] * zoom + gap)
    return [[(240 - min(rows[top + y * zoom + zoom // 2][left + x * zoom + zoom // 2], 240)) / 240 for x in range(shape[1])]
            for y in range(shape[0])]


class sheet:
    """Rows of cells with a label above each; a cell is one image or several side by side."""

    def __init__(self, columns, colours, images=1, font=14):
        self.columns, self.colours, self.images, self.font = columns, colours, images, font
        self.width, self.cell = 640, (640 + 8) / columns
        self.image_width = (self.cell - 8 - 4 * (images - 1)) / images
        self.image_height = self.image_width * 28 / 50
        self.row = self.image_height + font + 14
        self.parts, self.count = [], 0

    def place(self):
        """Where the next cell is."""
        at = (self.count % self.columns * self.cell, self.count // self.columns * self.row)
        self.count += 1
        return at

    def add(self, label, *images):
        x, y = self.place()
        middle = x + (self.cell - 8) / 2
        self.parts.append(f'<text x="{middle:.1f}" y="{y + self.font:.1f}">{label}</text>')
        for i, levels in enumerate(images):
            data = base64.b64encode(coloured(levels)).decode()
            self.parts.append(
                f'<image x="{x + i * (self.image_width + 4):.1f}" y="{y + self.font + 6:.1f}" width="{self.image_width:.1f}" '
                f'height="{self.image_height:.1f}" preserveAspectRatio="none" href="data:image/png;base64,{data}"/>')

    def add_scale(self, low="0", high="255 counts"):
        """A bar of the colours in a cell of its own."""
        x, y = self.place()
        stops = "".join(f'<stop offset="{i / 5}" stop-color="#{r:02x}{g:02x}{b:02x}"/>' for i, (r, g, b) in enumerate(inferno))
        wide, top = self.cell - 8, y + self.font + 6 + self.image_height / 2 - 10
        self.parts.append(
            f'<linearGradient id="inferno">{stops}</linearGradient><rect x="{x:.1f}" y="{top:.1f}" width="{wide:.1f}" height="14" '
            f'fill="url(#inferno)"/><text x="{x:.1f}" y="{top + 16 + self.font:.1f}" text-anchor="start">{low}</text>'
            f'<text x="{x + wide:.1f}" y="{top + 16 + self.font:.1f}" text-anchor="end">{high}</text>')

    def svg(self, note=""):
        height = -(-self.count // self.columns) * self.row + (22 if note else 0)
        if note:
            self.parts.append(f'<text x="320" y="{height - 6:.1f}" font-size="12.5" fill="{self.colours["quiet"]}">{note}</text>')
        body = "\n".join(self.parts)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="{height:.0f}" viewBox="0 0 640 {height:.0f}" '
                f'font-family="Helvetica, Arial, sans-serif" font-size="{self.font}" text-anchor="middle" '
                f'fill="{self.colours["ink"]}">\n<style>image{{image-rendering:pixelated}}</style>\n{body}\n</svg>\n')
