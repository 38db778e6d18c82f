"""Pins: values are those of the rooms, margins those of the requirements, and few fit."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import paminsa_viz.explorer
from paminsa_viz.blocks.accuracy import drive_errors_table, tolerance_blocks
from paminsa_viz.blocks.kinds import Cell, Table
from paminsa_viz.blocks.stiffness import stiffness_blocks
from paminsa_viz.elastostatics import platform_stiffness
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.pins.tab import FOLLOWER, pin, pins_html
from paminsa_viz.explorer.features.pins.values import can_wait, find_values, wanted
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.pins import IMBALANCE, MOST_PINS, PinSettings, PinValue
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, InvalidInput, static_imbalance
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.manufacture import tolerance_errors
from paminsa_viz.progress import go_on
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirement, Requirements

POSE = (0.03, -0.02, 0.4, -0.55)
HEAVY = APPENDIX_4.vary({"links.b4": 3.0})


def pinned(*keys: str) -> State:
    state = actions.move_to(initial_state(), POSE)
    state = replace(state, document=replace(state.document, reference=HEAVY))
    for key in keys:
        state = pin(state, key)
    return state


def values(state: State) -> dict[str, PinValue]:
    job = wanted(compute(state))
    assert job is not None
    return dict(zip(job.keys, find_values(job, go_on), strict=True))


def test_values_are_those_of_the_rooms_for_the_design_and_the_reference() -> None:
    keys = ("condition", "tau_2", "stiffness_z", IMBALANCE, "links.b4")
    found = values(pinned(*keys))
    for which, design in (("value", APPENDIX_4), ("reference", HEAVY)):
        now = [getattr(found[key], which) for key in keys]
        expected = [
            float(measure_singularity(design.geometry, POSE).condition),
            float(static_torques(design, POSE)[1]),
            float(platform_stiffness(design, POSE).along(2)),
            static_imbalance(design),
            design.links.b4,
        ]
        assert now == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_every_quantity_has_a_value_or_a_reason() -> None:
    for key in QUANTITIES:
        (found,) = values(pinned(key)).values()
        assert math.isnan(found.value) == bool(found.reason), key


def test_margin_is_the_least_of_the_requirements_on_the_pose() -> None:
    state = pinned("condition", "f_4")
    value = values(state)["condition"].value
    bounds = (
        Requirement("condition", high=10.0),
        Requirement("condition", high=6.0),
        Requirement("condition", high=1.5, theta=(1.0, 2.0)),  # not of this heading
        Requirement("condition", high=1.6, z=(-0.9, -0.8)),  # not of this height
    )
    required = Requirements(bounds, theta=(-1.0, 1.0))
    found = values(actions.change_document(state, requirements=required))
    assert found["condition"].margin == pytest.approx(6.0 - value)
    assert found["condition"].bound == 6.0
    assert math.isnan(found["f_4"].margin)


def test_where_the_reference_cannot_be_only_its_value_is_missing() -> None:
    small = APPENDIX_4.vary({"geometry.coupler_length": 0.5})
    state = actions.move(pinned("condition"), x=0.33)
    state = replace(state, document=replace(state.document, reference=small))
    (found,) = values(state).values()
    assert np.isfinite(found.value)
    assert math.isnan(found.reference)


def test_pin_again_takes_it_off_and_no_more_than_fit_are_pinned() -> None:
    keys = list(QUANTITIES)[: MOST_PINS + 1]
    full = pinned(*keys[:-1])
    with pytest.raises(InvalidInput, match=str(MOST_PINS)):
        pin(full, keys[-1])
    less = pin(full, keys[2])
    assert pin(less, keys[-1]).pins.settings.keys == (*keys[:2], *keys[3:])
    assert wanted(compute(initial_state())) is None


@pytest.mark.parametrize(
    "keys", [("condition", "condition"), ("mood",), tuple(list(QUANTITIES)[: MOST_PINS + 1])]
)
def test_what_a_tab_may_not_give_back(keys: tuple[str, ...]) -> None:
    assert PinSettings(("condition", "links.b4", IMBALANCE)).possible
    assert not PinSettings(keys).possible


def test_row_says_value_reference_difference_and_margin_and_is_gray_until_found() -> None:
    state = pinned("condition", "geometry.base_radius")
    assert pins_html(compute(initial_state())) == ""
    assert "pv-stale" in pins_html(compute(state))
    required = Requirements((Requirement("condition", high=3.0),), theta=(-1.0, 1.0))
    state = actions.change_document(state, requirements=required)
    job = wanted(compute(state))
    state = FOLLOWER.deliver(state, solve(find_values, job))
    text = pins_html(compute(state))
    assert "pv-stale" not in text
    assert "margin" in text
    assert "<b>363.5</b> mm" not in text
    assert f"<b>{1e3 * APPENDIX_4.geometry.base_radius:.3g}</b> mm" in text
    assert "pv-stale" in pins_html(compute(actions.move(state, x=0.01)))


def test_only_what_is_quick_is_found_while_something_is_dragged() -> None:
    assert not can_wait(pinned("condition", "tau_1", "links.b4", IMBALANCE))
    assert can_wait(pinned("condition", "clearance"))


def test_numbers_that_can_be_clicked_are_numbers_that_can_be_pinned() -> None:
    folder = Path(paminsa_viz.explorer.__file__).parent
    texts = [file.read_text("utf-8") for file in folder.rglob("*.j2")]
    keys = {key for text in texts for key in re.findall(r'm\.pin\("([^"]+)",', text)}
    tables = stiffness_blocks(APPENDIX_4, platform_stiffness(APPENDIX_4, POSE))
    tables += tolerance_blocks(tolerance_errors(APPENDIX_4, POSE))
    found = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, POSE)
    tables.append(drive_errors_table(found))
    rows = [row for table in tables if isinstance(table, Table) for row in table.rows]
    told = {cell.quantity for row in rows for cell in row.cells if isinstance(cell, Cell)} - {""}
    assert {"M_p2", "condition"} <= keys
    assert {"stiffness_theta", "frequency_1", "error_x", "rms_tolerance_tilt"} <= told
    assert len(told) == 7 + 3 * 5 + 2 * 6
    keys |= told
    assert PinSettings(tuple(keys)[:MOST_PINS]).possible
    assert all(PinSettings((key,)).possible for key in keys)
