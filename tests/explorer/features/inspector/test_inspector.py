"""The inspector: its numbers are those of the rooms, its shares add up, a click means a part."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.elastostatics.bar_loads import bar_loads, utilization
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.explorer.commands import commands
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.features.inspector import panel
from paminsa_viz.explorer.features.inspector.numbers import numbers
from paminsa_viz.explorer.features.inspector.panel import fields_of, label_of, section_of
from paminsa_viz.explorer.features.inspector.shares import (
    imbalance_share,
    strain_share,
    tolerance_share,
)
from paminsa_viz.explorer.features.loads.solving import ALONG_MOTION, find_loads
from paminsa_viz.explorer.features.motion import points
from paminsa_viz.explorer.kit.entries import given
from paminsa_viz.explorer.scene.bodies import Bodies
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.picking import picked
from paminsa_viz.explorer.state.inspector import PARTS, PartKind, RobotPart
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.tabs import sections
from paminsa_viz.model import APPENDIX_4, PARAMETER, static_imbalance
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.quantities import QUANTITIES
from tests.support.entries import inputs_in

B4 = RobotPart(PartKind.BAR, "b4", 1)
WEIGHT = Counterweight(mass=1.5, bar="b8", joint=8, beyond=0.1)


def inspecting(part: RobotPart = B4) -> State:
    return replace(actions.move(initial_state(), x=0.05, theta=0.3), inspected=part)


def frame_of(part: RobotPart = B4) -> Frame:
    return compute(inspecting(part))


def test_numbers_of_a_bar_are_those_of_its_loads() -> None:
    state = inspecting()
    forces = joint_forces(APPENDIX_4, state.document.pose)
    inner = bar_loads(forces, "b4").extremes()[1]
    use = utilization(forces)[1, BARS.index("b4")]
    found = numbers(state, B4)
    assert [one.now for one in found] == pytest.approx([*inner, 100 * use])
    assert np.isnan([one.worst for one in found]).all()
    assert "along the motion" in panel.text(compute(motions.choose_kind(state, Kind.ARCH)))


def test_loads_along_the_motion_are_listed_of_the_parts_own_leg() -> None:
    for part in PARTS:
        shown = panel.along_motion(initial_state(), part).loads.settings
        assert shown.along
        assert shown.leg == (part.leg or 0)
        assert part.kind is not PartKind.BAR or shown.bar == part.name


def test_worst_is_that_of_the_motion_once_it_is_known() -> None:
    state = motions.choose_kind(inspecting().updated("loads.settings", along=True), Kind.ARCH)
    analysis = compute(state).analysis
    assert analysis is not None
    loads = find_loads(analysis, None)
    state = ALONG_MOTION.deliver(state, solve(find_loads, analysis))
    inner, index = loads.bars[:, 1, BARS.index("b4")], np.arange(3)
    worst = inner[np.abs(inner).argmax(axis=0), index]
    most = 100 * loads.utilization[:, 1, BARS.index("b4")].max()
    assert [one.worst for one in numbers(state, B4)] == pytest.approx([*worst, most])
    (lift,) = numbers(state, PARTS[-1])
    assert abs(lift.worst) == pytest.approx(np.abs(loads.forces.torque[:, 3]).max())


def test_shares_add_up() -> None:
    design = replace(APPENDIX_4, counterweights=(WEIGHT,))
    of_one_leg = [part for part in PARTS if part.leg == 0 and part.mass_path]
    # Platform and payload are no part of M_p2: they hang on M4 alone.
    added = [imbalance_share(design, part) or 0.0 for part in of_one_leg]
    assert sum(added) == pytest.approx(static_imbalance(design))
    state = inspecting().updated("stiffness.settings", case="x")
    strain = [strain_share(state, part) or 0.0 for part in PARTS]
    assert sum(strain) == pytest.approx(1.0)
    frame = compute(state)
    kinds = [part for part in PARTS if part.leg == 0]
    assert sum(tolerance_share(frame, part) or 0.0 for part in kinds) == pytest.approx(1.0)


def test_every_part_has_a_text_a_map_fields_and_a_command() -> None:
    labels = {command.label for command in commands()}
    for part in PARTS:
        state = inspecting(part)
        assert part.title in panel.text(compute(state))
        assert panel.quantity_of(part) in QUANTITIES
        assert 2 <= len(fields_of(part)) <= 3
        assert f"Inspect: {part.title}" in labels


@pytest.mark.parametrize("path", sorted({path for part in PARTS for path in fields_of(part)}))
def test_link_of_a_number_names_an_input_of_the_section_it_opens(path: str) -> None:
    (section,) = (one for one in sections().values() if one.name == section_of(path))
    state = inspecting()
    labels = [given(one.label, state) for one in inputs_in(tuple(section.entries()))]
    (label,) = {label for label in labels if label.startswith(label_of(path))}
    assert PARAMETER[path].display.text in label


def test_out_of_reach_it_goes_on_with_the_last_reachable_pose() -> None:
    there = inspecting()
    beyond = actions.move(there, x=0.9)
    assert [n.now for n in numbers(beyond, B4)] == [n.now for n in numbers(there, B4)]


def test_click_on_a_bar_means_it_and_near_a_joint_the_joint() -> None:
    where = frame_of().configuration
    nine, four, five = (where.points[joint][1] for joint in (9, 4, 5))
    eye = np.array([2.0, -2.0, 1.0])
    between = (four + five) / 2 if np.linalg.norm(five - four) > 0.1 else (nine + four) / 2
    assert picked(where, "leg2/b4", eye, between - eye) == B4
    assert picked(where, "leg2/b4", eye, five - eye) == RobotPart(PartKind.JOINT, "5", 1)
    aside = np.cross(five - eye, [0.0, 0.0, 1.0])
    near = five - eye + 0.015 * aside / np.linalg.norm(aside)
    assert picked(where, "leg2/b4", eye, near) == RobotPart(PartKind.JOINT, "5", 1)
    thin = replace(where, geometry=replace(where.geometry, body_scale=0.5))
    assert picked(thin, "leg2/b4", eye, near) == B4
    arm = where.points[2][2] * [0.5, 0.5, 1.0]
    assert picked(where, "carriage", eye, arm - eye) == RobotPart(PartKind.BAR, "b1", 2)
    assert picked(where, "m2", eye, five - eye) == RobotPart(PartKind.MOTOR, "M2", 1)
    assert picked(where, "platform", eye, five - eye) is None
    assert picked(where, "leg2/b4", eye, np.full(3, np.nan)) is None


@pytest.mark.parametrize("drawing", [False, True])
def test_a_click_on_a_body_inspects_it_unless_clicks_add_waypoints(
    server: viser.ViserServer, drawing: bool
) -> None:
    state = points.set_drawing(initial_state(), drawing)
    clicks: list[Any] = []
    bodies = Bodies(SceneContext(server.scene, lambda _, action, **__: clicks.append(action)))
    bodies.draw(compute(state), dragging=False)
    where = compute(state).configuration
    between = (where.points[9][1] + where.points[5][1]) / 2
    eye = between + np.array([0.0, 0.0, 0.1])
    event = SimpleNamespace(ray_origin=eye, ray_direction=between - eye)
    with ThreadPoolExecutor(1) as thread:  # a browser of other tests keeps a loop in this one
        thread.submit(asyncio.run, bodies._clicked("leg2/b4", event)).result()
    assert clicks[0](state).inspected == (None if drawing else B4)
