"""The messages that a page may send, as types: whatever does not fit them never reaches viser.

viser decodes any of its own message types from any socket, fills fields without looking at them
and sets whatever attribute a GUI update names. The types below are the few that the explorer's page
sends, with every field bounded: numbers are finite, texts and lists are short, and no field may be
added. Their names and fields are viser's own; ``viser_patch`` compares the two at the start.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from msgspec import Meta, Struct
from msgspec.msgpack import Decoder, Encoder

Real: TypeAlias = Annotated[float, Meta(ge=-1e12, le=1e12)]  # also shuts out NaN and infinity
Index: TypeAlias = Annotated[int, Meta(ge=0, le=2**40)]
Uuid: TypeAlias = Annotated[str, Meta(max_length=64)]
Name: TypeAlias = Annotated[str, Meta(max_length=256)]
Text: TypeAlias = Annotated[str, Meta(max_length=100_000)]
Pair: TypeAlias = tuple[Real, Real]
Triple: TypeAlias = tuple[Real, Real, Real]
Quaternion: TypeAlias = tuple[Real, Real, Real, Real]
InputValue: TypeAlias = bool | Real | Text | Annotated[list[Real], Meta(max_length=16)]
Modifier: TypeAlias = Annotated[str, Meta(max_length=32)] | None

PART_BYTES = 512 * 1024
"""Size of the parts in which viser's page sends a file [bytes]."""


class PageMessage(Struct, tag_field="type", tag=True, forbid_unknown_fields=True):
    """Root of what a page may send; the tag is the class's name, as in viser."""


class ViewerCameraMessage(PageMessage, tag=True):
    """Where the page's camera is; the first one starts the session."""

    wxyz: Quaternion
    position: Triple
    fov: Real
    near: Real
    far: Real
    image_height: Index
    image_width: Index
    look_at: Triple
    up_direction: Triple


class InputUpdate(Struct, forbid_unknown_fields=True):
    """The one attribute of an input that a page may set; viser would set any, even callbacks."""

    value: InputValue


class GuiUpdateMessage(PageMessage, tag=True):
    """A new value of an input, or a press of a button."""

    uuid: Uuid
    updates: InputUpdate


class GuiButtonHoldMessage(PageMessage, tag=True):
    """A button held down."""

    uuid: Uuid
    frequency: Real


class CommandTriggerMessage(PageMessage, tag=True):
    """A command chosen in the palette or by its hotkey."""

    uuid: Uuid


class ScenePointerMessage(PageMessage, tag=True):
    """A click into the scene, as a ray, or a rectangle drawn over it."""

    event_type: Literal["click", "rect-select"]
    ray_origin: Triple | None
    ray_direction: Triple | None
    screen_pos: Annotated[list[Pair], Meta(min_length=1, max_length=2)]
    modifier: Modifier

    def __post_init__(self) -> None:
        """Refuse a click without its ray and a rectangle without its two corners.

        Raises:
            ValueError: viser would fail on it.
        """
        ray = self.ray_origin is not None and self.ray_direction is not None
        if not (ray if self.event_type == "click" else len(self.screen_pos) == 2):
            raise ValueError("incomplete pointer event")


class SceneNodeClickMessage(PageMessage, tag=True):
    """A click on a clickable part."""

    name: Name
    instance_index: Index | None
    ray_origin: Triple
    ray_direction: Triple
    screen_pos: Pair
    modifier: Modifier
    owner: Uuid = ""


class SceneNodeDragMessage(PageMessage, tag=True):
    """A drag of a draggable part."""

    phase: Literal["start", "update", "end"]
    name: Name
    instance_index: Index | None
    start_position: Triple
    start_screen_pos: Pair
    end_position: Triple
    end_screen_pos: Pair
    button: Literal["left", "middle", "right"]
    modifier: Modifier
    owner: Uuid = ""


class TransformControlsUpdateMessage(PageMessage, tag=True):
    """A new pose of a gizmo."""

    name: Name
    wxyz: Quaternion
    position: Triple
    owner: Uuid = ""


class TransformControlsDragStartMessage(PageMessage, tag=True):
    """A gizmo taken in hand."""

    name: Name
    owner: Uuid = ""


class TransformControlsDragEndMessage(PageMessage, tag=True):
    """A gizmo let go."""

    name: Name
    owner: Uuid = ""


class FileTransferStartUpload(PageMessage, tag=True):
    """An upload begins."""

    source_component_uuid: Uuid
    transfer_uuid: Uuid
    filename: Name
    mime_type: Name
    part_count: Index
    size_bytes: Index


class FileTransferPart(PageMessage, tag=True):
    """One part of an upload."""

    source_component_uuid: Uuid | None
    transfer_uuid: Uuid
    part_index: Index
    content: Annotated[bytes, Meta(max_length=PART_BYTES)]


class GetRenderResponseMessage(PageMessage, tag=True):
    """The picture that ``client.get_render`` asked for; empty if the page could not take it."""

    payload: bytes
    render_uuid: Uuid


class LocalStorageGetItemResponseMessage(PageMessage, tag=True):
    """What the browser had stored, as asked for by ``client.local_storage.get_item``."""

    value: Text | None
    error: Text | None
    request_uuid: Uuid


PAGE_MESSAGES: tuple[type[PageMessage], ...] = tuple(PageMessage.__subclasses__())
"""All of the above. Left out on purpose: share tunnels, forms, and everything a server sends."""

AnyPageMessage: TypeAlias = (
    ViewerCameraMessage
    | GuiUpdateMessage
    | GuiButtonHoldMessage
    | CommandTriggerMessage
    | ScenePointerMessage
    | SceneNodeClickMessage
    | SceneNodeDragMessage
    | TransformControlsUpdateMessage
    | TransformControlsDragStartMessage
    | TransformControlsDragEndMessage
    | FileTransferStartUpload
    | FileTransferPart
    | GetRenderResponseMessage
    | LocalStorageGetItemResponseMessage
)

decode = Decoder(AnyPageMessage).decode
"""Read one message; raises on anything else."""

encode = Encoder().encode
"""Write it again. Only this form goes on: of a key given twice, viser would take the other one."""
