"""Which messages reach a session, sent over a real socket."""

from __future__ import annotations

import dataclasses
import io
import math
from typing import Any

import msgspec
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from viser import _messages

from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.server.message_filter import (
    PAGE_MESSAGES,
    MessageFilter,
    page_decoder,
    pixel_count,
)
from tests.support.guarded import GuardedServer
from tests.support.raw_page import CAMERA, RawPage, eventually, pack, update, upload_messages

RAY = {"ray_origin": [1, 2, 3], "ray_direction": [0, 0, 1.5], "modifier": "cmd/ctrl"}
CLICK = {"event_type": "click", "screen_pos": [[0.5, 0.5]], **RAY}
POINTS = {"start_position": [1, 2, 3], "start_screen_pos": [0, 1], "end_screen_pos": [1, 0]}
START, PART = (
    {key: value for key, value in message.items() if key != "type"}
    for message in upload_messages("u", b"ab")
)
EXAMPLES: dict[str, dict[str, Any]] = {
    "ViewerCameraMessage": {key: value for key, value in CAMERA.items() if key != "type"},
    "GuiUpdateMessage": {"uuid": "u", "updates": {"value": 0.5}},
    "GuiButtonHoldMessage": {"uuid": "u", "frequency": 10},
    "CommandTriggerMessage": {"uuid": "u"},
    "ScenePointerMessage": CLICK,
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
    "FileTransferStartUpload": START,
    "FileTransferPart": PART,
    "GetRenderResponseMessage": {"payload": b"", "render_uuid": "r"},
    "LocalStorageGetItemResponseMessage": {"value": None, "error": None, "request_uuid": "r"},
}  # fmt: skip


def passed(message: bytes) -> Any:
    """Return what the filter makes of a message, None if it is dropped."""
    return MessageFilter(page_decoder(), Limits(), report=lambda _: None).passed(message)


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


@pytest.mark.parametrize("name", sorted({*PAGE_MESSAGES, *EXAMPLES}))
def test_viser_reads_what_the_page_sent(name: str) -> None:
    sent = pack({"type": name, **EXAMPLES[name]})
    read = _messages.Message.deserialize(msgspec.msgpack.encode(page_decoder()(sent)))
    assert type(read).__name__ == name
    assert dataclasses.is_dataclass(read)
    assert vars(read) == {key: _tuples(value) for key, value in EXAMPLES[name].items()}


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"\xc1",
        b"\xff" * 1000,
        b"\x81\xa4type",
        b"\x91" * 100_000,
        pack({"type": "NoSuchMessage"}),
        pack({"type": ["GuiUpdateMessage"]}),
        pack({"type": "GuiUpdateMessage"}),
        pack({"type": "GuiUpdateMessage", "uuid": 3, "updates": None}),
        pack({"type": "GuiUpdateMessage", "uuid": "nobody", "updates": {"value": 1}}),
        pack({"type": "ViewerCameraMessage", "wxyz": [math.nan] * 4}),
        pack({"type": "RunJavascriptMessage", "source": "alert(1)"}),
        pack({"type": "ScenePointerMessage", **CLICK, "ray_origin": None}),
        pack({"type": "ScenePointerMessage", **CLICK, "screen_pos": []}),
        pack({"type": "ScenePointerMessage", **CLICK, "event_type": "rect-select"}),
        pack({"type": "CommandTriggerMessage", "uuid": "u" * 300}),
        pack({"type": "CommandTriggerMessage", "uuid": "u", "more": 1}),
        pack({"type": "RemoveSceneNodeMessage", "name": "/gizmo"}),
    ],
    ids=lambda raw: repr(raw[:60]),
)
def test_message_that_no_page_sends_is_dropped(guarded: GuardedServer, raw: bytes) -> None:
    assert passed(raw) is None
    page, inputs = guarded.page()
    page.send(raw)
    page.socket.send("text instead of bytes")
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("slider", math.nan), ("slider", -math.inf), ("slider", "nan"), ("slider", 1e300),
        ("slider", [0.5]), ("slider", None), ("slider", True),
        ("count", "9" * 4000),
        ("vector", [1.0, 2.0]), ("vector", [1.0, 2.0, math.nan]), ("vector", "abc"),
        ("choice", "c"), ("choice", 1),
        ("upload", "x"),
    ],
    ids=lambda value: repr(value)[:20],
)  # fmt: skip
def test_value_of_the_wrong_kind_does_not_reach_an_input(
    guarded: GuardedServer, name: str, value: Any
) -> None:
    page, inputs = guarded.page()
    handle = getattr(inputs, name)
    before = handle.value
    page.send(update(handle._impl.uuid, value))
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]
    assert name == "slider" or handle.value == before


