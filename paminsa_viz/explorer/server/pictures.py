"""A look at the header of a picture that a page sends, before anything decodes it.

A few kilobytes can claim to be a picture of gigabytes. viser decodes what a page returns for
``get_render`` with Pillow on the caller's thread, so its size is read from the first bytes here.
"""

from __future__ import annotations

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8"
_SEGMENTS = 64  # chunks or segments looked at; a browser writes about ten
_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def pixel_count(data: bytes) -> int | None:
    """Return how many pixels a still PNG or JPEG has, or None if it is not clearly one."""
    try:
        if data.startswith(_PNG):
            return _png_pixels(data)
        if data.startswith(_JPEG):
            return _jpeg_pixels(data)
    except IndexError:  # cut off
        pass
    return None


def _number(data: bytes, start: int, length: int) -> int:
    if start + length > len(data):
        raise IndexError(start)
    return int.from_bytes(data[start : start + length], "big")


def _png_pixels(data: bytes) -> int | None:
    pixels = None
    position = len(_PNG)
    for _ in range(_SEGMENTS):
        kind = data[position + 4 : position + 8]
        if kind == b"IHDR" and pixels is None:
            pixels = _number(data, position + 8, 4) * _number(data, position + 12, 4)
        elif kind == b"IDAT":
            return pixels
        elif kind == b"acTL":  # an animation: as many pictures as it likes
            return None
        position += 12 + _number(data, position, 4)
    return None


def _jpeg_pixels(data: bytes) -> int | None:
    position = len(_JPEG)
    for _ in range(_SEGMENTS):
        if data[position] != 0xFF:
            return None
        if data[position + 1] in _START_OF_FRAME:
            return _number(data, position + 5, 2) * _number(data, position + 7, 2)
        position += 2 + _number(data, position + 2, 2)
    return None
