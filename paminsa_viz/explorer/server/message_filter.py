"""What of one session's messages goes on to viser: strict types first, then what they mean.

viser decodes any of its own message types from any socket, fills fields without looking at them
and sets whatever attribute a GUI update names. The types here are made from viser's dataclasses,
but only for the few messages that the explorer's page sends, and with every field bounded: numbers
are finite, texts and lists are short, and no field may be added.
"""

from __future__ import annotations

import dataclasses
import io
import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, TypeAlias

import msgspec
from msgspec import Meta, Struct
from PIL import Image
from viser import GuiUploadButtonHandle, _messages

from .limits import Limits

Real: TypeAlias = Annotated[float, Meta(ge=-1e12, le=1e12)]  # also shuts out NaN and infinity
Index: TypeAlias = Annotated[int, Meta(ge=0, le=2**40)]
Name: TypeAlias = Annotated[str, Meta(max_length=256)]
Text: TypeAlias = Annotated[str, Meta(max_length=100_000)]

PART_BYTES = 512 * 1024
"""Size of the parts in which viser's page sends a file [bytes]."""


class InputUpdate(Struct, forbid_unknown_fields=True):
    """The one attribute of an input that a page may set; viser would set any, even callbacks."""

    value: bool | Real | Text | Annotated[list[Real], Meta(max_length=16)]


_OPTIONAL_TEXT = typing.Optional[Text]  # noqa: UP045

PAGE_MESSAGES: dict[str, dict[str, Any]] = {
    "ViewerCameraMessage": {},
    "GuiUpdateMessage": {"uuid": Name, "updates": InputUpdate},
    "GuiButtonHoldMessage": {},
    "CommandTriggerMessage": {},
    "ScenePointerMessage": {},
    "SceneNodeClickMessage": {},
    "SceneNodeDragMessage": {},
    "TransformControlsUpdateMessage": {},
    "TransformControlsDragStartMessage": {},
    "TransformControlsDragEndMessage": {},
    "FileTransferStartUpload": {
        "source_component_uuid": Name, "transfer_uuid": Name, "part_count": Index,
        "size_bytes": Index,
    },
    "FileTransferPart": {
        "transfer_uuid": Name, "part_index": Index,
        "content": Annotated[bytes, Meta(max_length=PART_BYTES)],
    },
    "GetRenderResponseMessage": {"payload": bytes},
    "LocalStorageGetItemResponseMessage": dict.fromkeys(("value", "error"), _OPTIONAL_TEXT),
}  # fmt: skip
"""What passes, with the fields that are given a type here and not by viser: those that the filter
reads, and those that hold more than a name. Left out on purpose: share tunnels, forms, and
everything that a server sends."""

Decode: TypeAlias = Callable[[bytes], Any]


class UnknownMessage(Exception):
    """viser has no such message, or one with other fields."""


def page_decoder() -> Decode:
    """Return what reads one message of a page, and raises on anything else.

    Raises:
        UnknownMessage: If viser's messages are not those that the filter was written for.
    """
    structs = tuple(_struct(name, fields) for name, fields in PAGE_MESSAGES.items())
    return msgspec.msgpack.Decoder(typing.Union[structs]).decode  # noqa: UP007


def _struct(name: str, given: dict[str, Any]) -> type[Struct]:
    theirs = getattr(_messages, name, None)
    if getattr(theirs, "__name__", None) != name or not dataclasses.is_dataclass(theirs):
        raise UnknownMessage(f"its {name} is missing")
    hints = typing.get_type_hints(theirs)
    known = dataclasses.fields(theirs)
    missing = given.keys() - {each.name for each in known}
    if missing:
        raise UnknownMessage(f"its {name} has no {min(missing)}")
    fields: list[tuple[str, Any] | tuple[str, Any, Any]] = []
    for each in known:
        kind = given.get(each.name) or _bounded(hints[each.name], f"{name}.{each.name}")
        default = () if each.default is dataclasses.MISSING else (each.default,)
        fields.append((each.name, kind, *default))
    return msgspec.defstruct(
        name, fields, tag_field="type", tag=name, forbid_unknown_fields=True, kw_only=True
    )


def _bounded(hint: Any, place: str) -> Any:
    """Return a type of viser's with limits to every number, text and list in it."""
    plain = {float: Real, int: Index, str: Name, type(None): None}
    if hint in plain:
        return plain[hint]
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is Literal:
        return hint
    if origin is tuple and inner[-1] is Ellipsis:
        return Annotated[list[_bounded(inner[0], place)], Meta(max_length=16)]
    if origin is tuple:
        return tuple[tuple(_bounded(part, place) for part in inner)]
    if origin in (typing.Union, types.UnionType):
        return typing.Union[tuple(_bounded(part, place) for part in inner)]  # noqa: UP007
    raise UnknownMessage(f"its {place} is of another kind: {hint}")


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
        decode: Reads one message, see `page_decoder`.
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
            return None
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
