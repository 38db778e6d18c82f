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

from paminsa_viz.explorer.core import persistence
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.motion import MOST_WAYPOINTS, Kind, Motion, Timing
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput, KneeBranch, PaminsaError
from paminsa_viz.model.parameters import MOST_COUNTERWEIGHTS, Counterweight
from paminsa_viz.trajectory import MotionLimits, Profile, from_samples
from tests.support.documents import assert_same, designs, documents
from tests.support.samples import random_design

PLAIN = persistence.dump(Document())


def pack(text: str | bytes) -> str:
    """Return a share code of any text."""
    data = text.encode(errors="replace") if isinstance(text, str) else text
    return persistence.PREFIX + base64.urlsafe_b64encode(zlib.compress(data)).decode().rstrip("=")


@pytest.mark.slow
@given(document=documents(), width=st.integers(5, 80))
def test_documents_come_back_to_the_last_digit(document: Document, width: int) -> None:
    assert_same(persistence.load(persistence.dump(document)), document)
    code = persistence.share_code(document)
    assert_same(persistence.open_share_code(code), document)
    lines = [code[i : i + width] for i in range(0, len(code), width)]  # as a mail breaks it
    assert_same(persistence.open_share_code("  " + " \r\n".join(lines) + "\n"), document)


@pytest.mark.slow
@given(design=designs())
def test_shared_design_can_be_written_to_a_file(design: Design) -> None:
    shared = persistence.open_share_code(persistence.share_code(Document(design))).design
    assert read_design(write_design(shared), "shared") == design


def test_share_codes_are_short_and_the_longest_documents_fit() -> None:
    assert len(persistence.share_code(Document())) < 200
    rng = np.random.default_rng(0)

    def heavy() -> Design:
        weights = (Counterweight("b8", 8, *map(float, rng.random(2))) for _ in range(99))
        return replace(random_design(rng), counterweights=tuple(weights)[:MOST_COUNTERWEIGHTS])

    waypoints: Any = tuple(map(tuple, rng.random((MOST_WAYPOINTS, 4)).tolist()))
    motion = Motion(kind=Kind.WAYPOINTS, waypoints=waypoints)
    full = Document(heavy(), reference=heavy())
    assert len(persistence.share_code(full)) < persistence.LONGEST_CODE / 2
    assert len(persistence.dump(full)) < persistence.LONGEST_TEXT / 2
    full = replace(full, motion=motion)
    assert persistence.open_share_code(persistence.share_code(full)) == full


def test_motion_from_a_file_is_not_saved() -> None:
    table = from_samples([0.0, 1.0], [[0.0] * 4, [0.1] * 4])
    document = Document(motion=Motion(kind=Kind.TABLE, table=table))
    assert persistence.load(persistence.dump(document)) == Document()


def test_what_a_design_does_not_have_is_not_written_as_in_earlier_versions() -> None:
    for name in ("counterweights", "load", "drives", "requirements"):
        assert name not in PLAIN


EARLIER = {
    "when the knee was no part of the design": (
        "PMZ1-eNqFjkEKwkAMRa8yZF2G0bYbd55DXLQ2SrCTGRKQSpm7N_ECQgj8_-AlO_CUES4BrrUiL7SFAboACyq92PodVuK3"
        "xrm3kOLYDH5QlIrTk6VJFfO8fl2SSaSIC2pR195STGMXkk08-xruBgWfKMgP_B3490Fr7QAXKDET",
        Document(
            APPENDIX_4.with_knee(KneeBranch.UPPER).vary({"links.b3": 0.5}),
            (0.05, 0.0, 0.2, 0.4),
            reference=APPENDIX_4.with_knee(KneeBranch.UPPER),
        ),
    ),
    "0.1.0, when the center was saved as centre": (
        "PMZ1-eNpdUe9qwyAQf5Xg5y7YpGFj3_YcpQyrl-Bq1J6mWxf67vMu6QoFEe73z7tzFl6NIN4r8REjeGN_qp3YVMJAsoMv"
        "-Hwr1QUw2UDltlQqJRiP7kquiNZnMGSJIVHQXtZyUz2uF1l3XXMoAoQeELwmlZ-cK9AY8pI7i5P1hhK1Re2AAlNWmJfE8q"
        "zkQ2mU9a2uMZSnE_F7-UQ_HHWzdnAglwaf8d7kwsiWVNtFtbSpjJ0ot5BvNBeG3jreUUYV4TdYnjfb0fqB4MFewPPWJlTr"
        "QE3dFcAVDfc4ixQBDKe-knlC_3mHGtqTUFqDg_-AjkHWPTHr7r4AT4-KhSvUysUb8DxR3zsu-4C8-lYWmn71qDSpM07AY2"
        "diO2Zvf-UJlx8",
        Motion(
            kind=Kind.CIRCLE,
            center=(0.02, -0.03, 0.1, -0.52),
            radius=0.08,
            start=(0.1, 0.0, 0.0, -0.5),
            waypoints=((0.0, 0.0, 0.0, -0.5), (0.1, 0.0, 0.2, -0.55)),
            profile=Profile.TRAPEZOID,
            timing=Timing.GIVEN,
            duration=2.5,
            limits=MotionLimits(
                speed=0.7, turn_speed=2.0, acceleration=5.0, turn_jerk=30.0, torque=4.0, force=300.0
            ),
            back=True,
            rate=500.0,
        ),
    ),
}


