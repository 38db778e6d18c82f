"""State, actions, history, saved text and share codes: pure functions, no page."""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions, saving, sharing
from paminsa_viz.explorer.bounds import MOST_COUNTERWEIGHTS, largest, require_workable
from paminsa_viz.explorer.frame import Health, compute
from paminsa_viz.explorer.history import DEPTH, PAUSE, History
from paminsa_viz.explorer.state import Document, State, initial_state
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    Assembly,
    Design,
    InvalidDesign,
    InvalidInput,
    PaminsaError,
    check_reach,
)
from paminsa_viz.model.counterweight import BAR_ENDS, Counterweight
from tests.samples import random_design, random_poses

FAR = {"x": 5.0}
"""A move that no leg can follow."""


COUNTERWEIGHTS = st.builds(
    lambda place, end, beyond, mass: Counterweight(place[0], place[1][end], beyond, mass),
    st.sampled_from(list(BAR_ENDS.items())),
    st.sampled_from([0, 1]),
    st.floats(-0.5, 0.5),
    st.floats(0, 20),
)


@st.composite
def designs(draw: st.DrawFn) -> Design:
    design = random_design(np.random.default_rng(draw(st.integers(0, 10**6))))
    if draw(st.booleans()):
        stroke = draw(st.sampled_from([APPENDIX_4.geometry.stroke, 0.2, 0.417]))
        design = design.vary({"geometry.guide_stroke": stroke})
    printable = st.characters(exclude_categories=("C", "Z"))
    weights = tuple(draw(st.lists(COUNTERWEIGHTS, max_size=3)))
    return replace(design, counterweights=weights, name=draw(st.text(printable, max_size=30)))


COORDINATE = st.floats(-3, 3)

DOCUMENTS = st.builds(
    Document,
    design=designs(),
    assembly=st.sampled_from(Assembly),
    pose=st.tuples(COORDINATE, COORDINATE, COORDINATE, COORDINATE),
    reference=st.none() | designs(),
)


def standing_state(seed: int) -> State:
    """Return a state in which a random robot stands at a random pose."""
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    x, y, theta, z = (float(v) for v in random_poses(rng, design)[0])
    state = initial_state(design)
    return actions.move(state, x=x, y=y, theta=theta, z=z)


def assert_same(a: Document, b: Document) -> None:
    """Compare two documents and, what equality leaves out, the names of their designs."""
    assert a == b
    assert a.design.name == b.design.name
    if a.reference is not None:
        assert b.reference is not None
        assert a.reference.name == b.reference.name


# The last good posture


def test_a_pose_out_of_reach_leaves_the_last_good_one_standing() -> None:
    good = actions.move(initial_state(), x=0.05, theta=0.3)
    asked = actions.move(actions.move(good, **FAR), y=0.01)
    assert asked.document.pose[:2] == (5.0, 0.01)
    assert asked.standing is good.standing
    assert compute(asked).health is Health.UNREACHABLE
    assert np.isfinite(compute(asked).torques).all()
    back = actions.move(asked, x=0.02)
    assert back.standing.pose == back.document.pose == (0.02, 0.01, 0.3, good.document.pose[3])


def test_a_geometry_that_can_not_stand_leaves_the_last_good_one_standing() -> None:
    good = initial_state()
    asked = actions.vary(good, {"geometry.guide_stroke": 0.01})
    assert asked.standing is good.standing
    heavier = actions.vary(asked, {"links.b4": 3.0})
    assert heavier.standing is good.standing
    assert compute(heavier).torques[3] > compute(good).torques[3]  # the masses still count


@given(seed=st.integers(0, 10**6), x=COORDINATE, theta=COORDINATE)
def test_what_stands_can_always_stand(seed: int, x: float, theta: float) -> None:
    state = actions.move(actions.move(standing_state(seed), x=x), theta=theta)
    assert check_reach(state.standing.geometry, state.standing.pose).ok.all()
    followed = check_reach(state.document.design.geometry, state.document.pose).ok.all()
    assert (state.standing.pose == state.document.pose) == bool(followed)


# Actions


