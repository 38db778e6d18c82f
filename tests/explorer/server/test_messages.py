"""Our message types against viser's own."""

from __future__ import annotations

import dataclasses
from typing import Any

import msgspec
import pytest
from viser import _messages

from paminsa_viz.explorer.server.message_filter import PAGE_MESSAGES, page_decoder
from tests.support.raw_page import CAMERA, pack

RAY = {"ray_origin": [1, 2, 3], "ray_direction": [0, 0, 1.5], "modifier": "cmd/ctrl"}
POINTS = {"start_position": [1, 2, 3], "start_screen_pos": [0, 1], "end_screen_pos": [1, 0]}
EXAMPLES: dict[str, dict[str, Any]] = {
    "ViewerCameraMessage": {key: value for key, value in CAMERA.items() if key != "type"},
    "GuiUpdateMessage": {"uuid": "u", "updates": {"value": 0.5}},
    "GuiButtonHoldMessage": {"uuid": "u", "frequency": 10},
    "CommandTriggerMessage": {"uuid": "u"},
    "ScenePointerMessage": {"event_type": "click", "screen_pos": [[0.5, 0.5]], **RAY},
    "SceneNodeClickMessage": {
        "name": "/n", "instance_index": 3, "screen_pos": [0.5, 0.5], "owner": "1", **RAY
    },
    "SceneNodeDragMessage": {
        "phase": "start", "name": "/n", "instance_index": None, "end_position": [0, 0, 0],
        "button": "left", "modifier": None, "owner": "1", **POINTS,
    },
    "TransformControlsUpdateMessage": {
        "name": "/n", "wxyz": [1, 0, 0, 0], "position": [0, 1, 2], "owner": "1"
    },
    "TransformControlsDragStartMessage": {"name": "/n", "owner": "1"},
    "TransformControlsDragEndMessage": {"name": "/n", "owner": "1"},
    "FileTransferStartUpload": {
        "source_component_uuid": "u", "transfer_uuid": "t", "filename": "f", "mime_type": "",
        "part_count": 1, "size_bytes": 2,
    },
    "FileTransferPart": {
        "source_component_uuid": "u", "transfer_uuid": "t", "part_index": 0, "content": b"ab"
    },
    "GetRenderResponseMessage": {"payload": b"", "render_uuid": "r"},
    "LocalStorageGetItemResponseMessage": {"value": None, "error": None, "request_uuid": "r"},
}  # fmt: skip


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def test_there_is_an_example_of_each() -> None:
    assert set(EXAMPLES) == set(PAGE_MESSAGES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_viser_reads_from_ours_what_the_page_sent(name: str) -> None:
    sent = pack({"type": name, **EXAMPLES[name]})
    read = _messages.Message.deserialize(msgspec.msgpack.encode(page_decoder()(sent)))
    assert type(read).__name__ == name
    assert dataclasses.is_dataclass(read)
    assert vars(read) == {key: _tuples(value) for key, value in EXAMPLES[name].items()}
