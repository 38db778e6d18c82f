"""Pictures in a row as one file: animated pictures and video.

A new format is one entry of `ANIMATION_FORMATS`.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from importlib.util import find_spec
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Frames = Iterator[NDArray[np.uint8]]
"""Pictures (h, w, 3), all of one size; each is compressed as it comes."""


@dataclass(frozen=True)
class AnimationFormat:
    """A format of animations.

    Attributes:
        label: Name on a button.
        encode: Returns the pictures as one file, given the time between two of them [s].
        package: What it needs that a plain installation lacks, as imported; empty for nothing.
        extra: The extra of this project that installs it.
    """

    label: str
    encode: Callable[[Frames, float], bytes]
    package: str = ""
    extra: str = ""

    @property
    def missing(self) -> str:
        """What has to be installed for it, empty for nothing."""
        if not self.package or find_spec(self.package) is not None:
            return ""
        return f"It needs the package “{self.package}”: pip install 'paminsa-viz[{self.extra}]'"


def _animated_picture(kind: str, options: dict[str, Any], frames: Frames, step: float) -> bytes:
    """Return pictures as one that runs over and over, in a format of Pillow's."""
    from PIL import Image

    def images() -> Iterator[Image.Image]:
        for frame in frames:
            image = Image.fromarray(frame)
            yield (
                image
                if kind != "gif"
                else image.quantize(255, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
            )

    rest = images()
    first = next(rest)
    stream = io.BytesIO()
    first.save(
        stream, format=kind.upper(), append_images=rest, save_all=True,
        duration=round(1e3 * step), loop=0, **options,
    )  # fmt: skip
    return stream.getvalue()


_QUALITY: Final = "20"
"""Constant rate factor of H.264; 0 is lossless, 23 its default, 51 the worst."""


def _mp4(frames: Frames, step: float) -> bytes:
    """Return pictures as a video: H.264 with colors at half the resolution, as all players read."""
    import av

    stream = io.BytesIO()
    with av.open(stream, "w", format="mp4") as container:
        rate = Fraction(1.0 / step).limit_denominator(10_000)
        video = container.add_stream("libx264", rate=rate, options={"crf": _QUALITY})
        video.pix_fmt = "yuv420p"
        for index, frame in enumerate(frames):
            height, width = (side // 2 * 2 for side in frame.shape[:2])  # it has even sides only
            if index == 0:
                video.width, video.height = width, height
            picture = np.ascontiguousarray(frame[:height, :width])
            container.mux(video.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(video.encode(None))
    return stream.getvalue()


ANIMATION_FORMATS: dict[str, AnimationFormat] = {
    "gif": AnimationFormat(
        "GIF", partial(_animated_picture, "gif", {"disposal": 1, "optimize": False})
    ),
    "webp": AnimationFormat(
        "WebP", partial(_animated_picture, "webp", {"quality": 80, "method": 2})
    ),
    "mp4": AnimationFormat("MP4", _mp4, package="av", extra="video"),
}
"""Every format of animations, by the ending of its files."""