@given(seed=st.integers(0, 10**6))
def test_mirroring_the_assembly_twice_changes_nothing_and_once_turns_the_torques_round(
    seed: int,
) -> None:
    state = standing_state(seed)
    once = actions.assemble(state, Assembly.MIRROR)
    twice = actions.assemble(once, Assembly.PRINTED)
    assert twice.document.assembly is state.document.assembly
    assert twice.document.pose == pytest.approx(state.document.pose, abs=1e-15)
    assert once.standing.pose == once.document.pose  # the mirrored pose is within reach as well
    np.testing.assert_allclose(
        compute(once).torques[:3], -compute(state).torques[:3], rtol=1e-9, atol=1e-9
    )
    assert actions.assemble(state, Assembly.PRINTED) is state


def test_home_is_within_reach_in_both_assemblies() -> None:
    for assembly in Assembly:
        home = actions.go_home(actions.assemble(initial_state(), assembly))
        assert home.standing.pose == home.document.pose
        assert compute(home).health is Health.FINE


def test_another_design_keeps_the_pose_if_it_can_and_goes_home_if_not() -> None:
    state = actions.move(initial_state(), x=0.1)
    heavier = APPENDIX_4.vary({"payload.mass": 2.0})
    assert actions.load_design(state, heavier).document.pose == state.document.pose
    rng = np.random.default_rng(4)
    small = random_design(rng).vary({"geometry.guide_stroke": 0.09, "geometry.base_radius": 0.2})
    moved = actions.load_design(actions.move(state, x=0.15, y=0.1), small)
    assert moved.document.pose[:3] == (0, 0, 0)
    assert moved.standing.geometry == small.geometry


def test_values_reset_to_appendix_4_and_the_stroke_follows_its_guide_again() -> None:
    state = actions.vary(initial_state(), {"links.b3": 2.0, "geometry.guide_stroke": 0.3})
    partly = actions.reset_values(state, ("geometry.guide_stroke",))
    assert partly.document.design.geometry.guide_stroke is None
    assert partly.document.design.links.b3 == 2.0
    assert actions.reset_values(partly, ("links.b3",)).document.design == APPENDIX_4


def test_a_changed_design_is_not_called_appendix_4() -> None:
    changed = actions.vary(initial_state(), {"links.b3": 2.0})
    assert changed.document.design.name == actions.CHANGED_NAME != APPENDIX_4.name
    assert actions.vary(changed, {"links.b4": 2.0}).document.design.name == actions.CHANGED_NAME
    back = actions.reset_values(changed, ("links.b3",))
    assert back.document.design.name == APPENDIX_4.name
    mine = actions.vary(actions.rename(initial_state(), "mine"), {"links.b3": 2.0})
    assert mine.document.design.name == "mine"


def test_a_name_that_no_file_can_hold_is_refused() -> None:
    for name in ("two\nlines", "bell\a", "x" * 201):
        with pytest.raises(InvalidInput, match="name"):
            actions.rename(initial_state(), name)


@given(path=st.sampled_from([p.path for p in PARAMETERS]), factor=st.floats(1.0001, 1e300))
def test_no_number_beyond_any_machine_is_taken(path: str, factor: float) -> None:
    state = initial_state()
    huge = min(largest(path) * factor, 1e308)
    with pytest.raises(InvalidDesign):
        actions.vary(state, {path: huge})
    if PARAMETER[path].unit == "kg":
        design = APPENDIX_4.vary({path: huge})
        with pytest.raises(InvalidDesign):
            actions.load_design(state, design)
        for document in (Document(design), Document(reference=design)):
            with pytest.raises(InvalidDesign):
                actions.restore(state, document)


@given(
    changes=st.dictionaries(
        st.sampled_from([p.path for p in PARAMETERS]), st.floats(0, 1e4), max_size=8
    ),
    pose=st.tuples(*[st.floats(-1e6, 1e6)] * 4),
)
def test_every_size_that_is_taken_can_be_drawn(
    changes: dict[str, float | None], pose: tuple[float, float, float, float]
) -> None:
    state = initial_state()
    try:
        state = actions.vary(state, changes)
    except InvalidDesign:
        return
    x, y, theta, z = pose
    for asked in (state, actions.go_home(state), actions.move(state, x=x, y=y, theta=theta, z=z)):
        frame = compute(asked)
        assert np.isfinite(frame.torques).all()
        assert frame.explanation


