"""Figures as files: PNG for a document, and SVG for the page and for print; the same figure gives the same bytes.

What is dense (every cell, every wire) is marked as rasterised where it is drawn, so that an SVG is lines and letters
around one picture of few colours: as small for a hundred thousand wires as for a thousand.
"""

from __future__ import annotations

import base64
import re
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from PIL import Image

RASTER = 190
"""Resolution [dpi] of what is rasterised inside an SVG."""
COLOURS = 256
FONTS = "DejaVu Sans, Verdana, Segoe UI, Roboto, Helvetica, Arial, sans-serif"
NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))
PLAIN = "!$&'()*+,-./:;=?@[]_~ <>{}|^"
"""Characters that a data address inside an attribute may hold as they are."""


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG at `path` and as SVG beside it. Raises OSError when the disk refuses."""
    path.write_bytes(png(figure))
    path.with_suffix(".svg").write_text(svg(figure), encoding="utf-8", newline="\n")


def png(figure: Figure) -> bytes:
    """The figure as PNG with 256 colours: a third of the bytes of one with all of them."""
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3])
    return _few_colours(drawn, Image.Quantize.MEDIANCUT)


def svg(figure: Figure) -> str:
    """The figure as SVG without background, its dense parts one picture each; letters stay letters."""
    for artist in figure.findobj(_rasterised):
        # Without blended edges a picture has no more colours than its scale.
        artist.set_antialiased(False)  # type: ignore[attr-defined]
    drawn = BytesIO()
    with rc_context({"svg.hashsalt": "punchform", "svg.fonttype": "none"}):
        figure.savefig(drawn, format="svg", dpi=RASTER, metadata=NO_METADATA, facecolor="none")
    text = drawn.getvalue().decode("utf-8")
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"(?<= )(?:d|x|y|transform)=\"[^\"]*\"", _rounded, text)
    text = re.sub(r"font(-family)?: ([^;\"]*?)'DejaVu Sans'[^;\"]*", rf"font\1: \2{FONTS}", text)
    text = re.sub(r"<g id=\"[a-zA-Z_.]+_\d+\">", "<g>", re.sub(r"\s*\n\s*", "\n", text))
    return re.sub(r"data:image/png;base64,([^\"]+)", _smaller, text)


def address(path: Path) -> str:
    """The data address of a figure that `save` wrote to this path, for the source of an image."""
    return "data:image/svg+xml," + quote(path.with_suffix(".svg").read_text(encoding="utf-8"), safe=PLAIN)


def _rasterised(artist: Artist) -> bool:
    return bool(artist.get_rasterized()) and isinstance(artist, Collection)


def _rounded(places: re.Match[str]) -> str:
    """An attribute with its lengths [pt] to the hundredth of a point."""
    return re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), places[0])


def _smaller(picture: re.Match[str]) -> str:
    image = Image.open(BytesIO(base64.b64decode(picture[1])))
    return "data:image/png;base64," + base64.b64encode(_few_colours(image, Image.Quantize.FASTOCTREE)).decode("ascii")


def _few_colours(image: Image.Image, method: Image.Quantize) -> bytes:
    written = BytesIO()
    few = image.quantize(COLOURS, method=method, dither=Image.Dither.NONE)
    few.save(written, format="png", compress_level=6)
    return written.getvalue()
