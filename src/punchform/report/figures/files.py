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
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from punchform.report.figures.style import PAPER

RASTER = 190
"""Resolution [dpi] of what is rasterised inside an SVG."""
COLOURS = 256
BLENDS = 63
"""So many colours are left where lines are blended with the paper."""
METHOD = Image.Quantize.MEDIANCUT
FONTS = "DejaVu Sans, Verdana, Segoe UI, Roboto, Helvetica, Arial, sans-serif"
NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))
PLAIN = "!$&'()*+,-./:;=?@[]_~ <>{}|^"
"""Characters that a data address inside an attribute may hold as they are."""


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG at `path` and as SVG beside it. Raises OSError when the disk refuses."""
    path.write_bytes(png(figure))
    save_for_page(figure, path)


def save_for_page(figure: Figure, path: Path) -> None:
    """Write a figure as SVG beside `path`, which is all that a page reads. Raises OSError when the disk refuses."""
    path.with_suffix(".svg").write_text(svg(figure), encoding="utf-8", newline="\n")


def png(figure: Figure) -> bytes:
    """The figure as PNG with 256 colours: a third of the bytes of one with all of them."""
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3])
    written = BytesIO()
    drawn.quantize(COLOURS, method=METHOD, dither=Image.Dither.NONE).save(written, format="png", compress_level=6)
    return written.getvalue()


def svg(figure: Figure) -> str:
    """The figure as SVG without background, its dense parts one picture each; letters stay letters."""
    for artist in figure.findobj(_filled):
        # Cells without blended edges have no more colours than their scale; thin lines need the blend.
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
    """The data address of a figure that was saved to this path, for the source of an image."""
    return "data:image/svg+xml," + quote(path.with_suffix(".svg").read_text(encoding="utf-8"), safe=PLAIN)


def _filled(artist: Artist) -> bool:
    return isinstance(artist, Collection) and bool(artist.get_rasterized()) and len(artist.get_facecolor()) > 0


def _rounded(places: re.Match[str]) -> str:
    """An attribute with its lengths [pt] to the hundredth of a point."""
    return re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), places[0])


def _smaller(picture: re.Match[str]) -> str:
    image = Image.open(BytesIO(base64.b64decode(picture[1]))).convert("RGBA")
    return "data:image/png;base64," + base64.b64encode(_indexed(np.asarray(image))).decode("ascii")


def _indexed(pixels: NDArray[np.uint8]) -> bytes:
    """Pixels (n, m, 4) as PNG with a palette: exact where 256 colours are enough, else the blends on paper merged."""
    codes, number = np.unique(pixels.view(np.uint32), return_inverse=True)
    number = number.reshape(pixels.shape[:2])
    if len(codes) <= COLOURS:
        palette = codes.view(np.uint8).reshape(-1, 4)
    else:
        share = pixels[:, :, 3:] / 255.0
        blended = (share * pixels[:, :, :3] + (1.0 - share) * np.array(to_rgb(PAPER)) * 255.0).round().astype(np.uint8)
        few = Image.fromarray(blended).quantize(BLENDS, method=METHOD, dither=Image.Dither.NONE)
        found = np.array(few.getpalette() or (), np.uint8).reshape(-1, 3)[:BLENDS]
        opaque = np.column_stack((found, np.full(len(found), 255, np.uint8)))
        palette = np.concatenate((opaque, np.zeros((1, 4), np.uint8)))
        number = np.where(pixels[:, :, 3] == 0, len(found), np.asarray(few))
    image = Image.fromarray(number.astype(np.uint8))
    image.putpalette(palette[:, :3].tobytes())
    written = BytesIO()
    image.save(written, format="png", compress_level=6, transparency=palette[:, 3].tobytes())
    return written.getvalue()