def test_swapping_with_the_reference_twice_changes_nothing() -> None:
    state = actions.pin_reference(initial_state())
    state = actions.vary(state, {"links.b3": 2.0})
    once = actions.swap_reference(state)
    assert once.document.design == APPENDIX_4
    assert once.document.reference == state.document.design
    assert_same(actions.swap_reference(once).document, state.document)
    plain = initial_state()
    assert actions.swap_reference(plain) is plain


def test_without_a_reference_maps_show_no_difference() -> None:
    state = actions.set_map_view(actions.pin_reference(initial_state()), difference=True)
    assert not actions.unpin_reference(state).map_view.difference
    assert not actions.restore(state, Document()).map_view.difference
    assert actions.restore(state, Document(reference=APPENDIX_4)).map_view.difference


# History


@given(documents=st.lists(DOCUMENTS, min_size=2, max_size=8, unique_by=lambda d: d.pose))
def test_undo_takes_every_step_back_and_redo_takes_it_again(documents: list[Document]) -> None:
    history = History()
    for number, (before, after) in enumerate(pairwise(documents)):
        history.record(before, after, f"control {number}", float(number))
    present = documents[-1]
    for expected in documents[-2::-1]:
        found = history.undo(present)
        assert found is expected
        present = found
    assert history.undo(present) is None
    for expected in documents[1:]:
        found = history.redo(present)
        assert found is expected
        present = found
    assert history.redo(present) is None


def test_a_drag_is_one_step_and_a_pause_or_another_control_begins_a_new_one() -> None:
    history, present = History(), Document()
    at = [replace(present, pose=(0.0, 0.0, 0.0, float(i))) for i in range(6)]
    history.record(present, at[0], "z", 0.0)
    history.record(at[0], at[1], "z", 0.9 * PAUSE)
    history.record(at[1], at[2], "z", 1.8 * PAUSE)
    assert history.past == [present]
    history.record(at[2], at[3], "z", 3 * PAUSE)
    history.record(at[3], at[4], "x", 3 * PAUSE)
    assert history.past == [present, at[2], at[3]]
    assert history.undo(at[4]) is at[3]
    history.record(at[3], at[5], "x", 3.1 * PAUSE)  # after undo, a new step
    assert history.past[-1] is at[3]
    assert history.redo(at[5]) is None


def test_history_forgets_what_did_not_change_and_what_is_too_old() -> None:
    history = History()
    history.record(Document(), Document(), "nothing", 0.0)
    assert history.past == []
    renamed = replace(Document(), design=replace(APPENDIX_4, name="mine"))
    history.record(Document(), renamed, "name", 0.0)
    assert len(history.past) == 1  # a name is a change, though equality leaves it out
    for i in range(DEPTH + 10):
        a, b = (Document(pose=(float(i + j), 0.0, 0.0, 0.0)) for j in (0, 1))
        history.record(a, b, str(i), 0.0)
    assert len(history.past) == DEPTH
    assert history.past[-1].pose[0] == DEPTH + 9


# Saved text and share codes


@given(document=DOCUMENTS)
def test_a_document_survives_text_and_share_code_to_the_last_digit(document: Document) -> None:
    assert_same(saving.load(saving.dump(document)), document)
    assert_same(sharing.decode(sharing.encode(document)), document)


@given(design=designs())
def test_a_shared_design_can_be_written_to_a_file(design: Design) -> None:
    shared = sharing.decode(sharing.encode(Document(design))).design
    assert read_design(write_design(shared), "shared") == design


@given(document=DOCUMENTS, width=st.integers(5, 80))
def test_a_mail_may_break_a_share_code_into_lines(document: Document, width: int) -> None:
    code = sharing.encode(document)
    lines = [code[i : i + width] for i in range(0, len(code), width)]
    assert_same(sharing.decode("  " + " \r\n".join(lines) + "\n"), document)


def test_share_codes_are_short() -> None:
    assert len(sharing.encode(Document())) < 200
    rng = np.random.default_rng(0)

    def heavy() -> Design:
        weights = [
            Counterweight("b8", 8, *(float(v) for v in rng.random(2)))
            for _ in range(MOST_COUNTERWEIGHTS)
        ]
        return replace(random_design(rng), counterweights=tuple(weights))

    full = Document(heavy(), reference=heavy())
    assert len(sharing.encode(full)) < sharing.LONGEST_CODE / 2
    assert len(saving.dump(full)) < sharing.LONGEST_TEXT / 2


