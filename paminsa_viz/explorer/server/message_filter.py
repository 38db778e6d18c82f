"""What of one session's messages goes on to viser."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import msgspec
from PIL import Image
from viser import GuiUploadButtonHandle

from .limits import Limits
from .messages import Decode

_MANY_PARTS = 1024  # of one upload; viser's page sends one for each half megabyte
_MANY_UPLOADS = 4  # of one page at a time


def matches_input(handle: Any, value: object) -> bool:
    """Return whether ``value`` is of the kind that an input holds.

    Kind only: a finite number for a number, as many numbers as before for a vector, one of the
    options for a choice. The range is left to whoever reads the value, because what a person typed
    must be answered, not swallowed. viser itself would turn the text ``"nan"`` into a number.

    Args:
        handle: The input's handle in viser.
        value: Value from the wire, already finite and bounded.
    """
    held = handle.value
    if isinstance(held, bool):
        return isinstance(value, bool)
    if isinstance(held, int | float):
        return isinstance(value, int | float) and not isinstance(value, bool)
    if isinstance(held, str):
        options = getattr(handle, "options", None)
        return isinstance(value, str) and (options is None or value in options)
    return isinstance(held, tuple) and isinstance(value, list) and len(value) == len(held)


def pixel_count(data: bytes) -> int | None:
    """Return how many pixels a still PNG or JPEG has, or None if it is not one.

    Only the header is read: a few kilobytes can claim to be a picture of gigabytes, and viser
    decodes what a page returns for ``get_render``.
    """
    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as image:
            still = not getattr(image, "is_animated", False)
            return image.width * image.height if still else None
    except Exception:  # whatever a broken file makes Pillow raise, a claim of gigabytes included
        return None


@dataclass
class _Upload:
    part_count: int
    bytes_left: int
    parts: set[int] = field(default_factory=set)


class MessageFilter:
    """Lets through what a page of ours would send, in a form that can be read in one way only.

    Args:
        decode: Reads one message, see `messages.page_decoder`.
        limits: How much is let through.
        report: Called once if something is not.

    Attributes:
        inputs: The session's own inputs by uuid, as viser keeps them; empty until it has started.
    """

    def __init__(self, decode: Decode, limits: Limits, report: Callable[[str], None]) -> None:
        self.inputs: Mapping[str, Any] = {}
        self._decode, self._limits, self._report = decode, limits, report
        self._uploads: dict[str, _Upload] = {}
        self._reported = False

    def passed(self, raw: str | bytes) -> bytes | None:
        """Return the message to hand to viser, or None if it is to be dropped.

        Args:
            raw: One WebSocket message as it came.
        """
        try:
            message = self._checked(self._decode(raw)) if isinstance(raw, bytes) else None
        except (msgspec.MsgspecError, ValueError, RecursionError):
            message = None
        if message is not None:
            # Written again: of a key given twice, viser would take the other one.
            return msgspec.msgpack.encode(message)
        if not self._reported:
            self._reported = True
            self._report("a connection sends messages that the page does not; they are dropped")
        return None

    def _checked(self, message: Any) -> Any:
        match type(message).__name__:
            case "GuiUpdateMessage":
                handle = self.inputs.get(message.uuid)
                passes = handle is not None and matches_input(handle, message.updates.value)
            case "ScenePointerMessage":  # viser would fail on one without its ray or its corners
                ray = message.ray_origin is not None and message.ray_direction is not None
                click = message.event_type == "click"
                passes = len(message.screen_pos) == (1 if click else 2) and (ray or not click)
            case "FileTransferStartUpload":
                return self._started(message)
            case "FileTransferPart":
                passes = self._expected(message)
            case "GetRenderResponseMessage" if message.payload:
                pixels = pixel_count(message.payload)
                passes = pixels is not None and pixels <= self._limits.render_pixels
            case _:
                passes = True
        return message if passes else None

    def _started(self, upload: Any) -> Any:
        # Only upload buttons: viser would put a file into a slider.
        if not isinstance(self.inputs.get(upload.source_component_uuid), GuiUploadButtonHandle):
            return None
        if upload.transfer_uuid in self._uploads or len(self._uploads) >= _MANY_UPLOADS:
            return None
        if upload.size_bytes > self._limits.upload_bytes or upload.part_count > _MANY_PARTS:
            # Arrives as an empty file, so that the page's callback runs and can say so.
            return msgspec.structs.replace(upload, part_count=0, size_bytes=0)
        if upload.part_count:
            self._uploads[upload.transfer_uuid] = _Upload(upload.part_count, upload.size_bytes)
        return upload

    def _expected(self, part: Any) -> bool:
        upload = self._uploads.get(part.transfer_uuid)
        if upload is None or part.part_index in upload.parts:
            return False
        if part.part_index >= upload.part_count or len(part.content) > upload.bytes_left:
            return False
        upload.parts.add(part.part_index)
        upload.bytes_left -= len(part.content)
        if len(upload.parts) == upload.part_count:
            del self._uploads[part.transfer_uuid]
        return True
