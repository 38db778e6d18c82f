"""The panel of names, design files and share codes."""

from __future__ import annotations

import re
from typing import Any
from uuid import uuid4

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions, bindings, persistence
from paminsa_viz.explorer.panels.file_panel import FILE, file_name, uploaded_design
from paminsa_viz.explorer.state import Document
from paminsa_viz.files.design_file import LARGEST_FILE, read_design, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import APPENDIX_4, Design
from tests.support.desk import Desk

LIGHT = APPENDIX_4.vary({"links.b3": 0.25, "geometry.base_radius": 0.3})


PANEL = FILE


def upload(desk: Desk, name: str, content: bytes, size: int | None = None) -> None:
    """Send a file as the page does."""
    source, transfer = desk.handle("file.upload")._impl.uuid, str(uuid4())
    step = 512 * 1024
    parts = [content[i : i + step] for i in range(0, len(content), step)]
    desk.page.send(
        {
            "type": "FileTransferStartUpload",
            "source_component_uuid": source,
            "transfer_uuid": transfer,
            "filename": name,
            "mime_type": "",
            "part_count": len(parts),
            "size_bytes": len(content) if size is None else size,
        }
    )
    for index, part in enumerate(parts):
        desk.page.send(
            {
                "type": "FileTransferPart",
                "source_component_uuid": source,
                "transfer_uuid": transfer,
                "part_index": index,
                "content": part,
            }
        )


def downloads(messages: list[dict[str, Any]]) -> dict[str, bytes]:
    """Return the files among what the page was sent."""
    files: dict[str, bytes] = {}
    names: dict[str, str] = {}
    for message in messages:
        if message["type"] == "FileTransferStartDownload":
            assert message["save_immediately"]
            names[message["transfer_uuid"]] = message["filename"]
            files[message["filename"]] = b""
        elif message["type"] == "FileTransferPart":
            files[names[message["transfer_uuid"]]] += message["content"]
    return files


# Names


@given(name=st.text(max_size=200))
def test_every_design_has_a_file_name_that_every_system_takes(name: str) -> None:
    found = file_name(Design(name=name))
    assert re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,59}\.toml", found)
    assert ".." not in found.split("/")


def test_a_file_is_called_after_its_design() -> None:
    assert file_name(Design(name="light arms, 2nd try")) == "light-arms-2nd-try.toml"
    assert file_name(Design(name="../../etc/passwd")) == "etc-passwd.toml"
    assert file_name(Design(name="<Ω>")) == "design.toml"


def test_the_design_gets_another_name(desk: Desk) -> None:
    desk.set(desk.handle("file.name"), "light arms")
    desk.until(lambda: desk.design.name == "light arms")
    desk.session.undo()
    desk.until(lambda: desk.handle("file.name").value == APPENDIX_4.name)


def test_a_name_that_no_file_can_hold_is_told_and_set_back(desk: Desk) -> None:
    desk.set(desk.handle("file.name"), "a\nb")
    desk.until(lambda: desk.told)
    assert "one line" in desk.told[0][1]
    desk.until(lambda: desk.handle("file.name").value == APPENDIX_4.name)


# Files


def test_a_downloaded_design_reads_back_as_it_was(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.rename(actions.load_design(s, LIGHT), "light arms"))
    desk.page.received()
    desk.set(desk.handle("file.download"), True)
    files = desk.until(lambda: downloads(desk.page.received()))
    assert list(files) == ["light-arms.toml"]
    read = read_design(files["light-arms.toml"], "light-arms.toml")
    assert read == LIGHT
    assert read.name == "light arms"


def test_an_uploaded_design_is_opened_and_can_be_undone(desk: Desk) -> None:
    upload(desk, "light.toml", write_design(LIGHT).encode())
    desk.until(lambda: desk.design == LIGHT)
    assert desk.told[0][0] == "Design opened"
    desk.session.undo()
    desk.until(lambda: desk.design == APPENDIX_4)


