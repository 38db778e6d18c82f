"""Cells of blocks are the results, to the digits that are printed, for random robots and poses."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.blocks.balance import balance_blocks
from paminsa_viz.blocks.design import difference_blocks, values_table
from paminsa_viz.blocks.excitation import limits_table
from paminsa_viz.blocks.kinds import Note, Row, Table
from paminsa_viz.blocks.loads import motion_blocks, pose_blocks
from paminsa_viz.blocks.maps import maps_blocks, maps_data
from paminsa_viz.blocks.requirements import check_blocks
from paminsa_viz.blocks.stiffness import stiffness_blocks
from paminsa_viz.blocks.sweep import sweep_blocks
from paminsa_viz.blocks.trajectory import LOADS, published_notes, trajectory_blocks
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.files.design_schema import KEYS
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.identification.excitation import Excitation, KeptLimit
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.statics import imbalance_parts, static_imbalance, static_torques
from paminsa_viz.plots.map_values import map_data, workspace_field
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.studies import DesignAxis, DesignGrid, Study, processes, run_study
from paminsa_viz.studies.region import default_region
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.grid import Resolution
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.trajectory import PRESET, analyze
from tests.blocks.test_units import NUMBER, value
from tests.support.samples import random_design, random_poses

TO_SI = {
    "mm": 1e-3, "µm": 1e-6, "°": np.pi / 180, "°/s": np.pi / 180, "N/mm": 1e3, "MPa": 1e6,
    "mm²": 1e-6, "mm⁴": 1e-12, "″": np.pi / 180 / 3600,
}  # fmt: skip
"""Factors of the units that are not SI's."""

SEEDS = range(4)


def is_printed(cell: str, result: float) -> bool:
    """Say whether a cell holds a result to its digits, in the unit that it names."""
    found = NUMBER.search(cell)
    assert found is not None, cell
    shown, off = value(found["number"])
    factor = TO_SI.get((found["unit"] or "").strip(), 1.0)
    return abs(shown * factor - result) <= 1.001 * off * factor + 1e-12


def tables(blocks: list) -> list[Table]:
    return [block for block in blocks if isinstance(block, Table)]


