"""A small raster to draw on: numbers, anti-aliased lines and pictures, in a few milliseconds.

For pictures that are made again many times a second. matplotlib takes a hundred times as long, and
Pillow's lines have no smooth edges; Pillow only turns strings into masks, which are kept.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from paminsa_viz.palette import rgb

Across = Literal["left", "middle", "right"]
Down = Literal["top", "middle", "bottom"]
_SHARE = {"left": 0.0, "top": 0.0, "middle": 0.5, "right": 1.0, "bottom": 1.0}
_STEP = 0.8  # pixels between two samples along a line; below 1, so that no gaps show


@dataclass(frozen=True)
class Stroke:
    """Polylines drawn alike.

    Attributes:
        lines: Arrays (n, 2) of x, y [pixels]; a point that is not finite parts two lines.
        width: Width [pixels].
        opacity: From 0 to 1.
        dash: Lengths of stroke and space [pixels], or None.
    """

    lines: Sequence[NDArray[np.float64]]
    width: float = 1.0
    opacity: float = 1.0
    dash: tuple[float, float] | None = None


_kept = threading.local()


class Canvas:
    """A white picture to draw on; x runs right, y runs down, in pixels.

    Attributes:
        pixels: The picture (height, width, 3) uint8.
    """

    def __init__(self, width: int, height: int) -> None:
        self.pixels: NDArray[np.uint8] = np.full((height, width, 3), 255, dtype=np.uint8)

    def paste(self, left: int, top: int, picture: NDArray[np.uint8]) -> None:
        """Copy a picture (h, w, 3) that lies wholly on the canvas."""
        self.pixels[top : top + picture.shape[0], left : left + picture.shape[1]] = picture

    def fill(self, left: int, top: int, width: int, height: int, color: str) -> None:
        """Fill a rectangle."""
        self.pixels[max(top, 0) : top + height, max(left, 0) : left + width] = rgb(color)

    def text(
        self,
        x: float,
        y: float,
        words: str,
        size: int,
        color: str,
        *,
        across: Across = "middle",
        down: Down = "middle",
        bold: bool = False,
        upright: bool = False,
    ) -> None:
        """Write words with the given point of their box at (x, y); upright reads from below."""
        mask = _text_mask(words, size, bold, upright)
        left = round(x - mask.shape[1] * _SHARE[across])
        top = round(y - mask.shape[0] * _SHARE[down])
        self._blend(left, top, mask, color)

    def strokes(self, strokes: Sequence[Stroke], color: str) -> None:
        """Draw strokes of one color, smooth-edged; what lies off the canvas is left out."""
        drawn = [found for stroke in strokes if (found := _samples(stroke)) is not None]
        if not drawn:
            return
        height, width = self.pixels.shape[:2]
        # A sample is spread over the four pixels around it, whose centers are at half numbers.
        x = np.concatenate([part[0] for part in drawn]) - 0.5
        y = np.concatenate([part[1] for part in drawn]) - 0.5
        weight = np.concatenate([part[2] for part in drawn])
        inside = (x >= 0) & (x < width - 1) & (y >= 0) & (y < height - 1)
        x, y, weight = x[inside], y[inside], weight[inside]
        if x.size == 0:
            return
        column, row = x.astype(np.intp), y.astype(np.intp)
        fx, fy = x - column, y - row
        cell = row * width + column
        lower, upper = weight * (1 - fy), weight * fy
        left, right = lower * fx, upper * fx
        cover = _scratch(height * width)
        np.add.at(cover, cell, lower - left)
        np.add.at(cover, cell + 1, left)
        np.add.at(cover, cell + width, upper - right)
        np.add.at(cover, cell + width + 1, right)
        touched = np.flatnonzero(cover > 0)
        alpha = np.minimum(cover[touched], 1.0).astype(np.float32)[:, None]
        cover[touched] = 0.0
        flat = self.pixels.reshape(-1, 3)
        under = flat.take(touched, axis=0)
        mixed = np.subtract(np.array(rgb(color)), under, dtype=np.float32)
        mixed *= alpha
        mixed += under
        mixed += np.float32(0.5)
        flat[touched] = mixed

    def disc(self, x: float, y: float, radius: float, color: str) -> None:
        """Fill a smooth-edged disc."""
        left, top = int(x - radius) - 2, int(y - radius) - 2
        size = int(2 * radius) + 5
        along = np.arange(size) + 0.5
        distance = np.hypot(along[None, :] + left - x, along[:, None] + top - y)
        self._blend(left, top, np.clip(radius + 0.5 - distance, 0.0, 1.0), color)

    def _blend(self, left: int, top: int, mask: NDArray[np.float64], color: str) -> None:
        height, width = self.pixels.shape[:2]
        x0, y0 = max(left, 0), max(top, 0)
        x1, y1 = min(left + mask.shape[1], width), min(top + mask.shape[0], height)
        if x1 <= x0 or y1 <= y0:
            return
        alpha = mask[y0 - top : y1 - top, x0 - left : x1 - left, None]
        view = self.pixels[y0:y1, x0:x1]
        view[...] = view + (np.array(rgb(color)) - view) * alpha + 0.5


def text_width(words: str, size: int, bold: bool = False) -> int:
    """Return how wide words are drawn [pixels]."""
    return _text_mask(words, size, bold, False).shape[1]


@lru_cache(maxsize=2048)
def _text_mask(words: str, size: int, bold: bool, upright: bool) -> NDArray[np.float64]:
    font = _font(size, bold)
    left, _, right, _ = font.getbbox(words)
    ascent, descent = font.getmetrics()
    # Height from the font and not from the letters, so that all words share one base line.
    picture = Image.new("L", (max(1, int(right - left) + 1), ascent + descent))
    ImageDraw.Draw(picture).text((-left, 0), words, font=font, fill=255)
    mask = np.asarray(picture, dtype=np.float64) / 255
    mask = mask[ascent // 5 :]  # DejaVu leaves this much above its capitals
    return np.rot90(mask).copy() if upright else mask


@lru_cache(maxsize=16)
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    # matplotlib brings this font, with Greek letters and subscripts, to every machine; asking for
    # the place of the package does not import it.
    spec = find_spec("matplotlib")
    if spec is None or spec.origin is None:
        raise ImportError("matplotlib is needed for its fonts")
    folder = Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf"
    name = f"DejaVuSans{'-Bold' if bold else ''}.ttf"
    # The basic engine is the one that every build of Pillow has, so pictures agree.
    return ImageFont.truetype(str(folder / name), size, layout_engine=ImageFont.Layout.BASIC)


def _scratch(size: int) -> NDArray[np.float64]:
    """Return this thread's array of zeros; who takes it leaves zeros behind.

    Fresh memory of this size costs more than all the drawing.
    """
    kept = getattr(_kept, "cover", None)
    if kept is None or kept.size < size:
        kept = _kept.cover = np.zeros(size)
    return kept[:size]


def _samples(
    stroke: Stroke,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """Return x, y and weight of points set densely along all lines."""
    dash, width = stroke.dash, stroke.width
    lines = [line for line in stroke.lines if len(line) > 1]
    if not lines:
        return None
    start = np.concatenate([line[:-1] for line in lines])
    way = np.concatenate([line[1:] for line in lines]) - start
    length = np.hypot(way[:, 0], way[:, 1])
    keep = length > 0  # and not at a point that parts two lines
    start, way, length = start[keep], way[keep], length[keep]
    if length.size == 0:
        return None
    count = np.ceil(length / _STEP).astype(np.intp)
    of = np.repeat(np.arange(count.size), count)
    first = np.cumsum(count) - count
    along = (np.arange(of.size) - first[of] + 0.5) / count[of]
    weight = (length / count * stroke.opacity)[of]
    if dash is not None:
        traveled = (np.cumsum(length) - length)[of] + along * length[of]
        shown = traveled % (dash[0] + dash[1]) < dash[0]
        of, along, weight = of[shown], along[shown], weight[shown]
    x = start[of, 0] + along * way[of, 0]
    y = start[of, 1] + along * way[of, 1]
    passes = max(1, round(width))
    if passes == 1:
        return x, y, weight * width
    normal_x, normal_y = -way[of, 1] / length[of], way[of, 0] / length[of]
    offsets = np.arange(passes) - (passes - 1) / 2
    return (
        np.concatenate([x + offset * normal_x for offset in offsets]),
        np.concatenate([y + offset * normal_y for offset in offsets]),
        np.tile(weight * width / passes, passes),
    )