def test_a_design_without_a_name_is_called_after_its_file(desk: Desk) -> None:
    upload(desk, "light arms.toml", b"schema_version = 1\n[links]\nb3_kg = 0.25\n")
    desk.until(lambda: desk.design.name == "light arms")
    assert desk.design.links.b3 == 0.25


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is empty, or larger than"),
        (b"hello", "not valid TOML"),
        (b"\xff\x00\x01", "not a text file"),
        (b"schema_version = 99", "newer paminsa_viz"),
        (b"schema_version = 1\n[links]\nb3_kg = -1", "line 3, [links] b3_kg = -1.0"),
        (b"schema_version = 1\n[links]\nb3_kg = nan", "line 3, [links] b3_kg"),
        (b"schema_version = 1\n[links]\nb3_kg = 1e300", "line 3, [links] b3_kg = 1e+300"),
        (b"schema_version = 1\n[geometry]\ncoupler_length_m = 0.01\nbase_radius_m = 9", "close"),
        (b"#" * (LARGEST_FILE + 1), "too large"),
        (b"#" * 11_000_000, "is empty, or larger than"),
        (b"a=" + b"[" * 100_000, ""),
    ],
)
def test_a_broken_upload_is_told_and_changes_nothing(desk: Desk, content: bytes, said: str) -> None:
    desk.dispatch(lambda s: actions.vary(actions.move(s, x=0.03), {"links.b4": 0.7}))
    before = desk.state.document
    upload(desk, "bad.toml", content)
    desk.until(lambda: any(title == "Not possible" for title, _ in desk.told))
    text = next(body for title, body in desk.told if title == "Not possible")
    assert said in text
    assert len(text) < 400
    assert desk.state.document == before
    assert all(title == "Not possible" for title, _ in desk.told)
    upload(desk, "good.toml", write_design(LIGHT).encode())  # and the next one is taken
    desk.until(lambda: desk.design == LIGHT)


def test_a_hostile_file_name_is_shown_as_text() -> None:
    with pytest.raises(DesignFileError) as error:
        uploaded_design("a\nb\x1b[31m" + "x" * 50, b"hello")
    assert str(error.value).isprintable()


@given(content=st.binary(max_size=300))
def test_any_upload_is_read_or_refused(content: bytes) -> None:
    for whole in (content, b"schema_version = 1\n" + content):
        try:
            assert isinstance(uploaded_design("any.toml", whole), Design)
        except DesignFileError:
            continue


def test_appendix_4_is_one_button_away(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.load_design(s, LIGHT))
    desk.set(desk.handle("file.open"), True)
    desk.until(lambda: desk.design == APPENDIX_4)
    assert desk.design.name == APPENDIX_4.name


# Share codes


def test_the_code_follows_the_document(desk: Desk) -> None:
    desk.until(
        lambda: desk.handle("file.code").value == persistence.share_code(desk.state.document)
    )
    desk.dispatch(lambda s: actions.move(actions.load_design(s, LIGHT), x=0.04))
    desk.until(
        lambda: desk.handle("file.code").value == persistence.share_code(desk.state.document)
    )
    assert persistence.open_share_code(desk.handle("file.code").value) == desk.state.document


def test_a_pasted_code_is_opened(desk: Desk) -> None:
    document = Document(LIGHT, pose=(0.01, 0.02, 0.3, -0.5), reference=APPENDIX_4)
    code = persistence.share_code(document)
    desk.set(desk.handle("file.code"), f" {code[:30]} {code[30:]}\n")
    desk.until(lambda: desk.state.document == document)
    desk.until(lambda: desk.handle("file.code").value == code)
    desk.session.undo()
    desk.until(lambda: desk.design == APPENDIX_4)


@pytest.mark.parametrize(
    "code", ["", "rubbish", "PMZ1-", "PMZ1-AAAA", "<b>", "PMZ1-" + "A" * 50_000]
)
def test_a_broken_code_changes_nothing_and_is_told_in_time(
    desk: Desk, code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    before, shown = desk.state.document, desk.handle("file.code").value
    desk.set(desk.handle("file.code"), code)
    desk.until(lambda: desk.told)
    assert "share code" in desk.told[0][1]
    desk.until(lambda: desk.handle("file.code").value == shown)
    assert desk.state.document == before
