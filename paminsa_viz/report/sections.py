"""The sections of a report: a subject's blocks, or nothing where there is nothing to say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from paminsa_viz.blocks.accuracy import drive_blocks, manufacture_blocks
from paminsa_viz.blocks.balance import balance_blocks
from paminsa_viz.blocks.calibration import calibration_blocks
from paminsa_viz.blocks.clearance import by_group, pose_blocks, region_blocks
from paminsa_viz.blocks.drives import drives_blocks
from paminsa_viz.blocks.forces import forces_blocks
from paminsa_viz.blocks.identification import identification_blocks
from paminsa_viz.blocks.kinds import Block, Note
from paminsa_viz.blocks.loads import loads_blocks
from paminsa_viz.blocks.requirements import requirements_blocks
from paminsa_viz.blocks.stiffness import robot_blocks
from paminsa_viz.blocks.synthesis import synthesis_blocks
from paminsa_viz.blocks.trajectory import motion_figures, reference_note, trajectory_blocks
from paminsa_viz.blocks.verification import verification_blocks
from paminsa_viz.clearance import clearance
from paminsa_viz.engines.verification import Verification, verify
from paminsa_viz.errors import PaminsaError
from paminsa_viz.identification.findings import Findings
from paminsa_viz.model.design import Design
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.measurements import Measurements
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.studies.region import RegionResults, default_region
from paminsa_viz.synthesis import SynthesisResult
from paminsa_viz.trajectory import TrajectoryAnalysis


def requirements_section(design: Design, requirements: Requirements) -> Section:
    """Return which requirements hold, where all do, and the largest proven workspace."""
    return _section("requirements", "Requirements", requirements_blocks(design, requirements))


def synthesis_section(result: SynthesisResult) -> Section:
    """Return what a search found."""
    return _section("synthesis", "Synthesis", synthesis_blocks(result))


def forces_section(request: ReportRequest) -> Section:
    """Return the load and the capability at the report's pose."""
    blocks = forces_blocks(request.design, np.array(request.pose))
    return _section("forces", "Forces and capability", blocks)


def stiffness_section(request: ReportRequest) -> Section:
    """Return the stiffness at the report's pose and over the workspace."""
    return _section("stiffness", "Stiffness", robot_blocks(request.design, np.array(request.pose)))


def accuracy_section(request: ReportRequest) -> Section:
    """Return the errors of the pose by the drives and by manufacture."""
    design, pose = request.design, request.pose
    here = drive_errors(design.geometry, design.accuracy, pose)
    over = RegionResults(design, default_region(design))
    blocks = [*drive_blocks(here, over), *manufacture_blocks(design, pose)]
    return _section("accuracy", "Accuracy", blocks)


def trajectory_section(
    analysis: TrajectoryAnalysis, reference: TrajectoryAnalysis | None = None
) -> Section:
    """Return the motion, whether it can be run, and its torques next to those of a reference."""
    blocks = [
        *trajectory_blocks(analysis, {"reference": reference}),
        *([] if reference is None else [reference_note(reference)]),
        *motion_figures(analysis, reference),
    ]
    return _section("trajectory", "Trajectory", blocks)


def drives_section(analysis: TrajectoryAnalysis) -> Section:
    """Return the design's drives on the motion; without blocks for a design that has none."""
    return _section("drives", "Drives", drives_blocks(analysis))


def loads_section(analysis: TrajectoryAnalysis, pose: Sequence[float]) -> Section:
    """Return the forces at the joints and the loads of the bars."""
    return _section("loads", "Joint forces and bar loads", loads_blocks(analysis, pose))


def clearance_section(analysis: TrajectoryAnalysis, pose: Sequence[float]) -> Section:
    """Return the nearest bodies at a pose (4,) and along the motion."""
    design, here = analysis.design, np.array(pose)
    along = clearance(design, analysis.trajectory.pose)
    blocks = [
        *pose_blocks(design, by_group(design, here), clearance(design, here)),
        *region_blocks(along, what="samples of the trajectory"),
    ]
    return _section("clearance", "Clearance", blocks)


def calibration_section(design: Design, measured: Measurements) -> Section:
    """Return what measured poses of the built robot say of its legs' lengths."""
    return _section("calibration", "Calibration", calibration_blocks(calibrate(design, measured)))


def identification_section(findings: Findings) -> Section:
    """Return what a log of the built robot says."""
    return _section("identification", "Identification", identification_blocks(findings))


def balance_section(analysis: TrajectoryAnalysis) -> Section:
    """Return M_p2, and the effect of the paper's balance."""
    return _section("balance", "Static balance", balance_blocks(analysis))


def verification_section(found: Verification | str) -> Section:
    """Return the comparison with physics engines, or why there is none."""
    blocks = [Note(found, "warn")] if isinstance(found, str) else verification_blocks(found)
    return _section("verification", "Verification", blocks)


def checked(request: ReportRequest) -> Verification | str:
    """Return the verification of the request's robot and motion, or why there is none."""
    if not request.verified:
        return "Not requested."
    try:
        return verify(request.design, request.trajectory, seed=request.seed)
    except PaminsaError as error:  # an engine is missing, or the motion cannot be run
        return f"Not verified: {error}."


def _section(key: str, title: str, blocks: Sequence[Block]) -> Section:
    return Section(key, title, tuple(blocks))