def test_codes_from_before_there_were_counterweights_are_read() -> None:
    data = json.loads(saving.dump(Document()))
    assert "counterweights" not in data  # as older versions wrote it
    assert saving.load(json.dumps(data)).design.counterweights == ()


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
    data = json.loads(saving.dump(Document()))
    with pytest.raises(PaminsaError):
        saving.load(json.dumps(data | {"counterweights": weights}))


def test_the_page_refuses_counterweights_out_of_its_range() -> None:
    for weights in (
        (Counterweight("b8", 8, 0.1, 1e5),),
        (Counterweight("b8", 8, -1e3, 1.0),),
        (Counterweight("b8", 8, 0.1, 1.0),) * (MOST_COUNTERWEIGHTS + 1),
    ):
        with pytest.raises(InvalidDesign, match="counterweights"):
            require_workable(replace(APPENDIX_4, counterweights=weights))


def pack(text: str | bytes) -> str:
    """Return a share code of any text."""
    data = text.encode() if isinstance(text, str) else text
    return sharing.PREFIX + base64.urlsafe_b64encode(zlib.compress(data)).decode().rstrip("=")


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
        only_refused(saving.load, whole)
        only_refused(sharing.decode, whole)
        only_refused(sharing.decode, pack(whole.encode(errors="replace")))
    only_refused(sharing.decode, pack(data))
    only_refused(sharing.decode, sharing.PREFIX + base64.urlsafe_b64encode(data).decode())


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
    data = json.loads(saving.dump(document))
    if remove:
        data.pop(key, None)
    else:
        data[key] = value
    only_refused(saving.load, json.dumps(data))
    data = json.loads(saving.dump(document))
    data["design"]["links.b3"] = value
    only_refused(saving.load, json.dumps(data))


@given(document=DOCUMENTS, place=st.floats(0, 1), letter=st.characters())
def test_a_share_code_with_a_wrong_letter_is_refused(
    document: Document, place: float, letter: str
) -> None:
    code = sharing.encode(document)
    index = min(int(place * len(code)), len(code) - 1)
    wrong = code[:index] + letter + code[index + 1 :]
    if wrong[len(sharing.PREFIX) :].strip() == code[len(sharing.PREFIX) :]:
        return
    try:
        found = sharing.decode(wrong)
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
        (sharing.encode(Document())[:-4], "damaged"),
        (pack(saving.dump(Document())) + "AAAA", "damaged"),
        ("PMZ1-" + "A" * 8000, "too long"),
        (pack("[" * 15_000), "can not be read"),
        (pack('{"version": 7}'), "version 7 is not known"),
        (pack(json.dumps({"version": "7" * 9000})), "is not known"),
        (pack(saving.dump(Document()).replace("[0.0", "[1" + "0" * 400)), "can not be read"),
        (pack(saving.dump(Document()).replace("[0.0", "[NaN")), "pose is not possible"),
        (pack(saving.dump(Document()).replace("[0.0", "[1e7")), "pose is not possible"),
        (pack(saving.dump(Document()).replace("[0.0", '["1"')), "a number is needed"),
        (
            pack(saving.dump(Document()).replace('"design": {}', '"design": {"links.b3": -1}')),
            "links.b3",
        ),
    ],
)
def test_what_is_wrong_with_a_share_code_is_said(text: str, said: str) -> None:
    with pytest.raises(PaminsaError) as error:
        sharing.decode(text)
    assert said in str(error.value)
    assert len(str(error.value)) < 300


def test_a_share_code_is_not_unpacked_beyond_its_bound() -> None:
    bomb = zlib.compress(b" " * 5_000_000, 9)
    code = sharing.PREFIX + base64.urlsafe_b64encode(bomb).decode()
    assert len(code) < sharing.LONGEST_CODE  # or its length would be what refuses it
    with pytest.raises(InvalidInput, match="damaged"):
        sharing.decode(code)


def test_a_name_from_elsewhere_is_made_printable() -> None:
    text = saving.dump(Document()).replace('"Appendix 4"', json.dumps("a\nb" + "x" * 500))
    name = saving.load(text).design.name
    assert name.startswith("a?bxxx")
    write_design(saving.load(text).design)
