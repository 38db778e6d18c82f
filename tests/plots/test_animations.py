"""Animations under faults: each is answered in one line, and no file is made."""

from __future__ import annotations

import importlib.util
import io
import weakref
from collections.abc import Iterator

import numpy as np
import pytest
from PIL import Image, ImageSequence

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.plots.animations import ANIMATION_FORMATS, AnimationFormat, Frames

PICTURE = np.zeros((64, 80, 3), dtype=np.uint8)


@pytest.fixture(params=ANIMATION_FORMATS)
def animation(request: pytest.FixtureRequest) -> AnimationFormat:
    """Each format that is installed."""
    found = ANIMATION_FORMATS[request.param]
    if found.package and importlib.util.find_spec(found.package) is None:
        pytest.skip(found.missing)
    return found


def test_no_picture_is_refused(animation: AnimationFormat) -> None:
    with pytest.raises(InvalidInput, match="there is none: an animation needs at least one"):
        animation.encode(iter(()), 0.1, 0)


@pytest.mark.parametrize("step", [0.0, -0.1, np.inf, np.nan])
def test_no_time_between_pictures_is_refused(animation: AnimationFormat, step: float) -> None:
    with pytest.raises(InvalidInput, match="no time between two pictures"):
        animation.encode(iter([PICTURE]), step, 1)


def test_pictures_of_several_sizes_are_refused(animation: AnimationFormat) -> None:
    with pytest.raises(InvalidInput, match="80×64 and 80×60 pixels"):
        animation.encode(iter([PICTURE, PICTURE[:60]]), 0.1, 2)


@pytest.mark.parametrize(
    "error", [PaminsaError("the page has gone"), OSError("no room"), MemoryError()], ids=str
)
def test_what_stops_the_pictures_says_so_in_one_line(
    animation: AnimationFormat, error: Exception
) -> None:
    def pictures() -> Iterator[np.ndarray]:
        yield PICTURE
        raise error

    expected = type(error) if isinstance(error, MemoryError) else PaminsaError
    with pytest.raises(expected) as caught:
        animation.encode(pictures(), 0.1, 2)
    assert "\n" not in str(caught.value)
    assert str(error) in str(caught.value)


def test_an_encoder_that_fails_names_the_format() -> None:
    def fail(frames: Frames, step: float, count: int) -> bytes:
        raise OSError(f"no codec for {count} in {step} s")

    with pytest.raises(PaminsaError, match=r"^the GIF could not be made: no codec for 1 in 0.1 s"):
        AnimationFormat("GIF", fail).encode(iter([PICTURE]), 0.1, 1)


def test_one_picture_is_enough(animation: AnimationFormat) -> None:
    assert len(animation.encode(iter([PICTURE]), 0.1, 1)) > 60


def test_webp_compresses_each_picture_before_it_asks_for_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """If it kept them all to compress them at the end, nothing could stop it for that long."""
    images: list[weakref.ref[Image.Image]] = []
    kept: list[int] = []
    made = Image.fromarray

    def remembered(frame: np.ndarray) -> Image.Image:
        image = made(frame)
        images.append(weakref.ref(image))
        return image

    def pictures() -> Iterator[np.ndarray]:
        for index in range(9):
            kept.append(sum(image() is not None for image in images))
            yield np.full_like(PICTURE, 20 * index)

    monkeypatch.setattr(Image, "fromarray", remembered)
    content = ANIMATION_FORMATS["webp"].encode(pictures(), 0.1, 9)
    assert max(kept) <= 2  # the first, and the one before
    shown = ImageSequence.all_frames(Image.open(io.BytesIO(content)))
    means = [float(np.asarray(frame.convert("RGB")).mean()) for frame in shown]
    np.testing.assert_allclose(means, 20 * np.arange(9), atol=3)


@pytest.mark.parametrize("step", [1 / 15, 0.047, 0.1])
def test_gif_takes_its_true_time(step: float) -> None:
    """Its unit is 10 ms, which no picture of the recorder's rate is a multiple of."""
    pictures = (np.full_like(PICTURE, 5 * index) for index in range(45))
    image = Image.open(io.BytesIO(ANIMATION_FORMATS["gif"].encode(pictures, step, 45)))
    shown = [frame.info["duration"] for frame in ImageSequence.Iterator(image)]
    assert len(shown) == 45
    assert sum(shown) == pytest.approx(45e3 * step, abs=5)
    assert max(shown) - min(shown) <= 10


def test_a_video_has_the_colors_of_its_pictures_in_every_player() -> None:
    """It says that its luma and chroma are those of ITU-R BT.709, and they are."""
    av = pytest.importorskip("av")
    color = np.array([0, 158, 115])
    picture = np.broadcast_to(color.astype(np.uint8), (64, 80, 3))
    content = ANIMATION_FORMATS["mp4"].encode(iter([picture]), 0.1, 1)
    with av.open(io.BytesIO(content)) as container:
        context = container.streams.video[0].codec_context
        tags = context.colorspace, context.color_primaries, context.color_trc, context.color_range
        assert [int(tag) for tag in tags] == [1, 1, 1, 1]
        planes = next(container.decode(video=0)).planes
        found = [np.frombuffer(plane, np.uint8)[0] for plane in planes]
    luma = np.array([0.2126, 0.7152, 0.0722]) @ color / 255
    blue, red = (color[2] / 255 - luma) / 1.8556, (color[0] / 255 - luma) / 1.5748
    wanted = [16 + 219 * luma, 128 + 224 * blue, 128 + 224 * red]
    np.testing.assert_allclose(np.array(found, dtype=float), wanted, atol=1.5)