@pytest.mark.parametrize(("code", "expected"), EARLIER.values(), ids=EARLIER)
def test_share_codes_of_earlier_versions_open(code: str, expected: Document | Motion) -> None:
    found = persistence.open_share_code(code)
    assert (found.motion if isinstance(expected, Motion) else found) == expected


WEIGHT = ["b8", 8, 0.1, 1.0]


@pytest.mark.parametrize(
    "changes",
    [
        *(
            {"counterweights": weights}
            for weights in (
                [["b8", 7, 0.1, 1.0]], [["b8", 8, 0.1, -1.0]], [["b8", 8, 0.1]],
                [["b8", 8, "0.1", 1.0]], [WEIGHT] * (MOST_COUNTERWEIGHTS + 1), {"b8": 1},
            )
        ),
        *(
            {"motion": motion}
            for motion in (
                {"kind": "fly"}, {"kind": "table"}, {"preset": "none of them"}, {"duration": -1},
                {"duration": "1"}, {"duration": True}, {"start": [0, 0, 0]},
                {"start": [1e9, 0, 0, 0]}, {"waypoints": [[0, 0, 0, 0]] * (MOST_WAYPOINTS + 1)},
                {"waypoints": 3}, {"limits": {"speed": -1}}, {"limits": {"color": 1}},
                {"limits": 4}, 7,
            )
        ),
    ],
    ids=lambda changes: str(changes)[:50],
)  # fmt: skip
def test_impossible_parts_of_a_document_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(PaminsaError):
        persistence.load(json.dumps(json.loads(PLAIN) | changes))


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


@pytest.mark.slow
@given(text=st.text(), data=st.binary(max_size=200), value=JSON)
def test_any_text_is_read_or_refused(text: str, data: bytes, value: Any) -> None:
    for whole in (text, json.dumps(value)):
        only_refused(persistence.load, whole)
        for code in (whole, pack(whole)):
            only_refused(persistence.open_share_code, code)
    encoded = base64.urlsafe_b64encode(data).decode()
    for code in (pack(data), persistence.PREFIX + encoded):
        only_refused(persistence.open_share_code, code)


@pytest.mark.slow
@given(
    document=documents(),
    key=st.sampled_from(
        ["version", "name", "design", "knee", "pose", "reference", "counterweights", "motion"]
    ),
    value=JSON,
)
def test_document_with_anything_in_one_place_is_read_or_refused(
    document: Document, key: str, value: Any
) -> None:
    data = json.loads(persistence.dump(document))
    for changed in (
        data | {key: value},
        {name: old for name, old in data.items() if name != key},
        data | {"design": data["design"] | {"links.b3": value}},
    ):
        only_refused(persistence.load, json.dumps(changed))


@given(document=documents(), place=st.floats(0, 1), letter=st.characters())
def test_share_code_with_a_wrong_letter_is_refused(
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
    ("text", "problem"),
    [
        ("", "begins with PMZ1-"),
        ("PMZ2-eNpL", "another version"),
        ("PMZ1-", "damaged"),
        ("PMZ1-eNpL", "damaged"),
        ("PMZ1-ä", "damaged"),
        (pack(PLAIN)[:-4], "damaged"),
        (pack(PLAIN) + "AAAA", "damaged"),
        ("PMZ1-" + "A" * 16000, "too long"),
        (pack("[" * 15_000), "cannot be read"),
        (pack('{"version": 7}'), "version 7 is not known"),
        (pack(json.dumps({"version": "7" * 9000})), "is not known"),
        (pack(PLAIN.replace("[0.0", "[1" + "0" * 400)), "cannot be read"),
        (
            pack(PLAIN.replace("[0.0", "[NaN")),
            "x of its pose: up to 1e+06 m or rad in size is possible",
        ),
        (pack(PLAIN.replace("[0.0", "[1e7")), "in size is possible, not 1e+07"),
        (pack(PLAIN.replace("[0.0", '["1"')), "a number is needed"),
        (pack(PLAIN.replace('"design": {}', '"design": {"links.b3": -1}')), "links.b3"),
        # Not unpacked beyond its bound, though short enough itself.
        (pack(b" " * 5_000_000), "damaged"),
    ],
    ids=lambda text: text[-12:],
)
def test_refusal_of_a_share_code_says_why(text: str, problem: str) -> None:
    with pytest.raises(InvalidInput if "links" not in problem else PaminsaError) as error:
        persistence.open_share_code(text)
    assert problem in str(error.value)
    assert len(str(error.value)) < 300


def test_name_from_elsewhere_is_made_printable() -> None:
    text = PLAIN.replace('"Appendix 4"', json.dumps("a\nb" + "x" * 500))
    design = persistence.load(text).design
    assert design.name.startswith("a?bxxx")
    write_design(design)


def test_old_words_for_the_knee_are_read() -> None:
    for old, new in (("printed", "lower"), ("mirror", "upper")):
        document = Document(design=APPENDIX_4.with_knee(KneeBranch(new)))
        data = json.loads(persistence.dump(document))
        assert data.pop("knee") == new
        assert persistence.load(json.dumps(data | {"assembly": old})) == document
