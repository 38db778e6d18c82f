"""Design names, design files and share codes on the page."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from typing import Any
from uuid import uuid4

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions, persistence, session
from paminsa_viz.explorer.features.files import tab
from paminsa_viz.explorer.features.files.tab import FILE, file_name, receive_example
from paminsa_viz.explorer.kit import bindings
from paminsa_viz.explorer.kit.entries import Button, Folder
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.tabs import files_of
from paminsa_viz.files.design_file import LARGEST_FILE, read_content, read_design, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput
from paminsa_viz.quantities.requirements import Requirement, Requirements
from tests.support.desk import Desk
from tests.support.raw_page import upload_messages

PANEL = FILE
CONDITION = Requirements((Requirement("condition", high=10.0),))
LIGHT = APPENDIX_4.vary({"links.b3": 0.25, "geometry.base_radius": 0.3})


def upload(desk: Desk, name: str, content: bytes) -> None:
    """Send a file as the page does."""
    button = desk.handle("file.upload")._impl.uuid
    for message in upload_messages(button, content, name, str(uuid4())):
        desk.page.send(message)


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


def test_tour_is_offered_above_the_examples_that_fill_the_panel() -> None:
    html = tab.gallery_html()
    assert 0 < html.index("Take the guided tour") < html.index(tab.EXAMPLE)


@pytest.mark.slow
@given(name=st.text(max_size=200))
def test_every_design_has_a_file_name_that_every_system_takes(name: str) -> None:
    found = file_name(Design(name=name))
    assert re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,59}\.toml", found)
    assert ".." not in found.split("/")


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("light arms, 2nd try", "light-arms-2nd-try.toml"),
        ("../../etc/passwd", "etc-passwd.toml"),
        ("<Ω>", "design.toml"),
    ],
)
def test_file_has_the_name_of_its_design(name: str, file: str) -> None:
    assert file_name(Design(name=name)) == file


def test_name_that_no_file_can_hold_is_refused(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    desk.set("file.name", "a\nb")
    desk.noticed("one line")
    desk.until(lambda: desk.handle("file.name").value == APPENDIX_4.name)


def test_downloaded_design_reads_back(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.rename(actions.load_design(s, LIGHT), "light arms"))
    desk.page.received()
    desk.set("file.download", True)
    files = desk.until(lambda: downloads(desk.page.received()))
    assert list(files) == ["light-arms.toml"]
    read = read_design(files["light-arms.toml"], "light-arms.toml")
    assert (read, read.name) == (LIGHT, "light arms")


def test_uploaded_design_that_is_refused_is_not_said_to_be_opened(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(state: State, content: object) -> State:
        raise InvalidInput("requirements", "they are not liked")

    monkeypatch.setattr(tab, "open_content", refuse)
    upload(desk, "light.toml", write_design(LIGHT).encode())
    desk.noticed("not liked")
    desk.dispatch(lambda state: state)
    assert not any("opened" in title for title, _ in desk.notices)


def test_uploaded_design_is_opened_and_undone(desk: Desk) -> None:
    upload(desk, "light.toml", write_design(LIGHT).encode())
    desk.until(lambda: desk.design == LIGHT)
    desk.noticed("Design opened")
    assert not any("requirements" in text for _, text in desk.notices)
    desk.session.undo()
    desk.until(lambda: desk.design == APPENDIX_4)
    desk.dispatch(lambda s: actions.load_design(s, LIGHT))
    receive_example(desk.session, "appendix-4")
    desk.until(lambda: desk.design == APPENDIX_4)
    assert desk.design.name == APPENDIX_4.name


def test_it_is_said_that_requirements_stay_where_a_file_has_none(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.change_document(s, requirements=CONDITION))
    upload(desk, "light.toml", write_design(LIGHT).encode())
    desk.noticed("the file has no requirements, those of before stay")
    assert desk.session.state.document.requirements == CONDITION
    desk.notices.clear()
    upload(desk, "heavy.toml", write_design(APPENDIX_4, requirements=CONDITION).encode())
    desk.noticed("Design opened")
    assert not any("requirements" in text for _, text in desk.notices)


def test_it_is_said_that_requirements_stay_where_an_example_has_none(desk: Desk) -> None:
    receive_example(desk.session, "masses")
    desk.noticed("Example opened")
    assert not any("before stay" in text for _, text in desk.notices)
    desk.dispatch(lambda s: actions.change_document(s, requirements=CONDITION))
    receive_example(desk.session, "appendix-4")
    desk.noticed("It has no requirements, those of before stay.")
    assert desk.session.state.document.requirements == CONDITION
    desk.notices.clear()
    receive_example(desk.session, "compact")  # which has its own
    desk.noticed("Compact robot")
    assert not any("before stay" in text for _, text in desk.notices)


def test_design_without_a_name_is_called_after_its_file(desk: Desk) -> None:
    upload(desk, "light arms.toml", b"schema_version = 1\n[links]\nb3_kg = 0.25\n")
    desk.until(lambda: desk.design.name == "light arms")
    assert desk.design.links.b3 == 0.25


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "lacks the line schema_version"),
        (b"hello", "not valid TOML"),
        (b"\xff\x00\x01", "not a text file"),
        (b"schema_version = 99", "newer paminsa_viz"),
        (b"schema_version = 1\n[links]\nb3_kg = -1", "line 3, [links] b3_kg = -1.0"),
        (b"schema_version = 1\n[links]\nb3_kg = nan", "line 3, [links] b3_kg"),
        (b"schema_version = 1\n[links]\nb3_kg = 1e300", "line 3, [links] b3_kg = 1e+300"),
        (b"schema_version = 1\n[geometry]\ncoupler_length_m = 0.01\nbase_radius_m = 9", "close"),
        (b"#" * (LARGEST_FILE + 1), "too large"),
        (b"a=" + b"[" * 100_000, ""),
    ],
    ids=[
        "empty", "no TOML", "no text", "newer", "negative", "nan", "huge", "impossible",
        "too large", "nested",
    ],
)  # fmt: skip
def test_broken_upload_is_notified_and_changes_nothing(
    desk: Desk, content: bytes, problem: str
) -> None:
    desk.dispatch(lambda s: actions.vary(actions.move(s, x=0.03), {"links.b4": 0.7}))
    before = desk.state.document
    upload(desk, "bad.toml", content)
    ((title, text),) = desk.until(lambda: desk.notices)
    assert title == "Not possible"
    assert problem in text
    assert len(text) < 400
    assert desk.state.document == before
    upload(desk, "good.toml", write_design(LIGHT).encode())  # and the next one is taken
    desk.until(lambda: desk.design == LIGHT)


@given(content=st.binary(max_size=300), name=st.text(max_size=60))
def test_any_upload_is_read_or_refused_in_printable_text(content: bytes, name: str) -> None:
    for whole in (content, b"schema_version = 1\n" + content):
        try:
            text = read_content(whole, name).design.name
        except DesignFileError as error:
            text = str(error)
        assert text.isprintable()


def test_share_code_follows_the_document_and_opens_it(desk: Desk) -> None:
    def code() -> str:
        return persistence.share_code(desk.state.document)

    desk.dispatch(lambda s: actions.move(actions.load_design(s, LIGHT), x=0.04))
    desk.until(lambda: desk.handle("file.code").value == code())
    named = replace(LIGHT, name="light")
    document = Document(named, pose=(0.01, 0.02, 0.3, -0.5), reference=APPENDIX_4)
    wanted = persistence.share_code(document)
    desk.set("file.code", f" {wanted[:30]} {wanted[30:]}\n")
    desk.until(lambda: desk.state.document == document)
    desk.until(lambda: desk.handle("file.code").value == wanted)
    desk.session.undo()
    desk.until(lambda: desk.state.document.pose[0] == 0.04)


def test_broken_share_codes_are_notified_and_change_nothing(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    monkeypatch.setattr(session, "IDLE_DELAY", 0.05)  # after which the box shows the code again
    before, shown = desk.state.document, desk.handle("file.code").value
    for code in ("", "rubbish", "PMZ1-", "PMZ1-AAAA", "<b>", "PMZ1-" + "A" * 50_000):
        desk.notices.clear()
        desk.set("file.code", code)
        desk.noticed("Share code")
        desk.until(lambda: desk.handle("file.code").value == shown)
        assert desk.state.document == before, code[:20]


def test_note_on_the_share_code_names_all_that_a_document_has(desk: Desk) -> None:
    said = desk.handle("file.about_code").content.lower()
    assert [one.name for one in fields(Document) if one.name not in said] == []


def test_commands_of_files_leave_their_keys_to_the_palette() -> None:
    """viser writes them behind the words, on a Mac as ⌘: in both they would stand twice."""
    found = {command.key: command for command in files_of(FILE)}
    assert found["file.download"].words == "A readable text file, in SI units"
    assert found["file.download"].modifier == "cmd/ctrl"
    assert not [key for key, command in found.items() if "Ctrl" in command.words]
    buttons = [one for folder in FILE if isinstance(folder, Folder) for one in folder.entries]
    tooltips = {one.key: str(one.tooltip) for one in buttons if isinstance(one, Button)}
    assert tooltips["file.download"] == "A readable text file, in SI units (Ctrl+S)"
    assert tooltips["file.link"].endswith("the address follows your work (Ctrl+Shift+L)")
    assert "(" not in tooltips["file.page"]
