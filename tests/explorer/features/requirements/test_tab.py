"""The tab Requirements: marks and margins that follow the design, the volume, and what is empty."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.explorer.core import actions as designs
from paminsa_viz.explorer.core.causes import surface_parts
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.core.requirements import current_check, is_quick, placed_workspace
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.features.requirements import texts as text
from paminsa_viz.explorer.features.requirements.tab import REQUIREMENTS, go_to_worst
from paminsa_viz.explorer.features.requirements.volumes import find_volume, receive
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.requirements import VolumeJob
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.strip import strip_html
from paminsa_viz.quantities.requirements import Requirement
from tests.support.desk import Desk

PANEL = REQUIREMENTS


@pytest.fixture
def asked() -> State:
    """The suggested requirements of Appendix 4."""
    return actions.suggest(initial_state())


def solved(state: State, *, fine: bool = False) -> State:
    document = state.document
    job = VolumeJob(document.design, document.requirements, fine)
    return receive(state, solve(find_volume, job))


def test_marks_follow_the_design(asked: State) -> None:
    assert "✗" not in text.list_html(compute(asked))
    smaller = designs.vary(asked, {"geometry.base_radius": 0.22})
    shown = text.list_html(compute(smaller))
    check = current_check(smaller)
    assert check is not None
    assert shown.count("✗") == sum(not item.holds for item in check.items) > 0
    assert strip_html(compute(smaller)).count("✗") == shown.count("✗")
    assert 'title="Worst values over the required workspace' in strip_html(compute(smaller))
    assert "requirements-strip" not in strip_html(compute(initial_state()))


def test_bounds_can_be_changed_while_they_are_checked(asked: State) -> None:
    slow = actions.choose_quantity(asked, "error_horizontal")
    assert current_check(slow) is None
    shown = text.list_html(compute(slow))
    bounds = slow.document.requirements.bounds
    assert shown.count("<input") == len(bounds)
    assert shown.count("<td>…</td>") == len(bounds) + len(text.ALWAYS)
    check = current_check(asked)
    assert check is not None
    assert tuple(item.label for item in check.items[: len(text.ALWAYS)]) == text.ALWAYS
    assert "Not checked yet since the last change." in shown
    job = VolumeJob(slow.document.design, slow.document.requirements, fine=False)
    failed = receive(slow, Outcome(job, error=InvalidInput("volume", "there is none")))
    shown = text.list_html(compute(failed))
    assert shown.count("<input") == len(bounds)
    assert "Volume: there is none." in shown
    assert "No requirements yet" in text.list_html(compute(initial_state()))


def test_a_name_may_break_where_its_number_and_unit_may_not(asked: State) -> None:
    shown = [text.list_html(compute(actions.choose_side(asked, side))) for side in actions.Side]
    for found in shown:
        kept = re.findall('<span class="pv-bound">(.*?)</span>', found)
        assert all("<input" in one and "<button" not in one for one in kept)
        assert len(kept) == found.count("<input")
    bounds = asked.document.requirements.bounds
    assert max(found.count("<input") for found in shown) == len(bounds) + 1


def test_marks_of_the_strip_are_gray_until_the_next_check(asked: State) -> None:
    def line(state: State) -> tuple[list[str], bool]:
        shown = text.strip_html(state)
        return re.findall("<b>(.)</b>", shown), "pv-stale" in shown

    free = actions.set_workspace(asked, center=(0.0, 0.0, None))  # not checked at once
    assert line(free) == ([], False)
    state = solved(free)
    marks, stale = line(state)
    assert len(marks) == 2 + len(free.document.requirements.bounds)
    assert not stale
    other = designs.vary(state, {"geometry.base_radius": 0.22})
    fewer = actions.remove(state)
    for changed in (other, fewer):
        assert line(changed) == (marks, True)
        assert "since the last change" in text.strip_html(changed)
    assert line(solved(fewer)) == (marks[:2] + marks[3:], False)
    assert line(solved(other))[1] is False
    assert "✗" in line(solved(other))[0]
    assert line(actions.change(state, bounds=(), workspace=None)) == ([], False)


@pytest.mark.slow
def test_ends_in_the_wrong_order_are_refused_as_they_were_typed(desk: Desk, asked: State) -> None:
    before = asked.document.requirements.theta
    desk.dispatch(lambda state: replace(state, document=asked.document))
    desk.set("requirements.headings", [40.0, 35.0])
    desk.noticed("θ [°]: the least and then the largest is needed, not 40 and 35")
    assert desk.state.document.requirements.theta == before


@pytest.mark.slow
def test_the_end_that_is_passed_by_the_other_one_goes_along(desk: Desk, asked: State) -> None:
    desk.dispatch(lambda state: replace(state, document=asked.document))
    low, high = np.rad2deg(asked.document.requirements.theta).tolist()
    for typed, taken in (
        ((high + 5, high), (high + 5, high + 5)),
        ((high + 5, high + 20), (high + 5, high + 20)),
        ((high + 5, low), (low, low)),
    ):
        desk.set("requirements.headings", list(typed))
        ends = np.deg2rad(taken)
        desk.until(lambda ends=ends: np.allclose(desk.state.document.requirements.theta, ends))
        desk.until(
            lambda taken=taken: np.allclose(desk.handle("requirements.headings").value, taken)
        )


def test_a_worst_value_leads_to_its_pose(asked: State) -> None:
    check = current_check(asked)
    assert check is not None
    for place, item in (("0", check.items[2]), ("reach", check.items[0])):
        there = go_to_worst(asked, place)
        assert item.pose is not None
        assert there.last_reachable.pose == pytest.approx(item.pose)
    assert go_to_worst(asked, "99") is asked
    assert go_to_worst(initial_state(), "0") == initial_state()


def test_a_volume_says_what_it_is_of_and_which_requirement_takes_how_much(asked: State) -> None:
    state = solved(asked)
    shown = text.volume_html(compute(state))
    volume = state.requirements.quick.result.volume  # type: ignore[union-attr]
    assert volume is not None
    size = re.search(r"(\d+)(\.\d+)? ± \d+(\.\d+)? dm³", shown)
    assert size is not None
    assert len(size[2] or "") == len(size[3] or "")  # the same decimals
    last = 10.0 ** -max(len(size[2] or "") - 1, 0)
    assert abs(float(size[1] + (size[2] or "")) - 1e3 * volume.volume) <= 0.5001 * last
    assert "(coarse)" in shown
    for bound in state.document.requirements.bounds:
        assert bound.entry.symbol in shown
    other = designs.vary(state, {"geometry.base_radius": 0.36})
    assert "Computing" in text.volume_html(compute(other))
    assert receive(other, state.requirements.quick) is other  # type: ignore[arg-type]


def test_an_empty_volume_names_what_empties_it(asked: State) -> None:
    bounds = asked.document.requirements.bounds
    one = solved(actions.change(asked, bounds=(*bounds, Requirement("condition", high=1.01))))
    assert "No pose meets κ ≤ 1.01." in text.volume_html(compute(one))
    # Each of the two holds somewhere, and a third one everywhere.
    torque, least = Requirement("max_torque", high=1.0), Requirement("max_torque", low=2.0)
    pair = solved(actions.change(asked, bounds=(bounds[0], torque, least)))
    shown = text.volume_html(compute(pair))
    assert re.search(r"No (pose|place of the workspace) meets these together: .+; .+\.", shown)
    assert "would do with" in shown


def test_a_free_workspace_is_placed_by_the_volume(asked: State) -> None:
    workspace = asked.document.requirements.workspace
    assert workspace is not None
    assert is_quick(asked.document.requirements)
    free = actions.set_workspace(asked, center=(0.0, 0.0, None))
    assert not is_quick(free.document.requirements)
    assert placed_workspace(free) is None
    placed = placed_workspace(solved(free))
    assert placed is not None
    assert placed[1] == workspace.size
    assert placed[2][:2] == (0.0, 0.0)
    assert -1.0 < placed[2][2] < 0.0


def test_maps_are_hatched_where_a_requirement_breaks_at_their_heading_and_height(
    asked: State,
) -> None:
    state = designs.move(
        actions.change(asked, bounds=(Requirement("condition", high=4.0),)), theta=0.2
    )
    data = MapStore().data(state, 41, ("condition",), hatched=True)
    assert data.outside is not None
    reached = data.status == 0
    assert ((data.outside.code > 0) == (reached & ~(data.values[0] <= 4.0))).all()
    assert {text for text, _ in data.outside.present()} == {"singularity", "κ ≤ 4"}
    beyond = designs.move(state, theta=1.0)  # a heading that is not required
    outside = MapStore().data(beyond, 41, hatched=True).outside
    assert outside is not None
    assert not outside.code.any()
    assert (
        MapStore().data(state.updated("map_view", hatched=False), 41, hatched=True).outside is None
    )
    assert MapStore().data(initial_state(), 41, hatched=True).outside is None


def test_the_surface_is_closed_and_in_the_colors_of_its_causes(asked: State) -> None:
    volume = solved(asked).requirements.quick.result.volume  # type: ignore[union-attr]
    assert volume is not None
    parts = surface_parts(volume)
    content = 0.0
    for part in parts:
        a, b, c = (part.vertices[part.faces[:, i]] for i in range(3))
        content += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    assert abs(content) == pytest.approx(volume.volume, rel=0.02)  # drawn by cells
    assert len({part.color for part in parts}) == len(parts) > 1


@pytest.mark.slow
def test_requirements_are_added_and_changed_on_the_page(desk: Desk) -> None:
    desk.set("requirements.buttons", "Suggested set")
    desk.until(lambda: len(desk.state.document.requirements.bounds) == 4)
    desk.until(lambda: desk.state.requirements.quick is not None)
    desk.say("bound", ["0 high", 1.01])
    desk.until(lambda: desk.state.document.requirements.bounds[0].high == 1.01)
    desk.until(lambda: "✗" in desk.handle("requirements.list").content)
    desk.until(lambda: "No pose meets" in desk.handle("requirements.volume_text").content)
    desk.set("requirements.quantity", "determinant")
    desk.until(lambda: desk.state.document.requirements.bounds[0].quantity == "determinant")
    desk.set("requirements.buttons", "Remove")
    desk.until(lambda: len(desk.state.document.requirements.bounds) == 3)
    desk.until(lambda: "Find the largest" in desk.handle("requirements.volume_text").content)
    before = desk.state.document
    desk.say("largest workspace", None)
    desk.until(lambda: desk.state.requirements.largest.running is not None)
    assert desk.state.document == before
    assert not desk.notices


def test_a_largest_workspace_is_stale_once_what_it_is_of_has_changed() -> None:
    state = actions.suggest(initial_state())
    job = actions.largest_job(state)
    placed = replace(job.workspace, center=(0.0, 0.0, -0.5))
    found: Any = SimpleNamespace(workspace=placed)
    kept = state.updated("requirements.largest", outcome=Outcome(job, found))
    assert actions.LARGEST.changes(kept) == ()
    assert actions.LARGEST.changes(actions.use_largest(kept)) == ()
    other = actions.set_workspace(kept, size=(0.3, 0.3, 0.9))
    assert actions.LARGEST.changes(other) == ("size",)
    assert actions.LARGEST.changes(kept.updated("requirements.largest.settings", seconds=60.0)) == (
        "seconds",
    )
    assert actions.LARGEST.changes(actions.change(kept, bounds=())) == ("requirements",)