def robot(seed: int) -> tuple[Design, np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    return design, random_poses(rng, design, 1)[0], rng


@pytest.mark.parametrize("seed", SEEDS)
def test_required_torques_on_a_motion_and_their_distance_from_published_ones(seed: int) -> None:
    design, _, rng = robot(seed)
    analysis = analyze(design, PRESET["arch"].build(design.geometry).sample(50))
    if not analysis.summary:  # it cannot begin this motion
        assert tables(trajectory_blocks(analysis)) == []
        return
    (loads,) = tables(trajectory_blocks(analysis))[-1:]
    for row, summary in zip(loads.rows, analysis.summary, strict=True):
        for cell, (name, *_) in zip(row.cells[1:], LOADS, strict=True):
            assert is_printed(cell, getattr(summary, name)), (row.cells[0], name)
    t = analysis.trajectory.t[::7]
    off = rng.uniform(-1.0, 1.0, (t.size, 4))
    table = PublishedTorques("other", t, analysis.torque[::7] - off)
    for j, note in enumerate(published_notes(analysis, table)):
        largest, rms = (text.split(" ", 1)[-1] for text in note.text.split(": ")[1].split(", ")[:2])
        assert is_printed(largest, float(np.abs(off[:, j]).max()))
        assert is_printed(rms, float(np.sqrt(np.mean(off[:, j] ** 2))))


@pytest.mark.parametrize("seed", SEEDS)
def test_parts_of_the_imbalance_add_up_to_their_total(seed: int) -> None:
    design, _, _ = robot(seed)
    parts = tables(
        balance_blocks(analyze(design, PRESET["arch"].build(design.geometry).sample(20)))
    )[0]
    *bodies, total = parts.rows
    assert is_printed(total.cells[2], static_imbalance(design))
    found = sorted(imbalance_parts(design).values())
    shown = sorted((row.cells[2] for row in bodies), key=lambda cell: value(cell.split()[0])[0])
    known = [part for part in found if part != 0.0]
    assert all(is_printed(*pair) for pair in zip(shown, known, strict=True))


@pytest.mark.parametrize("seed", SEEDS)
def test_maps_hold_the_torques_of_their_cells(seed: int) -> None:
    design, pose, _ = robot(seed)
    keys = ("tau_1", "tau_2", "tau_3")
    field = workspace_field(design.geometry, pose[2], pose[3], 24, 0.3)
    data = map_data(field, design, pose, keys)
    facts = maps_data(data, keys, 1e300)
    (table,) = tables(maps_blocks(data, facts))
    x, y = np.meshgrid(data.x, data.y)
    poses = np.stack([x, y, np.full_like(x, pose[2]), np.full_like(x, pose[3])], axis=-1)
    torque = static_torques(design, poses)[..., :3]
    kept = np.isfinite(data.values[0])
    assert facts["counting_cells"] <= kept.sum()
    for row, values in zip(table.rows, np.moveaxis(torque, -1, 0), strict=True):
        within = np.abs(values[kept]).max() * 1.001
        assert all(abs(value(cell)[0]) <= within for cell in row.cells[1:])
    if facts["counting_cells"] == kept.sum():
        for row, values in zip(table.rows, np.moveaxis(torque, -1, 0), strict=True):
            assert is_printed(row.cells[1], float(values[kept].min()))
            assert is_printed(row.cells[3], float(np.median(np.abs(values[kept]))))
    for count, words in ((1, "the 1 cell that counts:"), (12345, "the 12,345 cells that count:")):
        said = maps_blocks(data, {**facts, "counting_cells": count})
        assert any(isinstance(one, Note) and words in one.text for one in said)


@pytest.mark.parametrize("seed", SEEDS)
def test_values_of_a_design_and_their_changes(seed: int) -> None:
    design, _, _ = robot(seed)
    rows = {row.cells[:2]: row.cells[2] for row in values_table(design).rows}
    for key in KEYS:
        shown = rows[key.table, key.name]
        result = design.value(key.parameter.path)
        assert (
            shown == "rigid"
            if np.isinf(result)
            else float(shown) == pytest.approx(result, rel=1e-9)
        )
    path = "joints.j7"
    other = design.vary({path: 1.25 * design.value(path)})
    (table,) = difference_blocks(design, other, ("a", "b"))
    assert isinstance(table, Table)
    (row,) = table.rows
    assert row.cells[:2] == ("joints", "j7_kg")
    assert row.cells[4] == "+25.0 %"


@pytest.mark.parametrize("seed", SEEDS)
def test_forces_and_stiffness_at_a_pose(seed: int) -> None:
    design, pose, _ = robot(seed)
    forces, sideways = joint_forces(design, pose), sideways_forces(design, pose)
    plane, across, *_ = tables(pose_blocks(forces, sideways))
    for index, (one, other) in enumerate(zip(plane.rows, across.rows, strict=True)):
        for leg in range(3):
            r, t, z, moment = one.cells[3 + 4 * leg : 7 + 4 * leg]
            assert is_printed(r, float(forces.force[leg, index, 0]))
            assert is_printed(t, float(sideways.force[leg, index]))
            assert is_printed(z, float(forces.force[leg, index, 2]))
            taken = float(forces.moment[leg, index])
            assert is_printed(moment, taken) if moment else taken == 0.0
            for cell, result in zip(
                other.cells[1 + 2 * leg : 3 + 2 * leg], sideways.moment[leg, index], strict=True
            ):
                assert is_printed(cell, float(result))
    found = platform_stiffness(design, pose)
    if not found.ok:
        return
    first, *rest = tables(stiffness_blocks(design, found))
    for axis in range(6):
        label, cell, *_ = first.rows[axis].cells
        assert is_printed(f"{cell} {label.partition('[')[2]}", float(found.along(axis)))
    modes = robot_modes(design, pose, 6)
    if modes.ok:
        assert all(
            is_printed(row.cells[1], float(frequency))
            for row, frequency in zip(rest[-1].rows, modes.frequencies, strict=True)
        )


def test_bearing_loads_of_a_motion() -> None:
    design, _, _ = robot(0)
    loads = motion_loads(analyze(design, PRESET["arch"].build(design.geometry).sample(50)))
    assert loads is not None
    joints, _ = tables(motion_blocks(loads))
    for index, row in enumerate(joints.rows):
        for leg in range(3):
            peak, at, rms, equivalent = row.cells[1 + 4 * leg : 5 + 4 * leg]
            assert is_printed(peak, float(loads.peak[leg, index]))
            assert is_printed(at, float(loads.peak_time[leg, index]))
            assert is_printed(rms, float(loads.rms[leg, index]))
            assert is_printed(equivalent, float(loads.equivalent[leg, index]))


def test_volume_with_its_error_in_cubic_decimeters() -> None:
    asked = Requirements((Requirement("condition", high=8.0),), (-0.1, 0.1))
    volume = solve_volume(APPENDIX_4, asked, resolution=Resolution(2000, 3, 1.0))
    found = check_requirements(APPENDIX_4, asked, fine=False, volume=volume)
    text = " ".join(block.text for block in check_blocks(asked, found) if isinstance(block, Note))
    shown = re.search(r"([\d.]+) ± ([\d.]+) dm³, [\d.]+ % of ([\d.]+) dm³", text)
    assert shown is not None
    for one, result in zip(
        shown.groups(), (volume.volume, volume.error, volume.reachable_volume), strict=True
    ):
        assert is_printed(one, 1e3 * result)


def test_limits_of_an_excitation_by_their_shares() -> None:
    """A least limit is used by what is required over what there is."""
    limits = (
        KeptLimit("speed of M1", 1.2345, 3.0, "rad/s", 0.5, False),
        KeptLimit("margin", 0.02, 0.01, "m", 1.0, True),
        KeptLimit("torque of M2", 25.0, 20.0, "N m", 0.25, False),
    )
    found = Excitation.__new__(Excitation)
    object.__setattr__(found, "limits", limits)
    assert limits_table(found).literal
    rows: tuple[Row, ...] = limits_table(found).rows
    assert [row.cells[4] for row in rows] == ["41 %", "50 %", "125 %"]
    assert [row.kind for row in rows] == ["plain", "plain", "marked"]
    assert all(is_printed(row.cells[1], one.value) for row, one in zip(rows, limits, strict=True))
    assert [row.cells[2][0] for row in rows] == ["≤", "≥", "≤"]


def test_extremes_of_a_sweep_and_the_rows_they_are_in(tmp_path: Path) -> None:
    design, _, _ = robot(1)
    region = replace(default_region(design), theta=(0.0,))
    masses = (0.3, 0.1, 0.2)
    study = Study(design, DesignGrid((DesignAxis("joints.j7", masses),)), region, False, None, ())
    with processes(1) as workers:
        summary = run_study(study, tmp_path / "out.csv", workers)
    table = tables(sweep_blocks(tmp_path / "out.csv", summary, 1.0))[0]
    (row,) = [row for row in table.rows if row.cells[0] == "Mp2_N"]
    found = [static_imbalance(design.vary({"joints.j7": mass})) for mass in masses]
    assert (int(row.cells[2]), int(row.cells[4])) == (int(np.argmin(found)), int(np.argmax(found)))
    assert is_printed(row.cells[1], min(found))
    assert is_printed(row.cells[3], max(found))
