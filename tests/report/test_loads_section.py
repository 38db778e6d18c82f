"""Joint forces in the report."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.blocks.kinds import Figure, Note, Table, shown
from paminsa_viz.elastostatics.bar_loads import all_bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.report.sections import loads_section
from paminsa_viz.trajectory import PRESET, analyze

POSE = (0.05, 0.0, 0.2, -0.5)
MOTION = PRESET["arch"].build(APPENDIX_4.geometry).sample(100)


def test_tables_hold_the_pose_and_the_motion() -> None:
    analysis = analyze(APPENDIX_4, MOTION)
    found = loads_section(analysis, POSE)
    at_rest, across, bars_at_rest, joints, bars = (b for b in found.blocks if isinstance(b, Table))
    forces, loads = joint_forces(APPENDIX_4, POSE), motion_loads(analysis)
    assert loads is not None
    nine = JOINT_INDEX["9"]
    assert at_rest.head[:7] == ("Joint", "On", "From", "r₁ [N]", "t₁ [N]", "z₁ [N]", "M₁ [N·m]")
    assert across.head[:3] == ("Joint", "M_r1 [N·m]", "M_z1 [N·m]")  # set as all symbols
    sideways = sideways_forces(APPENDIX_4, POSE).force
    numbers = (forces.of("9")[0, 0], sideways[0, nine], forces.of("9")[0, 2])
    assert at_rest.rows[nine].cells[3:7] == (*(shown(value, "N") for value in numbers), "")
    taken = float(forces.moment[2, JOINT_INDEX["2"]])
    assert at_rest.rows[JOINT_INDEX["2"]].cells[14] == shown(taken, "N m")
    inner = all_bar_loads(forces)["b4"].extremes()
    assert bars_at_rest.rows[BARS.index("b4")].cells[7] == shown(inner[1, 2], "N m")
    assert joints.rows[8].cells[5:7] == (
        shown(loads.peak[1, 8], "N"),
        shown(loads.peak_time[1, 8], "s"),
    )
    assert bars.rows[0].cells[3] == shown(loads.bar_peak[0, 0, 2], "N m")
    assert sum(isinstance(block, Figure) for block in found.blocks) == 1


def test_reasons_stand_in_place_of_numbers() -> None:
    far = replace(MOTION, pose=MOTION.pose + 3.0)
    singular = (0.0, 0.0, singular_rotation(APPENDIX_4.geometry), -0.5)
    found = loads_section(analyze(APPENDIX_4, far), singular)
    assert not any(isinstance(block, Table) for block in found.blocks)
    bad = [block.text for block in found.blocks if isinstance(block, Note) and block.kind == "bad"]
    assert len(bad) == 2
