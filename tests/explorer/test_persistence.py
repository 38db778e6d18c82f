"""Saved text and share codes: read to the last digit, or refused with a reason."""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import persistence
from paminsa_viz.explorer.state import Document
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput, KneeBranch, PaminsaError
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import MOST_COUNTERWEIGHTS, Counterweight
from tests.support.documents import DOCUMENTS, assert_same, designs
from tests.support.samples import random_design


@given(document=DOCUMENTS)
def test_a_document_survives_text_and_share_code_to_the_last_digit(document: Document) -> None:
    assert_same(persistence.load(persistence.dump(document)), document)
    assert_same(persistence.open_share_code(persistence.share_code(document)), document)


@given(design=designs())
def test_a_shared_design_can_be_written_to_a_file(design: Design) -> None:
    shared = persistence.open_share_code(persistence.share_code(Document(design))).design
    assert read_design(write_design(shared), "shared") == design


@given(document=DOCUMENTS, width=st.integers(5, 80))
def test_a_mail_may_break_a_share_code_into_lines(document: Document, width: int) -> None:
    code = persistence.share_code(document)
    lines = [code[i : i + width] for i in range(0, len(code), width)]
    assert_same(persistence.open_share_code("  " + " \r\n".join(lines) + "\n"), document)


def test_share_codes_are_short() -> None:
    assert len(persistence.share_code(Document())) < 200
    rng = np.random.default_rng(0)

    def heavy() -> Design:
        weights = [
            Counterweight("b8", 8, *(float(v) for v in rng.random(2)))
            for _ in range(MOST_COUNTERWEIGHTS)
        ]
        return replace(random_design(rng), counterweights=tuple(weights))

    full = Document(heavy(), reference=heavy())
    assert len(persistence.share_code(full)) < persistence.LONGEST_CODE / 2
    assert len(persistence.dump(full)) < persistence.LONGEST_TEXT / 2


def test_drives_survive_a_share_code() -> None:
    drives = (Drive("motor", 1e-6, envelope=((0.0, 1.0), (9.0, 0.5))), None, None, None)
    document = Document(design=replace(APPENDIX_4, drives=drives))
    assert "drives" not in json.loads(persistence.dump(Document(design=APPENDIX_4)))
    opened = persistence.open_share_code(persistence.share_code(document))
    assert opened.design == document.design
    assert opened.design.drives[0].name == "motor"


def test_a_load_survives_a_share_code() -> None:
    load = LoadCase(-12.5, moment_z=3.0, point_y=0.25, frame=LoadFrame.PLATFORM)
    document = Document(design=replace(APPENDIX_4, load=load))
    assert "load" not in persistence.dump(Document(design=APPENDIX_4))  # as older versions wrote it
    assert persistence.open_share_code(persistence.share_code(document)).design.load == load


def test_codes_from_before_there_were_counterweights_are_read() -> None:
    data = json.loads(persistence.dump(Document()))
    assert "counterweights" not in data  # as older versions wrote it
    assert persistence.load(json.dumps(data)).design.counterweights == ()


def test_codes_from_when_the_knee_was_no_part_of_the_design_are_read() -> None:
    code = (
        "PMZ1-eNqFjkEKwkAMRa8yZF2G0bYbd55DXLQ2SrCTGRKQSpm7N_ECQgj8_-AlO_CUES4BrrUiL7SFAboACyq92PodVuK3"
        "xrm3kOLYDH5QlIrTk6VJFfO8fl2SSaSIC2pR195STGMXkk08-xruBgWfKMgP_B3490Fr7QAXKDET"
    )
    upper = APPENDIX_4.with_knee(KneeBranch.UPPER)
    assert persistence.open_share_code(code) == Document(
        upper.vary({"links.b3": 0.5}), (0.05, 0.0, 0.2, 0.4), reference=upper
    )


@pytest.mark.parametrize(
    "weights",
    [
        [["b8", 7, 0.1, 1.0]],
        [["b8", 8, 0.1, -1.0]],
        [["b8", 8, 0.1]],
        [["b8", 8, "0.1", 1.0]],
        [["b8", 8, 0.1, 1.0]] * (MOST_COUNTERWEIGHTS + 1),
        {"b8": 1},
    ],
)
def test_impossible_counterweights_are_refused(weights: Any) -> None:
    data = json.loads(persistence.dump(Document()))
    with pytest.raises(PaminsaError):
        persistence.load(json.dumps(data | {"counterweights": weights}))


