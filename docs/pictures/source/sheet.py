"""Sheets of pressure images with labels, as SVG: reads the PNG files that the example programs write."""
import base64
import math
import struct
import zlib

from svg import follow_theme, light

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


def png_of(rows, palette=None, clear=None):
    """A PNG file of 8 bits per pixel: numbers of colours in a palette, of which `clear` is transparent, or grey."""
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3 if palette else 0, 0, 0, 0)
    colours = chunk(b"PLTE", b"".join(map(bytes, palette))) if palette else b""
    if clear is not None:
        colours += chunk(b"tRNS", b"\xff" * clear + b"\0")
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + colours + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def tactels(rows, column, row=0, zoom=2, gap=8, shape=(28, 50)):
    """The pressures of one picture of a sheet of examples/support/sheet.hpp, a value per tactel."""
    top, left = gap + row * (shape[0] * zoom + gap), gap + column * (shape[1] * zoom + gap)
    return [[(240 - min(rows[top + y * zoom + zoom // 2][left + x * zoom + zoom // 2], 240)) / 240 for x in range(shape[1])]
            for y in range(shape[0])]


class sheet:
    """Rows of cells with a label above each; a cell is one image or several side by side. All images are one picture, whose
    pixels are the tactels."""

    width, gap, inner_gap, steps = 640, 4, 2, 32

    def __init__(self, columns, images=1, font=14):
        self.columns, self.font = columns, font
        self.cell = images * (50 + self.inner_gap) - self.inner_gap # in tactels, as what follows
        self.across = columns * (self.cell + self.gap) - self.gap
        self.tactel = self.width / self.across # in pixels of the page
        self.label = math.ceil((font + 6) / self.tactel)
        self.row = self.label + 28 + math.ceil(6 / self.tactel)
        self.parts, self.pixels, self.count = [], [], 0

    def place(self):
        """Where the next cell is."""
        at = (self.count % self.columns * (self.cell + self.gap), self.count // self.columns * self.row)
        self.count += 1
        while len(self.pixels) < at[1] + self.row:
            self.pixels.append([self.steps] * self.across) # transparent
        return at

    def add(self, label, *images):
        """Images of pressures between 0 and 1, light ones lifted: a hand presses a tenth of what a key does."""
        x, y = self.place()
        self.parts.append(f'<text x="{(x + self.cell / 2) * self.tactel:.1f}" '
                          f'y="{(y + self.label) * self.tactel - 5:.1f}">{label}</text>')
        for number, levels in enumerate(images):
            left = x + number * (50 + self.inner_gap)
            for line, row in enumerate(levels):
                self.pixels[y + self.label + line][left:left + 50] = [round(level ** 0.6 * (self.steps - 1)) for level in row]

    def add_scale(self, low="0", high="255 counts"):
        """A bar of the colours in a cell of its own."""
        x, y = (length * self.tactel for length in self.place())
        stops = "".join(f'<stop offset="{i / 5}" stop-color="#{r:02x}{g:02x}{b:02x}"/>' for i, (r, g, b) in enumerate(inferno))
        wide, top = self.cell * self.tactel, y + (self.label + 10) * self.tactel
        self.parts.append(
            f'<linearGradient id="inferno">{stops}</linearGradient><rect x="{x:.1f}" y="{top:.1f}" width="{wide:.1f}" height="14" '
            f'fill="url(#inferno)"/><text x="{x:.1f}" y="{top + 16 + self.font:.1f}" text-anchor="start">{low}</text>'
            f'<text x="{x + wide:.1f}" y="{top + 16 + self.font:.1f}" text-anchor="end">{high}</text>')

    def svg(self, note=""):
        below = len(self.pixels) * self.tactel
        height = below + (20 if note else 0)
        palette = [colour_of(i / (self.steps - 1)) for i in range(self.steps)] + [(0, 0, 0)]
        data = base64.b64encode(png_of(self.pixels, palette, clear=self.steps)).decode()
        words = "\n".join(self.parts)
        if note:
            words += f'\n<text x="320" y="{height - 6:.1f}" font-size="12.5" fill="{light["quiet"]}">{note}</text>'
        return follow_theme(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="{height:.0f}" viewBox="0 0 640 {height:.0f}" '
            f'font-family="Helvetica, Arial, sans-serif" font-size="{self.font}" text-anchor="middle" '
            f'fill="{light["ink"]}">\n<image width="640" height="{below:.2f}" preserveAspectRatio="none" '
            f'style="image-rendering:pixelated" href="data:image/png;base64,{data}"/>\n{words}\n</svg>\n')
