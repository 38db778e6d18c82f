"""The messages that a page may send, as strict types: whatever does not fit never reaches viser.

viser decodes any of its own message types from any socket, fills fields without looking at them
and sets whatever attribute a GUI update names. The types here are made from viser's dataclasses,
but only for the few messages that the explorer's page sends, and with every field bounded: numbers
are finite, texts and lists are short, and no field may be added.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeAlias

import msgspec
from msgspec import Meta, Struct
from viser import _messages

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
    missing = given.keys() - {field.name for field in known}
    if missing:
        raise UnknownMessage(f"its {name} has no {min(missing)}")
    fields: list[tuple[str, Any] | tuple[str, Any, Any]] = []
    for field in known:
        kind = given.get(field.name) or _bounded(hints[field.name], f"{name}.{field.name}")
        default = () if field.default is dataclasses.MISSING else (field.default,)
        fields.append((field.name, kind, *default))
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