def pack(text: str | bytes) -> str:
    """Return a share code of any text."""
    data = text.encode() if isinstance(text, str) else text
    return persistence.PREFIX + base64.urlsafe_b64encode(zlib.compress(data)).decode().rstrip("=")


def only_refused(read: Callable[[str], Any], text: str) -> None:
    """Check that a text is read or refused; never anything else."""
    try:
        document = read(text)
    except PaminsaError as error:
        message = str(error)
    else:
        message = ""
        assert all(math.isfinite(value) for value in document.pose)
    assert len(message) < 500


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=8,
)


@given(text=st.text(), data=st.binary(max_size=200), value=JSON)
def test_any_text_is_read_or_refused(text: str, data: bytes, value: Any) -> None:
    for whole in (text, json.dumps(value)):
        only_refused(persistence.load, whole)
        only_refused(persistence.open_share_code, whole)
        only_refused(persistence.open_share_code, pack(whole.encode(errors="replace")))
    only_refused(persistence.open_share_code, pack(data))
    only_refused(
        persistence.open_share_code, persistence.PREFIX + base64.urlsafe_b64encode(data).decode()
    )


@given(
    document=DOCUMENTS,
    key=st.sampled_from(
        ["version", "name", "design", "assembly", "pose", "reference", "counterweights"]
    ),
    value=JSON,
    remove=st.booleans(),
)
def test_a_document_with_something_else_in_one_place_is_read_or_refused(
    document: Document, key: str, value: Any, remove: bool
) -> None:
    data = json.loads(persistence.dump(document))
    if remove:
        data.pop(key, None)
    else:
        data[key] = value
    only_refused(persistence.load, json.dumps(data))
    data = json.loads(persistence.dump(document))
    data["design"]["links.b3"] = value
    only_refused(persistence.load, json.dumps(data))


@given(document=DOCUMENTS, place=st.floats(0, 1), letter=st.characters())
def test_a_share_code_with_a_wrong_letter_is_refused(
    document: Document, place: float, letter: str
) -> None:
    code = persistence.share_code(document)
    index = min(int(place * len(code)), len(code) - 1)
    wrong = code[:index] + letter + code[index + 1 :]
    if wrong[len(persistence.PREFIX) :].strip() == code[len(persistence.PREFIX) :]:
        return
    try:
        found = persistence.open_share_code(wrong)
    except PaminsaError:
        return
    assert_same(found, document)  # the last letter has bits that mean nothing


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "begins with PMZ1-"),
        ("PMZ2-eNpL", "another version"),
        ("PMZ1-", "damaged"),
        ("PMZ1-eNpL", "damaged"),
        ("PMZ1-ä", "damaged"),
        (persistence.share_code(Document())[:-4], "damaged"),
        (pack(persistence.dump(Document())) + "AAAA", "damaged"),
        ("PMZ1-" + "A" * 8000, "too long"),
        (pack("[" * 15_000), "cannot be read"),
        (pack('{"version": 7}'), "version 7 is not known"),
        (pack(json.dumps({"version": "7" * 9000})), "is not known"),
        (pack(persistence.dump(Document()).replace("[0.0", "[1" + "0" * 400)), "cannot be read"),
        (pack(persistence.dump(Document()).replace("[0.0", "[NaN")), "pose is not possible"),
        (pack(persistence.dump(Document()).replace("[0.0", "[1e7")), "pose is not possible"),
        (pack(persistence.dump(Document()).replace("[0.0", '["1"')), "a number is needed"),
        (
            pack(
                persistence.dump(Document()).replace('"design": {}', '"design": {"links.b3": -1}')
            ),
            "links.b3",
        ),
    ],
)
def test_what_is_wrong_with_a_share_code_is_said(text: str, said: str) -> None:
    with pytest.raises(PaminsaError) as error:
        persistence.open_share_code(text)
    assert said in str(error.value)
    assert len(str(error.value)) < 300


def test_a_share_code_is_not_unpacked_beyond_its_bound() -> None:
    bomb = zlib.compress(b" " * 5_000_000, 9)
    code = persistence.PREFIX + base64.urlsafe_b64encode(bomb).decode()
    assert len(code) < persistence.LONGEST_CODE  # or its length would be what refuses it
    with pytest.raises(InvalidInput, match="damaged"):
        persistence.open_share_code(code)


def test_a_name_from_elsewhere_is_made_printable() -> None:
    text = persistence.dump(Document()).replace('"Appendix 4"', json.dumps("a\nb" + "x" * 500))
    name = persistence.load(text).design.name
    assert name.startswith("a?bxxx")
    write_design(persistence.load(text).design)
