"""What reaches a session's inputs, sent over a real socket."""

from __future__ import annotations

import math
from typing import Any

import pytest
import viser

from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.server.message_filter import MessageFilter, page_decoder
from tests.support.guarded import GuardedServer
from tests.support.raw_page import RawPage, eventually, pack, update

POINTER = {
    "type": "ScenePointerMessage", "event_type": "click", "ray_origin": [1.0, 2.0, 3.0],
    "ray_direction": [0.0, 0.0, 1.0], "screen_pos": [[0.5, 0.5]], "modifier": None,
}  # fmt: skip
"""A click into the scene."""


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
        pack(POINTER | {"ray_origin": None}),
        pack(POINTER | {"screen_pos": []}),
        pack(POINTER | {"event_type": "rect-select"}),
        pack({"type": "CommandTriggerMessage", "uuid": "u" * 300}),
        pack({"type": "CommandTriggerMessage", "uuid": "u", "more": 1}),
        pack({"type": "RemoveSceneNodeMessage", "name": "/gizmo"}),
    ],
)
def test_what_no_page_sends_is_dropped(guarded: GuardedServer, raw: bytes) -> None:
    assert MessageFilter(page_decoder(), Limits(), lambda _: None).passed(raw) is None
    page, inputs = guarded.page()
    page.send(raw)
    page.socket.send("text instead of bytes")
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("slider", math.nan),
        ("slider", -math.inf),
        ("slider", "nan"),
        ("slider", 1e300),
        ("slider", [0.5]),
        ("slider", None),
        ("slider", True),
        ("count", "9" * 4000),
        ("vector", [1.0, 2.0]),
        ("vector", [1.0, 2.0, math.nan]),
        ("vector", "abc"),
        ("choice", "c"),
        ("choice", 1),
        ("upload", "x"),
    ],
)
def test_a_value_of_the_wrong_kind_does_not_reach_an_input(
    guarded: GuardedServer, name: str, value: Any
) -> None:
    page, inputs = guarded.page()
    handle = getattr(inputs, name)
    before = handle.value
    page.send(update(handle._impl.uuid, value))
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]
    assert name == "slider" or handle.value == before


def test_values_of_the_right_kind_do_even_out_of_range(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    wanted = [(inputs.slider, 5), (inputs.count, 4), (inputs.choice, "b")]
    wanted.append((inputs.vector, (9.0, 8.0, 7.0)))
    for handle, value in wanted:
        page.send(update(handle._impl.uuid, value))
    eventually(lambda: len(inputs.received) == len(wanted))
    assert inputs.received == [value for _, value in wanted]
    assert [type(value) for value in inputs.received] == [float, int, str, tuple]


def test_an_update_may_set_the_value_and_nothing_else(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    uuid = inputs.slider._impl.uuid
    for name in ("update_cb", "removed", "gui_api", "sync_cb"):
        for updates in ({name: []}, {"value": 0.9, name: []}):
            page.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates})
    guarded.still_answers(page, inputs)
    assert inputs.received == [0.25]
    assert inputs.slider._impl.update_cb
    assert not inputs.slider._impl.removed


def test_a_key_given_twice_is_read_in_one_way_only(
    guarded: GuardedServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda self: asked.append(self))
    page, inputs = guarded.page()
    command = pack({"type": "CommandTriggerMessage", "uuid": "x"})
    page.send(b"\x83" + command[1:] + b"\xa4type\xafShareUrlRequest")
    page.send(b"\x82\xa4type\xb5CommandTriggerMessage\xa4type\xafShareUrlRequest")
    guarded.still_answers(page, inputs)
    assert not asked


def test_no_page_can_open_a_share_tunnel(
    monkeypatch: pytest.MonkeyPatch, guarded: GuardedServer
) -> None:
    asked: list[object] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda self: asked.append(self))
    page, inputs = guarded.page()
    page.send({"type": "ShareUrlRequest"})
    page.send({"type": "ShareUrlDisconnect"})
    guarded.still_answers(page, inputs)
    assert not asked
    (theme,) = (m for m in page.received() if m["type"] == "ThemeConfigurationMessage")
    assert theme["show_share_button"] is False

    plain = viser.ViserServer("127.0.0.1", 0, verbose=False)  # the same message does it there
    try:
        RawPage(plain).send({"type": "ShareUrlRequest"})
        assert eventually(lambda: asked) == [plain]
    finally:
        plain.stop()


def _send_file(page: RawPage, button: str, content: bytes, name: str = "t") -> None:
    parts = [content[i : i + 2**19] for i in range(0, len(content), 2**19)]
    start = {"filename": "d.toml", "mime_type": "", "size_bytes": len(content)}
    same = {"source_component_uuid": button, "transfer_uuid": name}
    page.send({"type": "FileTransferStartUpload", "part_count": len(parts), **start, **same})
    for i, part in enumerate(parts):
        page.send({"type": "FileTransferPart", "part_index": i, "content": part, **same})


def test_a_small_file_arrives_and_a_large_one_arrives_empty(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    sizes: list[int] = []

    @inputs.upload.on_upload
    async def note(event: Any) -> None:
        sizes.append(len(event.target.value.content))

    button = inputs.upload._impl.uuid
    _send_file(page, button, bytes(700_000), "small")
    eventually(lambda: sizes)
    _send_file(page, button, bytes(Limits().upload_bytes + 1), "large")
    _send_file(page, inputs.slider._impl.uuid, b"abc", "into a slider")
    guarded.still_answers(page, inputs)
    eventually(lambda: len(sizes) == 2)
    assert sizes == [700_000, 0]
    assert inputs.slider.value == 0.25
