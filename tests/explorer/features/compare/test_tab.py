"""The comparison of the current design with a reference."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.compare.layers import PinnedDesign
from paminsa_viz.explorer.features.compare.tab import (
    COMPARE,
    PIN,
    PINNED,
    differences_html,
    names_html,
    torques_html,
)
from paminsa_viz.explorer.kit.design_numbers import is_changed
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    Design,
    LoadCase,
    LoadFrame,
    static_imbalance,
    static_torques,
)
from paminsa_viz.units import TIE
from tests.support.desk import Desk
from tests.support.raw_page import RawPage

PANEL = COMPARE


def cells(table: str) -> list[list[str]]:
    """Return the texts of a table's cells, row by row."""
    rows = re.findall(r"<tr[^>]*>(.*?)</tr>", table.replace(TIE, " "), re.S)
    found = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]
    return [[re.sub(r"<[^>]*>", "", cell) for cell in row] for row in found]


def value(text: str) -> float:
    """Read a number."""
    return float(text.replace("−", "-"))


@given(
    changes=st.dictionaries(
        st.sampled_from([p.path for p in PARAMETERS if not p.path.startswith("geometry")]),
        st.floats(0.1, 9),
        max_size=6,
    )
)
def test_table_lists_exactly_what_differs(changes: dict[str, float | None]) -> None:
    design = APPENDIX_4.vary(changes)
    differ = [p.path for p in PARAMETERS if design.value(p.path) != APPENDIX_4.value(p.path)]
    rows = cells(differences_html(design, APPENDIX_4, "App. 4"))[1:]
    found = [(value(row[1]), value(row[2])) for row in rows]
    expected = [
        [PARAMETER[path].display.from_si(of.value(path)) for of in (APPENDIX_4, design)]
        for path in differ
    ]
    assert np.array(found) == pytest.approx(np.array(expected), rel=1e-5)


def test_load_that_turns_with_the_platform_differs() -> None:
    turning = replace(APPENDIX_4, load=LoadCase(frame=LoadFrame.PLATFORM))
    (row,) = cells(differences_html(turning, APPENDIX_4, "App. 4"))[1:]
    assert row[1:3] == ["world", "platform"]


def test_stiffness_that_was_rigid_has_no_change_in_percent() -> None:
    design = APPENDIX_4.vary({"elastic.guide": 1e7})
    (row,) = cells(differences_html(design, APPENDIX_4, "App. 4"))[1:]
    assert row[1:] == ["rigid", "10000", "–"]


def test_stroke_that_was_set_differs_from_one_that_follows_its_guide() -> None:
    design = APPENDIX_4.vary({"geometry.guide_stroke": APPENDIX_4.geometry.stroke})
    assert is_changed(design, "geometry.guide_stroke")
    (row,) = cells(differences_html(design, APPENDIX_4, "App. 4"))[1:]
    assert row[1:3] == ["363.5 (lB10)", "363.5"]


def test_torques_of_both_designs_are_compared() -> None:
    pose = (0.05, -0.03, 0.4, -0.6)
    design = APPENDIX_4.vary({"links.b4": 1.0})
    now, then = static_torques(design, pose), static_torques(APPENDIX_4, pose)
    rows = cells(torques_html(now, then, design, APPENDIX_4, "reference"))[1:]
    found = np.array([[value(cell) for cell in row[1:4]] for row in rows[:4]])
    assert found == pytest.approx(np.stack([then, now, now - then], axis=1), abs=6e-3)
    assert len({row[4] for row in (*rows[:3], rows[4])}) == 1  # torques scale with M_p2
    assert all(row[3][0] in "+−" for row in rows)
    assert all(row[4].startswith("+") for row in rows)  # all of them grow in size
    assert value(rows[4][2]) == pytest.approx(static_imbalance(design), abs=6e-4)


def test_reference_that_cannot_take_the_pose_has_no_torques() -> None:
    text = torques_html(np.ones(4), np.full(4, np.nan), APPENDIX_4, APPENDIX_4, "reference")
    assert [row[1] for row in cells(text)[1:5]] == ["–"] * 4
    assert "cannot take this pose" in text
    assert "nan" not in text


def test_names_are_escaped() -> None:
    evil = Design(name="<img src=x onerror=alert(1)>")
    for reference in (None, evil):
        text = names_html(evil, reference)
        assert "<img" not in text
        assert "&lt;img" in text


def test_reference_is_pinned_swapped_and_unpinned(desk: Desk) -> None:
    buttons = desk.handle("reference")
    torques, differences = desk.handle("compare.torques"), desk.handle("compare.differences")
    desk.until(lambda: "No number differs" in differences.content)
    assert tuple(buttons.options) == tuple(PIN)
    before = desk.state
    for text in ("Swap", "anything"):  # no such button yet
        desk.set("reference", text)
        desk.dispatch(lambda s: s)
    assert desk.state == before
    desk.set("reference", "Pin current design")
    desk.until(lambda: tuple(buttons.options) == tuple(PINNED))
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0}))
    desk.until(lambda: len(cells(differences.content)) == 2)
    assert cells(differences.content)[1][1:] == ["0.406", "1", "+146 %"]
    assert f"+146{TIE}%" in differences.content, "a line may end between a number and its unit"
    desk.set("reference", "Swap")
    desk.until(lambda: desk.design == APPENDIX_4)
    desk.until(lambda: cells(differences.content)[1][1:3] == ["1", "0.406"])
    desk.dispatch(lambda s: actions.move(s, x=0.05))
    desk.until(lambda: value(cells(torques.content)[1][1]) != 0)
    desk.set("reference", "Unpin")
    desk.until(lambda: desk.state.document.reference is None)
    desk.until(lambda: tuple(buttons.options) == tuple(PIN))
    desk.until(lambda: cells(torques.content)[0][1] == "App. 4")


@pytest.mark.slow
def test_pinned_design_is_seen_where_its_shape_differs(server: viser.ViserServer) -> None:
    page = RawPage(server)
    nodes = page.client.scene._handle_from_node_name
    view = PinnedDesign(SceneContext(page.client.scene))
    state = actions.pin_reference(initial_state())
    view.draw(compute(state), False)
    assert "/pinned" not in nodes  # the same robot
    longer = actions.vary(state, {"geometry.coupler_length": 0.5})
    view.draw(compute(actions.move(longer, x=0.05)), False)
    assert nodes["/pinned"].visible
    platform = nodes["/pinned/platform"].position
    np.testing.assert_allclose(
        platform, np.array(longer.last_reachable.pose)[[0, 1, 3]] + [0.05, 0, 0]
    )
    for other in (actions.unpin_reference(longer), actions.set_layers(longer, pinned_design=False)):
        view.draw(compute(other), False)
        assert not nodes["/pinned"].visible
    page.socket.close()
