"""A sheet of SVG with the few shapes that the drawings of the docs are made of.

Lengths are in pixels of the sheet, y down; angles in degrees, clockwise from +x as they are seen.
"""

from xml.sax.saxutils import escape

BLUE = "#1f6fb4"     # under control
ORANGE = "#d9822b"   # human-driven
GREEN = "#2f8f4e"
RED = "#c23b3b"
PURPLE = "#7a4fa3"
INK = "#222222"
GREY = "#8a8f96"
ROAD = "#dfe2e6"

_HEAD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" \
font-family="Helvetica, Arial, sans-serif" font-size="14">
<title>{title}</title>
<rect width="{w}" height="{h}" fill="#ffffff"/>
"""


def _number(value):
    return f"{value:.1f}".rstrip("0").rstrip(".")


class Sheet:
    def __init__(self, width, height, title):
        self._parts = [_HEAD.format(w=width, h=height, title=escape(title))]

    def add(self, element):
        self._parts.append(element + "\n")

    def rect(self, x, y, width, height, fill, stroke="none", opacity=1.0):
        self.add(f'<rect x="{_number(x)}" y="{_number(y)}" width="{_number(width)}" '
                 f'height="{_number(height)}" fill="{fill}" stroke="{stroke}" '
                 f'fill-opacity="{opacity}"/>')

    def circle(self, x, y, radius, fill="none", stroke=INK, opacity=1.0):
        self.add(f'<circle cx="{_number(x)}" cy="{_number(y)}" r="{_number(radius)}" '
                 f'fill="{fill}" stroke="{stroke}" fill-opacity="{opacity}"/>')

    def path(self, data, stroke=INK, width=2.0, fill="none", dash="", opacity=1.0):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(f'<path d="{data}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"'
                 f'{dashes} opacity="{opacity}"/>')

    def line(self, x0, y0, x1, y1, stroke=INK, width=1.5, dash=""):
        self.path(f"M{_number(x0)} {_number(y0)} L{_number(x1)} {_number(y1)}", stroke, width,
                  dash=dash)

    def polyline(self, points, stroke=INK, width=2.0, fill="none", dash="", opacity=1.0):
        data = "M" + " L".join(f"{_number(x)} {_number(y)}" for x, y in points)
        self.path(data, stroke, width, fill, dash, opacity)

    def arrow(self, x0, y0, x1, y1, stroke=INK, width=1.5):
        """A straight arrow that ends at (x1, y1)."""
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        bx, by = x1 - 9 * ux, y1 - 9 * uy
        self.line(x0, y0, bx, by, stroke, width)
        self.polyline([(bx - 4 * uy, by + 4 * ux), (x1, y1), (bx + 4 * uy, by - 4 * ux)],
                      "none", 0, fill=stroke)

    def text(self, x, y, words, color=INK, anchor="start", size=14, weight="normal"):
        self.add(f'<text x="{_number(x)}" y="{_number(y)}" fill="{color}" font-size="{size}" '
                 f'text-anchor="{anchor}" font-weight="{weight}">{escape(words)}</text>')

    def car(self, x, y, heading=0, fill=BLUE, length=34, width=15, label="", opacity=1.0):
        """A car with its middle at (x, y); its windscreen shows where it looks."""
        self.add(f'<g transform="translate({_number(x)} {_number(y)}) rotate({_number(heading)})" '
                 f'opacity="{opacity}"><rect x="{_number(-length / 2)}" y="{_number(-width / 2)}" '
                 f'width="{_number(length)}" height="{_number(width)}" rx="3" fill="{fill}"/>'
                 f'<rect x="{_number(length / 6)}" y="{_number(-width / 2 + 2)}" '
                 f'width="{_number(length / 6)}" height="{_number(width - 4)}" fill="#ffffff" '
                 f'fill-opacity="0.75"/></g>')
        if label:
            self.text(x, y + 5, label, "#ffffff", "middle", 12, "bold")

    def svg(self):
        return "".join(self._parts) + "</svg>\n"
