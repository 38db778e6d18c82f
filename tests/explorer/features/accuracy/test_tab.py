"""The tab of accuracy: what it says at a pose, its numbers, and the maps that it shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions, persistence, tab_store
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.history import Snapshot
from paminsa_viz.explorer.features.accuracy import tab as panel
from paminsa_viz.explorer.features.accuracy import worst
from paminsa_viz.explorer.features.accuracy.layers import shown_errors
from paminsa_viz.explorer.features.accuracy.manufacture import MANUFACTURE
from paminsa_viz.explorer.features.requirements import actions as requirements
from paminsa_viz.explorer.kit.entries import ButtonGroup, Folder, given
from paminsa_viz.explorer.kit.inputs import Number, Slider
from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, Drive, DriveAccuracy, InvalidInput, singular_rotation
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.progress import go_on
from paminsa_viz.units import ARCSEC, format_pose, number

NEAR_FOLD = singular_rotation(APPENDIX_4.geometry) - 0.01


def group(key: str, state: State) -> dict:
    """The buttons of a row by their texts."""
    inner = [
        e for entry in panel.DRIVES_ACCURACY if isinstance(entry, Folder) for e in entry.entries
    ]
    row = next(entry for entry in (*panel.DRIVES_ACCURACY, *inner) if entry.key == key)
    assert isinstance(row, ButtonGroup)
    return dict(given(row.choices, state))


def test_errors_of_the_pose_are_listed_in_their_units() -> None:
    state = actions.move(initial_state(), x=0.05, theta=0.4)
    frame = compute(state)
    found, text = shown_errors(frame), panel.pose_html(frame)
    assert f">{number(1e6 * float(found.worst[0]), 3)}</button></b>" in text
    assert number(ARCSEC * float(found.linear[2]), 3) in text
    assert number(1e6 * float(found.rms_horizontal), 3) in text
    assert "0.005°" in text
    assert "No bound" not in text


def test_no_bound_has_its_reason_and_keeps_the_linear_estimate() -> None:
    state = actions.move(initial_state(), theta=NEAR_FOLD, z=-0.3)
    frame = compute(state)
    text = panel.pose_html(frame)
    assert "No bound" in text
    assert "cannot be assembled" in text
    assert number(ARCSEC * float(shown_errors(frame).linear[2]), 3) in text


def test_sliders_set_the_designs_accuracy_which_is_saved_and_shared() -> None:
    folder = next(entry for entry in panel.DRIVES_ACCURACY if isinstance(entry, Folder))
    sliders = {entry.key: entry for entry in folder.entries if isinstance(entry, Slider)}
    assert len(sliders) == 6
    state = initial_state()
    for key, shown in (("accuracy.backlash_linear", 2.5), ("accuracy.control_rotary", 0.003)):
        state = sliders[key].apply(state, sliders[key].parse(state, shown))
        assert sliders[key].shown(state) == shown
    design = state.document.design
    assert design.accuracy.backlash_linear == 2.5e-6
    assert design.accuracy.control_rotary == pytest.approx(np.radians(0.003))
    assert persistence.load(persistence.dump(state.document)).design == design
    again = group("accuracy.reset", state)["Default"](state)
    assert again.document.design == APPENDIX_4


@pytest.mark.parametrize("value", [-1.0, 1e9])
def test_refusals_have_the_pages_names_and_units(value: float) -> None:
    folders = [e for e in (*panel.DRIVES_ACCURACY, *MANUFACTURE) if isinstance(e, Folder)]
    sliders = [e for folder in folders for e in folder.entries if isinstance(e, Slider)]
    assert len(sliders) == 17
    for row in sliders:
        name, _, unit = str(row.label).rpartition(" ")
        with pytest.raises(InvalidInput) as refused:
            row.apply(initial_state(), row.parse(initial_state(), value))
        assert refused.value.argument == f"{name} = {row.unit.format(row.unit.to_si(value))}"
        assert refused.value.problem.endswith(f"is needed {unit}")


def test_encoders_of_the_drives_are_offered() -> None:
    state = initial_state()
    assert group("accuracy.reset", state) == {}
    drive = Drive(encoder_counts=5000, gear_ratio=20)
    state = actions.load_design(state, replace(APPENDIX_4, drives=(drive, None, None, None)))
    taken = group("accuracy.reset", state)["Drives’ encoders"](state).document.design.accuracy
    assert taken.resolution_rotary == pytest.approx(2 * np.pi / 1e5)
    assert taken.resolution_linear == DriveAccuracy().resolution_linear


def test_buttons_show_the_errors_on_the_single_map() -> None:
    for label, effect in group("accuracy.map", initial_state()).items():
        assert effect(initial_state()).map_view.quantity == panel.MAPS[label]


def test_encoder_is_given_by_its_bits_and_the_gear_behind_it() -> None:
    entries = panel.DRIVES_ACCURACY[-1]
    assert isinstance(entries, Folder)
    bits, gear = (
        next(entry for entry in entries.entries if entry.key == f"encoder.{name}")
        for name in ("bits", "gear")
    )
    assert isinstance(bits, Number)
    assert isinstance(gear, Number)
    state = bits.apply(initial_state(), 12.0)
    assert state.document.design.accuracy.resolution_rotary == pytest.approx(2 * np.pi / 4096)
    worst = shown_errors(compute(state)).worst
    direct, state = state, gear.apply(state, 50.0)
    undone = Snapshot.of(direct).restored(state)
    assert (gear.read(undone), bits.read(undone)) == (1, bits.read(direct))
    assert bits.read(state) == pytest.approx(12.0)
    assert state.document.design.accuracy.resolution_rotary == pytest.approx(np.pi / 2048 / 50)
    assert (shown_errors(compute(state)).worst < worst)[:3].all()  # M4 has its own
    state = actions.vary(state, {"accuracy.resolution_rotary": np.pi / 2**9 / 50})
    assert bits.read(state) == pytest.approx(10.0)  # the count is what counts
    kept = tab_store.restore(initial_state(), tab_store.dump(state))
    assert gear.read(kept) == 50
    assert bits.read(kept) == pytest.approx(10.0)
    exact = actions.vary(state, {"accuracy.resolution_rotary": 0.0})  # as many bits as you like
    assert bits.read(exact) == np.inf
    assert bits.places(exact) == bits.places(state)


def test_largest_errors_over_the_workspace_are_those_of_poses_in_it() -> None:
    state = requirements.change(initial_state(), theta=(-0.5, 0.5))
    job = worst.WORST.job(state)
    found = worst.find_worst(job, go_on)
    state = worst.WORST.place.write(state, TaskState(outcome=Outcome(job, result=found)))
    x, y, z = (np.linspace(-0.5, 0.5, 7) * size for size in job.workspace.size)
    grid = np.stack(np.meshgrid(x, y, [-0.5, 0.0, 0.5], z, indexing="ij"), axis=-1).reshape(-1, 4)
    grid = grid[np.hypot(grid[:, 0], grid[:, 1]) < job.workspace.size[0] / 2]
    grid[:, 3] += job.workspace.center[2]
    errors = drive_errors(job.geometry, job.accuracy, grid)
    assert errors.ok.all()
    for index, largest in enumerate((errors.horizontal, errors.worst[:, 3], errors.worst[:, 2])):
        assert largest.max() <= found[index].value * (1 + 1e-9)
        there = worst.go_to_worst(state, index)
        here = drive_errors(job.geometry, job.accuracy, there.document.pose)
        value = (here.horizontal, here.worst[3], here.worst[2])[index]
        assert value == pytest.approx(found[index].value, rel=1e-7)  # the pose is rounded
    assert worst.go_to_worst(state, 3) == state
    text = worst.worst_html(compute(state))
    assert "headings" in text
    for item in found:
        assert item.pose is not None
        assert format_pose(item.pose) in text
