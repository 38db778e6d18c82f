"""Pictures in a row as one file: animated pictures and video.

A new format is one entry of `ANIMATION_FORMATS`.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from importlib.util import find_spec
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput, PaminsaError

if TYPE_CHECKING:
    from PIL import Image

Frames = Iterator[NDArray[np.uint8]]
"""Pictures (h, w, 3), all of one size; each is compressed as it comes."""


@dataclass(frozen=True)
class AnimationFormat:
    """A format of animations.

    Attributes:
        label: Name on a button.
        encoder: Returns the pictures as one file, given the time between two of them [s] and how
            many they are.
        package: What it needs that a plain installation lacks, as imported; empty for nothing.
        extra: The extra of this project that installs it.
    """

    label: str
    encoder: Callable[[Frames, float, int], bytes]
    package: str = ""
    extra: str = ""

    def encode(self, frames: Frames, step: float, count: int) -> bytes:
        """Return pictures as one file.

        Args:
            frames: At least one; each is asked for when those before it are compressed.
            step: Time between two of them [s].
            count: How many they are.

        Raises:
            InvalidInput: If there is no picture, they differ in size, or the time is none.
            PaminsaError: If they cannot be encoded.
        """
        if not 0 < step < math.inf:
            raise InvalidInput("step", f"{step:g} s is no time between two pictures")
        frames = iter(frames)
        first = next(frames, None)
        if first is None:
            raise InvalidInput("pictures", "there is none: an animation needs at least one")
        try:
            return self.encoder(_of_size(first.shape, chain([first], frames)), step, count)
        except PaminsaError:
            raise
        except (OSError, ValueError, RuntimeError) as error:  # Pillow's and PyAV's
            raise PaminsaError(f"the {self.label} could not be made: {error}") from error

    @property
    def missing(self) -> str:
        """What has to be installed for it, empty for nothing."""
        if not self.package or find_spec(self.package) is not None:
            return ""
        return f'It needs the package “{self.package}”: pip install "paminsa-viz[{self.extra}]"'


def _of_size(shape: tuple[int, ...], frames: Frames) -> Frames:
    for frame in frames:
        if frame.shape != shape:
            found = " and ".join(f"{width}×{height}" for height, width, *_ in (shape, frame.shape))
            raise InvalidInput("pictures", f"all need one size, these have {found} pixels")
        yield frame


def _gif(frames: Frames, step: float, count: int) -> bytes:
    from PIL import Image

    del count

    def images() -> Iterator[Image.Image]:
        for frame in frames:
            image = Image.fromarray(frame)
            yield image.quantize(255, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)

    return _animated_picture("GIF", images(), step, 10, {"disposal": 1, "optimize": False})


def _webp(frames: Frames, step: float, count: int) -> bytes:
    from PIL import Image

    options = {"quality": 80, "method": 2}
    pictures = map(Image.fromarray, frames)
    return _animated_picture("WEBP", pictures, step, 1, options, count_of_one=count)


def _animated_picture(
    kind: str,
    images: Iterator[Image.Image],
    step: float,
    unit: int,
    options: dict[str, Any],
    count_of_one: int = 0,
) -> bytes:
    """Return pictures as one that runs over and over, in a format of Pillow's.

    Args:
        kind: Pillow's name of the format.
        images: The pictures.
        step: Time between two of them [s].
        unit: What the format counts times in [ms].
        options: Of the format.
        count_of_one: How many pictures there are, for a format of which Pillow asks for all images
            before it compresses the first, but for the pictures of one image in their turn.
    """
    durations: list[int] = []  # Pillow reads that of a picture once it has the picture

    def timed() -> Iterator[Image.Image]:
        for index, image in enumerate(images, 1):
            # What one picture lacks of a whole number of units, a later one has.
            durations.append(unit * round(1e3 * index * step / unit) - sum(durations))
            yield image

    pictures = timed()
    first = next(pictures)
    if count_of_one:

        def seek(index: int) -> None:
            if index:  # at the end Pillow goes back to the first, which is not looked at again
                first.paste(next(pictures))

        vars(first).update(n_frames=count_of_one, seek=seek)
    stream = io.BytesIO()
    first.save(
        stream, format=kind, append_images=() if count_of_one else pictures, save_all=True, loop=0,
        duration=durations, **options,
    )  # fmt: skip
    return stream.getvalue()


_QUALITY: Final = "20"
"""Constant rate factor of H.264; 0 is lossless, 23 its default, 51 the worst."""
_BT709: Final = 1
"""Number of ITU-R BT.709 in H.264, for matrix, primaries and transfer: of a video that does not
say its own, players take that of large pictures, and another one of small ones."""


def _mp4(frames: Frames, step: float, count: int) -> bytes:
    """Return pictures as a video: H.264 with colors at half the resolution, as all players read."""
    import av
    from av.video.reformatter import ColorRange, Colorspace

    del count

    stream = io.BytesIO()
    with av.open(stream, "w", format="mp4") as container:
        rate = Fraction(1.0 / step).limit_denominator(10_000)
        video = container.add_stream("libx264", rate=rate, options={"crf": _QUALITY})
        video.pix_fmt = "yuv420p"
        context = video.codec_context
        context.colorspace = context.color_primaries = context.color_trc = _BT709
        context.color_range = ColorRange.MPEG
        for index, frame in enumerate(frames):
            height, width = (side // 2 * 2 for side in frame.shape[:2])  # it has even sides only
            if index == 0:
                video.width, video.height = width, height
            picture = np.ascontiguousarray(frame[:height, :width])
            colored = av.VideoFrame.from_ndarray(picture, format="rgb24").reformat(
                format="yuv420p",
                dst_colorspace=Colorspace.ITU709,
                dst_color_range=ColorRange.MPEG,
            )
            container.mux(video.encode(colored))
        container.mux(video.encode(None))
    return stream.getvalue()


ANIMATION_FORMATS: dict[str, AnimationFormat] = {
    "gif": AnimationFormat("GIF", _gif),
    "webp": AnimationFormat("WebP", _webp),
    "mp4": AnimationFormat("MP4", _mp4, package="av", extra="video"),
}
"""Every format of animations, by the ending of its files."""
