"""Makes a picture of what `poescope view --print` wrote: python3 docs/picture.py < screen.ansi screen.png

Wants Pillow and DejaVu Sans Mono (Debian: fonts-dejavu-core). Half-blocks and block elements are drawn as rectangles,
so that frames have no seams.
"""

import re
import sys

from PIL import Image, ImageDraw, ImageFont

CELL = (10, 20)
FONT = ImageFont.truetype("DejaVuSansMono.ttf", 16)
INK, PAPER = (208, 208, 208), (18, 18, 18)
FADED = (128, 128, 128)
# Places of the eight dots of a braille character, in the order of its bits.
DOTS = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)]


def style(codes, state):
    """Applies one SGR sequence to (ink, paper, dim, bold, reverse)."""
    ink, paper, dim, bold, reverse = state
    numbers = [int(code or 0) for code in codes.split(";")]
    while numbers:
        code = numbers.pop(0)
        if code == 0:
            ink, paper, dim, bold, reverse = None, None, False, False, False
        elif code in (38, 48):
            assert numbers.pop(0) == 2, "only true colour"
            colour, numbers = tuple(numbers[:3]), numbers[3:]
            ink, paper = (colour, paper) if code == 38 else (ink, colour)
        elif code == 39:
            ink = None
        elif code == 49:
            paper = None
        elif code in (1, 22):
            bold, dim = code == 1, dim and code == 1
        elif code == 2:
            dim = True
        elif code in (7, 27):
            reverse = code == 7
    return ink, paper, dim, bold, reverse


def cells(line):
    """Characters of a line with their colours."""
    state = (None, None, False, False, False)
    for codes, text in re.findall(r"\x1b\[([\d;]*)m|([^\x1b])", line):
        if not text:
            state = style(codes, state)
            continue
        ink, paper, dim, _, reverse = state
        ink, paper = ink or (FADED if dim else INK), paper or PAPER
        yield (text, paper, ink) if reverse else (text, ink, paper)


def main():
    lines = [list(cells(line)) for line in sys.stdin.read().splitlines()]
    width, height = max(map(len, lines)), len(lines)
    picture = Image.new("RGB", (width * CELL[0], height * CELL[1]), PAPER)
    draw = ImageDraw.Draw(picture)
    for row, line in enumerate(lines):
        for column, (text, ink, paper) in enumerate(line):
            x, y = column * CELL[0], row * CELL[1]
            right, bottom = x + CELL[0] - 1, y + CELL[1] - 1
            draw.rectangle((x, y, right, bottom), paper)
            if text == "▀":
                draw.rectangle((x, y, right, y + CELL[1] // 2 - 1), ink)
            elif text == "▄":
                draw.rectangle((x, y + CELL[1] // 2, right, bottom), ink)
            elif text == "█":
                draw.rectangle((x, y, right, bottom), ink)
            elif "▁" <= text <= "▇":
                draw.rectangle((x, bottom + 1 - (ord(text) - 0x2580) * CELL[1] // 8, right, bottom), ink)
            elif "\u2800" <= text <= "\u28ff":
                for bit, (left, top) in enumerate(DOTS):
                    if (ord(text) - 0x2800) >> bit & 1:
                        dot = (x + 2 + 5 * left, y + 2 + 5 * top)
                        draw.rectangle((*dot, dot[0] + 1, dot[1] + 1), ink)
            elif text != " ":
                draw.text((x, y), text, ink, FONT)
    picture.save(sys.argv[1], optimize=True)


main()
