"""Every subject that has blocks: they are set as text and as a page, and its data is JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import paminsa_viz.blocks
from paminsa_viz.actuation import Duty, duty_cycle, select_drives
from paminsa_viz.actuation.ratios import catalog_ratios
from paminsa_viz.balancing import (
    SpringPlace,
    at_joint,
    balance,
    fit_springs,
    on_slider,
    spring_torques,
)
from paminsa_viz.balancing.tolerance import length_tolerance, mass_tolerance
from paminsa_viz.blocks import (
    accuracy,
    answer_checks,
    calibration,
    drives,
    evaluation,
    excitation,
    external_load,
    forces,
    identification,
    loads,
    maps,
    proofs,
    requirements,
    springs,
    stiffness,
    sweep,
    synthesis,
    tolerances,
    trajectory,
    verification,
    workspace,
)
from paminsa_viz.blocks import (
    balance as balance_words,
)
from paminsa_viz.blocks import (
    clearance as clearance_words,
)
from paminsa_viz.blocks import (
    design as design_words,
)
from paminsa_viz.blocks.data import plain
from paminsa_viz.blocks.kinds import Block, Note, Table
from paminsa_viz.clearance import clearance
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.engines.verification import verify
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.files.example_logs import given_log
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.identification import optimize_excitation
from paminsa_viz.identification.excitation import ExcitationLimits, ExcitationSettings
from paminsa_viz.identification.findings import investigate
from paminsa_viz.model import static_torques
from paminsa_viz.plots.map_values import map_data, workspace_field
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.calibration_plan import plan_calibration
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.error_rows import region_errors
from paminsa_viz.precision.manufacture import monte_carlo
from paminsa_viz.precision.measurements import simulated_measurements
from paminsa_viz.quantities import TORQUES
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.studies import DesignAxis, DesignGrid, Study, run_study
from paminsa_viz.studies.region import RegionResults, default_region
from paminsa_viz.synthesis import SynthesisResult, synthesize
from paminsa_viz.synthesis.proof.certificate import prove
from paminsa_viz.synthesis.proof.largest import largest_workspace
from paminsa_viz.synthesis.search.case_conflict import CaseConflict
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.trajectory import PRESET, analyze, simulate
from tests.blocks.test_setting import check_set
from tests.blocks.test_units import POSE, robot

Said = tuple[list[Block], Any]
"""The blocks of a subject, and its data for JSON; None where it has none."""


def _accuracy(_: Path) -> Said:
    design, _motion = robot()
    region = default_region(design)
    here, over = drive_errors(design.geometry, design.accuracy, POSE), RegionResults(design, region)
    drawn = monte_carlo(design, POSE, robots=20)
    blocks = accuracy.drive_blocks(here, over) + accuracy.manufacture_blocks(design, POSE, drawn)
    errors = region_errors(over.field, design.accuracy, over.reached)
    data = accuracy.accuracy_data(design, here, region, errors)
    return blocks, data | accuracy.manufacture_data(design, POSE, drawn)


def _balance(_: Path) -> Said:
    found = balance(robot()[0])
    return balance_words.optimum_blocks(found), balance_words.optimum_data(found)


def _calibration(_: Path) -> Said:
    design, _motion = robot()
    asked = plan_calibration(design, 30).measurements
    found = calibrate(design, simulated_measurements(design, asked), validate=0.2)
    return calibration.calibration_blocks(found), calibration.calibration_data(found, "log")


def _clearance(_: Path) -> Said:
    design, motion = robot()
    groups = clearance_words.by_group(design, np.array(POSE))
    here, over = clearance(design, POSE), clearance(design, motion.pose[::10])
    blocks = clearance_words.pose_blocks(design, groups, here) + clearance_words.region_blocks(over)
    return blocks, clearance_words.clearance_data(design, POSE, groups, here, over, 0.0)


def _design(_: Path) -> Said:
    design, _motion = robot()
    other = design.vary({"joints.j7": 1.0})
    blocks = [
        *design_words.design_blocks(design),
        design_words.values_table(design),
        *design_words.difference_blocks(design, other, ("one", "two")),
    ]
    data = [design_words.values_data(design), design_words.difference_data(design, other)]
    return blocks, data


def _drives(_: Path) -> Said:
    design, motion = robot()
    cycle, catalog = duty_cycle(design, [Duty(motion)]), generic_catalog()
    found = select_drives(cycle, catalog)
    advice = tuple(found.advice(j) for j in range(4))
    ratios = catalog_ratios(cycle, catalog)
    blocks = [
        *drives.drives_blocks(analyze(design, motion)),
        *drives.selection_blocks(design, found, 3, advice),
        drives.ratio_table(ratios),
    ]
    return blocks, [drives.selection_data(design, catalog, found, 3, advice), ratios]


def _evaluation(_: Path) -> Said:
    return [Note(evaluation.evaluation_text(Counter({"ok": 2, "folded:leg1": 1})))], None


def _excitation(_: Path) -> Said:
    design, _motion = robot()
    limits = ExcitationLimits(
        np.array([3.0] * 3 + [0.25]), np.array([20.0] * 3 + [1000.0]), 5.0, 0.01
    )
    settings = ExcitationSettings(evaluations=3, seconds=60.0, random=20)
    found = optimize_excitation(design, limits, settings)
    return excitation.excitation_blocks(found), excitation.excitation_data(design, found)


def _external_load(_: Path) -> Said:
    return list(external_load.load_notes(robot()[0], np.array(POSE))), None


def _forces(_: Path) -> Said:
    return forces.forces_blocks(robot()[0], np.array(POSE)), None


def _identification(_: Path) -> Said:
    log = given_log("example")
    found = investigate(log, robot()[0], other=given_log("example-other"))
    blocks = [
        block for block in identification.identification_blocks(found)
        if isinstance(block, (Note, Table))
    ]  # fmt: skip
    return blocks, identification.identification_data(found, [])


def _loads(_: Path) -> Said:
    design, motion = robot()
    rest, across = joint_forces(design, POSE), sideways_forces(design, POSE)
    moving = motion_loads(analyze(design, motion))
    assert moving is not None
    blocks = [*loads.pose_blocks(rest, across), *loads.motion_blocks(moving)]
    return blocks, [loads.pose_data(design, POSE, rest, across), loads.motion_data(moving)]


def _maps(_: Path) -> Said:
    design, _motion = robot()
    field = workspace_field(design.geometry, POSE[2], POSE[3], 20)
    data = map_data(field, design, POSE, TORQUES)
    facts = maps.maps_data(data, TORQUES, 10.0)
    return maps.maps_blocks(data, facts), facts


def asked_for() -> Requirements:
    place = Workspace(WorkspaceShape.CYLINDER, (0.1, 0.1, 0.1), (0.0, 0.0, -0.6))
    return Requirements((Requirement("condition", high=10.0),), (-0.1, 0.1), place)


def _proofs(_: Path) -> Said:
    design, asked = robot()[0], asked_for()
    proof = prove(design, asked, time_limit=5.0)
    largest = largest_workspace(design, asked, tolerance=0.02, time_limit=5.0)
    blocks = [*proofs.proof_blocks(asked, proof), *proofs.largest_blocks(asked, largest)]
    return blocks, [proofs.proof_data(proof), proofs.largest_data(design, largest)]


def _requirements(_: Path) -> Said:
    design, asked = robot()[0], asked_for()
    check = check_requirements(design, asked, fine=False)
    blocks = [*requirements.check_blocks(asked, check), requirements.quantities_table()]
    return blocks, [
        requirements.check_data(design, asked, check, None),
        requirements.quantities_data(),
    ]


def _springs(_: Path) -> Said:
    design, pose = robot()[0], np.array(POSE)
    fit = fit_springs(design, [SpringPlace(on_slider(0.1), at_joint(9))], pose[None])
    torque = static_torques(design, pose)
    held = torque + spring_torques(design, fit.springs, pose)
    return list(springs.springs_blocks(fit, torque, held)), None


def _stiffness(_: Path) -> Said:
    design, _motion = robot()
    found = platform_stiffness(design, POSE)
    blocks = stiffness.stiffness_blocks(design, found)
    return blocks, stiffness.stiffness_data(design, found, shear=False)


def _sweep(folder: Path) -> Said:
    design, motion = robot()
    axes = DesignGrid((DesignAxis("joints.j7", (0.1, 0.3)),))
    region = replace(default_region(design), theta=(0.0,))
    path = folder / "a.csv"
    found = run_study(Study(design, axes, region, False, motion, ()), path)
    return sweep.sweep_blocks(path, found, 1.0), sweep.sweep_data(path, found, 1.0)


@cache
def found_robot() -> SynthesisResult:
    """Found by a short search."""
    case = load_case(EXAMPLES["cylinder"], allow_overlap=True)
    return synthesize(replace(case, effort=replace(case.effort, generations=2, population=4)))


def _synthesis(_: Path) -> Said:
    found = found_robot()
    return synthesis.synthesis_blocks(found), synthesis.synthesis_data(found, 1.0)


def _answer_checks(_: Path) -> Said:
    found = found_robot()
    conflict = CaseConflict(found.case.requirements.bounds, True, 3, False)
    checks = answer_checks.AnswerChecks(None, None, "it is not installed", conflict)
    return answer_checks.answer_blocks(found, checks), answer_checks.checks_data(found, checks)


def _tolerances(_: Path) -> Said:
    design, pose = robot()[0], np.array(POSE)
    masses = mass_tolerance(design, 0.02, pose)
    lengths = length_tolerance(design, 0.01, pose[None], samples=5)
    blocks = [
        *tolerances.mass_tolerance_blocks(masses), *tolerances.length_tolerance_blocks(lengths),
    ]  # fmt: skip
    return blocks, None


def _trajectory(_: Path) -> Said:
    design, motion = robot()
    analysis, run = analyze(design, motion), simulate(design, motion)
    table = PublishedTorques("other", motion.t[::9], analysis.torque[::9] + 0.1)
    blocks = [
        *trajectory.trajectory_blocks(analysis),
        trajectory.reference_note(analysis),
        *trajectory.published_notes(analysis, table),
        *trajectory.simulation_notes(run),
    ]
    data = [
        trajectory.trajectory_data(analysis),
        trajectory.compared_data(analysis),
        trajectory.published_differences(analysis, table),
        trajectory.simulation_data(run),
    ]
    return blocks, data


def _verification(_: Path) -> Said:
    design, _motion = robot()
    motion = PRESET["arch"].build(design.geometry).lasting(0.3).sample(50)
    found = verify(replace(design, drives=(None,) * 4), motion, poses=5)
    blocks = [
        block for block in verification.verification_blocks(found)
        if isinstance(block, (Note, Table))
    ]  # fmt: skip
    return blocks, verification.verification_data(found)


def _workspace(_: Path) -> Said:
    return workspace.workspace_blocks(robot()[0], POSE[2]), None


SUBJECTS: dict[str, Callable[[Path], Said]] = {
    name.removeprefix("_"): found
    for name, found in dict(globals()).items()
    if name.startswith("_") and getattr(found, "__module__", "") == __name__
}


def test_every_file_of_words_is_a_subject_here() -> None:
    files = {path.stem for path in Path(paminsa_viz.blocks.__path__[0]).glob("*.py")}
    assert files - {"__init__", "kinds", "data"} == SUBJECTS.keys()


@pytest.mark.slow
@pytest.mark.usefixtures("mujoco", "built_in_few_rounds")
@pytest.mark.parametrize("subject", SUBJECTS)
def test_blocks_are_set_and_data_is_json(subject: str, tmp_path: Path, capsys: Any) -> None:
    blocks, data = SUBJECTS[subject](tmp_path)
    assert blocks
    check_set(blocks, capsys)
    if data is not None:
        text = json.dumps(plain(data), allow_nan=False)
        assert len(text) > 100
        sets = data if isinstance(data, (list, tuple)) else [data]
        named = [one for one in sets if "design" in one and isinstance(one["design"], str)]
        assert all(one["knee"] == "lower" for one in named)
        nameless = {"answer_checks", "design", "evaluation", "synthesis"}
        assert named or subject in nameless, "which robot is it?"
