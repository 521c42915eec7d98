"""Recordings of programs in a terminal, as SVG that moves: what a program writes to a terminal, and when."""
import base64
import codecs
import fcntl
import html
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time

from sheet import png_of

ground, ink, quiet = "#0d1117", "#d6dce3", "#9aa4af" # the same in both themes: a terminal is dark
cell, line = 8.4, 17


def record(command, columns, rows, standard_input=None, cwd=None):
    """Runs a program in a terminal. Returns what it wrote, in pieces with their seconds, and its exit status."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    source = subprocess.PIPE if standard_input is not None else subprocess.DEVNULL
    child = subprocess.Popen([str(word) for word in command], stdin=source, stdout=slave, stderr=slave, cwd=cwd)
    os.close(slave)
    if standard_input is not None and os.fork() == 0: # feeds it, since it may write before it has read all
        try:
            child.stdin.write(standard_input)
            child.stdin.close()
        finally:
            os._exit(0)
    if child.stdin:
        child.stdin.close()
    begin, pieces = time.monotonic(), []
    while True:
        try:
            ready, _, _ = select.select([master], [], [], 1)
            piece = os.read(master, 65536) if ready else b""
        except OSError: # the program has ended
            break
        if ready:
            pieces.append((time.monotonic() - begin, piece))
    os.close(master)
    return pieces, child.wait()


class screen:
    """As much of a terminal as the programs use: lines, positions, erasing and colours of 24 bits."""

    def __init__(self, columns, rows):
        self.columns, self.rows = columns, rows
        self.cells = [[(" ", None, None)] * columns for _ in range(rows)]
        self.row = self.column = 0
        self.front = self.back = None
        self.rest = ""

    def write(self, text):
        text, self.rest = self.rest + text, ""
        for found in re.finditer(r"\x1b\[([\d;]*)([A-Za-z])|\x1b.*|[^\x1b]", text, re.S):
            if found[2]:
                self.obey([int(n or 0) for n in found[1].split(";")], found[2])
            elif found[0].startswith("\x1b"):
                self.rest = found[0] # its end comes with the next piece
            elif found[0] == "\n":
                self.feed()
            elif found[0] == "\r":
                self.column = 0
            else:
                if self.column == self.columns:
                    self.feed()
                    self.column = 0
                self.cells[self.row][self.column] = (found[0], self.front, self.back)
                self.column += 1

    def feed(self):
        self.row += 1
        if self.row == self.rows:
            self.row -= 1
            self.cells = self.cells[1:] + [[(" ", None, None)] * self.columns]

    def obey(self, numbers, letter):
        blank = (" ", None, None)
        if letter == "H":
            self.row = self.column = 0
        elif letter == "K":
            self.cells[self.row][self.column:] = [blank] * (self.columns - self.column)
        elif letter == "J":
            first = 0 if numbers[0] == 2 else self.row + (self.column > 0)
            for row in range(first, self.rows):
                self.cells[row] = [blank] * self.columns
        elif letter == "m" and numbers[:2] == [38, 2]:
            self.front = tuple(numbers[2:5])
        elif letter == "m" and numbers[:2] == [48, 2]:
            self.back = tuple(numbers[2:5])
        elif letter == "m":
            self.front = self.back = None
        else:
            raise ValueError(f"expected a sequence that the programs use, found ESC [ {numbers} {letter}")


def image_of(rows):
    """Half blocks as pixels, two rows of them per row of characters: a PNG file with a palette."""
    # Half of the bits of a colour are enough to the eye, and take half of the file.
    pixels = [[tuple(c & 0xf0 for c in cell_[1 + half] or (0, 0, 0)) for cell_ in row] for row in rows for half in (0, 1)]
    palette = sorted({colour for row in pixels for colour in row})
    if len(palette) > 256:
        raise ValueError(f"expected at most 256 colours on a screen, found {len(palette)}")
    number = {colour: i for i, colour in enumerate(palette)}
    return png_of([[number[colour] for colour in row] for row in pixels], palette)


def parts_of(cells):
    """What a screen shows: SVG elements, which do not depend on the rest of the screen."""
    parts, blocks = [], []
    for number, row in enumerate(cells + [[]]):
        characters = "".join(c[0] for c in row)
        drawn = characters.rstrip()
        if drawn and set(drawn) == {"▀"}:
            blocks.append(row[:len(drawn)])
            continue
        if blocks:
            data = base64.b64encode(image_of(blocks)).decode()
            parts.append(f'<image x="12" y="{10 + (number - len(blocks)) * line}" width="{len(blocks[0]) * cell:.0f}" '
                         f'height="{len(blocks) * line}" preserveAspectRatio="none" href="data:image/png;base64,{data}"/>')
            blocks = []
        if drawn:
            parts.append(f'<text x="12" y="{number * line + 24}" textLength="{len(drawn) * cell:.1f}">'
                         f'{html.escape(drawn, quote=False)}</text>')
    return parts


def animate(pieces, columns, rows, title, prompt="", pause=0.1, speed=1, hold=3):
    """The recording as SVG, shown again and again. Screens that last less than `pause` seconds are left out, `speed` makes
    it faster, `hold` is for how long the last one stays. `title` stands above the terminal, a command in it as `prompt`."""
    begin = 0 if prompt else pieces[0][0]
    terminal, states, decoder = screen(columns, rows), [], codecs.getincrementaldecoder("utf-8")("replace")
    if prompt:
        terminal.write(f"$ {prompt}\r\n")
    states.append((begin, parts_of(terminal.cells)))
    for when, piece in pieces:
        terminal.write(decoder.decode(piece))
        if when <= begin:
            states[0] = (begin, parts_of(terminal.cells))
        elif when - states[-1][0] < pause * speed and len(states) > 1:
            states[-1] = (states[-1][0], parts_of(terminal.cells))
        else:
            states.append((when, parts_of(terminal.cells)))
    length = (states[-1][0] - begin) / speed + hold
    # Each element from when it appears until it goes.
    shown, spans = {}, []
    for when, parts in [*states, (None, [])]:
        at = length if when is None else (when - begin) / speed
        for part in [p for p in shown if p not in parts]:
            spans.append((shown.pop(part), at, part))
        for part in parts:
            shown.setdefault(part, at)
    rules, body = [], []
    for number, (first, last, part) in enumerate(spans):
        if first <= 0 and last >= length:
            body.append(part)
            continue
        a, b = 100 * first / length, 100 * last / length
        steps = ("0%{visibility:hidden}" if a > 0 else "") + f"{a:.2f}%{{visibility:visible}}" + \
            (f"{b:.2f}%{{visibility:hidden}}" if b < 100 else "")
        rules.append(f"@keyframes k{number}{{{steps}}}")
        state = "visible" if b >= 100 else "hidden" # of who wants no movement: the last screen
        body.append(part.replace(" ", f' visibility="{state}" style="animation-name:k{number}" ', 1))
    width, height = columns * cell + 24, rows * line + 44
    style = "text{white-space:pre}image{image-rendering:pixelated}text,image{animation:" + f"{length:.1f}s step-end infinite}}" + \
        "@media(prefers-reduced-motion:reduce){text,image{animation:none!important}}" + "".join(rules)
    content = "\n".join(body)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height}" viewBox="0 0 {width:.0f} {height}" '
            f'font-family="ui-monospace, Menlo, Consolas, \'DejaVu Sans Mono\', monospace" font-size="14" fill="{ink}">\n'
            f'<style>{style}</style>\n<rect width="100%" height="100%" rx="8" fill="{ground}"/>\n'
            f'<text x="{width / 2:.0f}" y="19" text-anchor="middle" font-size="12.5" fill="{quiet}" style="animation:none" '
            f'font-family="Helvetica, Arial, sans-serif">{html.escape(title)}</text>\n<g transform="translate(0 22)">\n'
            f"{content}\n</g>\n</svg>\n")