def test_value_of_the_right_kind_does_even_out_of_range(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    wanted = [
        (inputs.slider, 5), (inputs.count, 4), (inputs.choice, "b"),
        (inputs.vector, (9.0, 8.0, 7.0)),
    ]  # fmt: skip
    for handle, value in wanted:
        page.send(update(handle._impl.uuid, value))
    eventually(lambda: len(inputs.received) == len(wanted))
    assert inputs.received == [value for _, value in wanted]
    assert [type(value) for value in inputs.received] == [float, int, str, tuple]


def test_update_sets_the_value_and_nothing_else(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    uuid = inputs.slider._impl.uuid
    for name in ("update_cb", "removed", "gui_api", "sync_cb"):
        for updates in ({name: []}, {"value": 0.9, name: []}):
            page.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates})
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]
    assert inputs.slider._impl.update_cb
    assert not inputs.slider._impl.removed


@pytest.fixture
def shared(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """The servers that were asked for a share tunnel."""
    found: list[object] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda self: found.append(self))
    return found


def test_no_page_can_open_a_share_tunnel(guarded: GuardedServer, shared: list[object]) -> None:
    page, inputs = guarded.page()
    page.send({"type": "ShareUrlRequest"})
    page.send({"type": "ShareUrlDisconnect"})
    # A key given twice is read in one way only.
    command = pack({"type": "CommandTriggerMessage", "uuid": "x"})
    page.send(b"\x83" + command[1:] + b"\xa4type\xafShareUrlRequest")
    page.send(b"\x82\xa4type\xb5CommandTriggerMessage\xa4type\xafShareUrlRequest")
    guarded.still_answers(page, inputs)
    assert not shared
    (theme,) = (m for m in page.received() if m["type"] == "ThemeConfigurationMessage")
    assert theme["show_share_button"] is False


def test_an_unguarded_server_would_open_a_share_tunnel(shared: list[object]) -> None:
    plain = viser.ViserServer("127.0.0.1", 0, verbose=False)
    try:
        page = RawPage(plain)
        page.send({"type": "ShareUrlRequest"})
        assert eventually(lambda: shared) == [plain]
        page.socket.close()
    finally:
        plain.stop()


def test_small_file_arrives_and_a_large_one_is_dropped(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    sizes: list[int] = []

    @inputs.upload.on_upload
    async def note(event: Any) -> None:
        sizes.append(len(event.target.value.content))

    button = inputs.upload._impl.uuid
    for to, content, name in (
        (button, bytes(Limits().upload_bytes + 1), "large"),
        (inputs.slider._impl.uuid, b"abc", "into a slider"),
        (button, bytes(700_000), "small"),
    ):
        for message in upload_messages(to, content, transfer=name):
            page.send(message)
    guarded.still_answers(page, inputs)
    eventually(lambda: sizes)
    assert sizes == [700_000]
    assert inputs.slider.value == 0.25


def picture(width: int, height: int, kind: str, **options: object) -> bytes:
    """Return a picture in a format."""
    file = io.BytesIO()
    Image.new("RGB", (width, height), "red").save(file, kind, **options)
    return file.getvalue()


@given(st.binary(max_size=200), st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8"]))
def test_size_of_any_bytes_is_none(data: bytes, start: bytes) -> None:
    assert pixel_count(start + data) is None or start


@given(st.integers(0, 120))
def test_picture_that_is_cut_off_has_its_size_or_none(length: int) -> None:
    assert pixel_count(picture(30, 20, "PNG")[:length]) in (None, 600)


def test_animation_is_no_picture() -> None:
    frames = [Image.new("RGB", (8, 8), color) for color in ("red", "blue")]
    whole = picture(8, 8, "PNG", save_all=True, append_images=frames)
    assert b"acTL" in whole
    assert pixel_count(whole) is None


@pytest.mark.parametrize(
    ("payload", "accepted"),
    [
        (b"", True),  # how a page says that it could not take the picture
        (picture(800, 600, "PNG"), True),
        (picture(800, 600, "JPEG"), True),
        (picture(8, 8, "PNG").replace(b"\0\0\0\x08\0\0\0\x08", b"\0\0\xff\xff\0\0\xff\xff"), False),
        (picture(8, 8, "GIF"), False),
        (b"not a picture", False),
    ],
    ids=["none", "PNG", "JPEG", "huge", "GIF", "text"],
)
def test_page_may_return_a_picture_of_reasonable_size(payload: bytes, accepted: bool) -> None:
    answer = {"type": "GetRenderResponseMessage", "payload": payload, "render_uuid": "r"}
    assert (passed(pack(answer)) is not None) == accepted
