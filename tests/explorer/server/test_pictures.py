"""Pictures by their headers."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.server.message_filter import MessageFilter, page_decoder, pixel_count
from tests.support.raw_page import pack


def _drawn(width: int, height: int, kind: str, **options: object) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (width, height), "red").save(file, kind, **options)
    return file.getvalue()


@given(st.binary(max_size=200), st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8"]))
def test_any_bytes_are_answered(data: bytes, start: bytes) -> None:
    assert pixel_count(start + data) is None or start


@given(st.integers(0, 120))
def test_a_picture_that_is_cut_off_is_none_or_has_its_size(length: int) -> None:
    whole = _drawn(30, 20, "PNG")
    assert pixel_count(whole[:length]) in (None, 600)


def test_an_animation_is_not_a_picture() -> None:
    frames = [Image.new("RGB", (8, 8), color) for color in ("red", "blue")]
    whole = _drawn(8, 8, "PNG", save_all=True, append_images=frames)
    assert b"acTL" in whole
    assert pixel_count(whole) is None
    assert pixel_count(_drawn(8, 8, "GIF")) is None


@pytest.mark.parametrize(
    ("payload", "goes_on"),
    [
        (b"", True),  # how a page says that it could not take the picture
        (_drawn(800, 600, "PNG"), True),
        (_drawn(800, 600, "JPEG"), True),
        (_drawn(8, 8, "PNG").replace(b"\0\0\0\x08\0\0\0\x08", b"\0\0\xff\xff\0\0\xff\xff"), False),
        (_drawn(8, 8, "GIF"), False),
        (b"not a picture", False),
    ],
)
def test_a_page_may_return_a_picture_of_reasonable_size(payload: bytes, goes_on: bool) -> None:
    messages = MessageFilter(page_decoder(), Limits(), report=lambda _: None)
    answer = {"type": "GetRenderResponseMessage", "payload": payload, "render_uuid": "r"}
    assert (messages.passed(pack(answer)) is not None) == goes_on
