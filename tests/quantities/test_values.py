"""Every quantity against the function that it comes from, at the poses of a grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.actuation.wrench_capability import capability
from paminsa_viz.clearance import PairGroup, clearance, group_clearance
from paminsa_viz.elastostatics import first_frequencies, platform_stiffness
from paminsa_viz.elastostatics.bar_loads import bar_loads, bar_stress
from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.joint_forces import JOINTS, joint_forces
from paminsa_viz.elastostatics.stiffness import load_wrench
from paminsa_viz.model import APPENDIX_4, check_reach, measure_singularity, solve_field
from paminsa_viz.model.design import Counterweight
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.grids import Grid
from paminsa_viz.precision import drive_errors
from paminsa_viz.precision.manufacture import tolerance_errors
from paminsa_viz.quantities import QUANTITIES, affordable_cells
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.requirement_text import LONGEST, parse_requirement

DESIGN = replace(
    APPENDIX_4.vary({"payload.mass": 2.0, "load.force_x": 7.0, "load.force_y": -11.0,
                     "load.moment_x": 0.4, "load.moment_y": 0.9, "load.moment_z": 1.3,
                     "load.point_x": 0.02}),
    counterweights=(Counterweight("b3", 4, 0.5, 0.05),),
)  # fmt: skip
FIELD = solve_field(
    DESIGN.geometry, Grid.over((0.0, 0.0, 0.2, -0.5), x=[-0.1, 0.03, 0.7], y=[-0.05, 0.08])
)  # one x is out of reach


def expected() -> dict[str, np.ndarray]:
    """Values by key, of every quantity but static torques and deviations."""
    pose = FIELD.grid.poses()
    singular, found = measure_singularity(DESIGN.geometry, pose), {}
    found["condition"], found["determinant"] = singular.condition, singular.determinant
    found["conditioning"] = 1.0 / singular.condition
    found["reach_margin"] = check_reach(DESIGN.geometry, pose).margins.min(axis=(-1, -2))
    stiff = platform_stiffness(DESIGN, pose)
    compliance = np.linalg.inv(stiff.matrix)
    for key, axis in (("x", 0), ("y", 1), ("z", 2), ("theta", 5)):
        found[f"stiffness_{key}"] = 1.0 / compliance[..., axis, axis]
    for key, part in (("tilt", slice(3, 5)), ("horizontal", slice(0, 2))):
        found[f"stiffness_{key}"] = 1.0 / np.linalg.eigvalsh(compliance[..., part, part])[..., -1]
    moved = np.einsum("...ij,...j->...i", compliance, load_wrench(DESIGN, pose))
    found["deflection"] = np.linalg.norm(moved[..., :3], axis=-1)
    found["deflection_tilt"] = np.hypot(moved[..., 3], moved[..., 4])
    found["frequency_1"] = first_frequencies(DESIGN, pose)
    found["frequency_drives"] = drive_modes(DESIGN, pose).frequencies.min(axis=-1)
    found["clearance"] = clearance(DESIGN, pose).least
    names = {
        "legs": PairGroup.BETWEEN_LEGS, "same_leg": PairGroup.SAME_LEG,
        "arms": PairGroup.CARRIAGE, "platform": PairGroup.PLATFORM, "frame": PairGroup.FRAME,
        "payload": PairGroup.PAYLOAD, "counterweights": PairGroup.COUNTERWEIGHTS,
    }  # fmt: skip
    for key, group in names.items():
        found[f"clearance_{key}"] = group_clearance(DESIGN, pose, [group])[..., 0]
    forces = joint_forces(DESIGN, pose)
    plane = np.hypot(forces.force[..., 0], forces.force[..., 2])
    plane[..., -1] = np.hypot(plane[..., -1], forces.force[..., -1, 1])  # joint 5, in space
    keys = {"m": "force_m", "guide": "guide_force"}
    for index, joint in enumerate(JOINTS):
        found[keys.get(joint.key, f"force_{joint.key}")] = plane[..., index].max(axis=-1)
    found["joint_force"] = plane.max(axis=(-1, -2))
    for key, joint in (("bearing_moment", "m"), ("arm_moment", "2")):
        index = [one.key for one in JOINTS].index(joint)
        found[key] = np.abs(forces.moment[..., index]).max(axis=-1)
    inner = {bar: bar_loads(forces, bar) for bar in BARS}
    most = np.stack([np.abs(one.largest((0, 2))[0]) for one in inner.values()]).max(axis=(0, -2))
    found["bar_axial"], found["bar_moment"] = np.moveaxis(most, -1, 0)
    use = [bar_stress(forces, one) for one in inner.values()]
    found["utilization"] = np.stack(use).max(axis=(0, -1)) / DESIGN.elastic.yield_stress
    able = capability(DESIGN, pose)
    for key in ("payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
                "acceleration", "turn_acceleration"):  # fmt: skip
        found[key] = getattr(able, key)
    drives, lengths = (
        drive_errors(DESIGN.geometry, DESIGN.accuracy, pose),
        tolerance_errors(DESIGN, pose),
    )
    for place, index in (("x", 0), ("y", 1), ("z", 3), ("theta", 2)):
        found[f"error_{place}"] = drives.worst[..., index]
        found[f"linear_error_{place}"] = drives.linear[..., index]
        found[f"rms_error_{place}"] = drives.rms[..., index]
        found[f"tolerance_{place}"] = lengths.worst[..., index]
        found[f"rms_tolerance_{place}"] = lengths.rms[..., index]
    found["error_horizontal"] = drives.horizontal
    found["linear_error_horizontal"] = drives.linear_horizontal
    found["rms_error_horizontal"] = drives.rms_horizontal
    for kind, prefix in (("tolerance", ""), ("rms_tolerance", "rms_")):
        for part in ("horizontal", "tilt"):
            found[f"{kind}_{part}"] = getattr(lengths, prefix + part)
    return found


def test_values_are_those_of_the_rooms_that_work_them_out() -> None:
    found = expected()
    elsewhere = {"static torques"}
    left = {
        key for key, item in QUANTITIES.items()
        if item.family not in elsewhere and key not in found
    }  # fmt: skip
    assert {key.partition("_")[0] for key in left} <= {
        "deviation", "transmission", "pressure", "selective",
    }  # fmt: skip
    reached = check_reach(DESIGN.geometry, FIELD.grid.poses()).ok
    assert reached.any()
    assert not reached.all()
    for key, values in found.items():
        got = QUANTITIES[key].over(FIELD, DESIGN)
        np.testing.assert_allclose(
            got[reached], values[reached], rtol=1e-6, atol=1e-12, err_msg=key
        )
        if key != "reach_margin":  # which is how far out of reach
            assert np.isnan(got[~reached]).all(), key


def test_reasons_are_given_where_a_pose_can_be_taken_and_nowhere_else() -> None:
    """Out of reach is said by the pose; drives that are too soft are said of the frequencies."""
    reached = check_reach(DESIGN.geometry, FIELD.grid.poses()).ok
    soft = DESIGN.vary({"elastic.drive_rotary": 1.0, "payload.mass": 20.0})
    seen = set()
    for design in (DESIGN, soft):
        for key, item in QUANTITIES.items():
            if item.missing is None:
                continue
            found, values = item.missing(FIELD, design), item.over(FIELD, design)
            if item.family != "accuracy":
                assert not found.code[~reached].any(), key
            np.testing.assert_array_equal(
                found.code[reached] > 0, np.isnan(values[reached]), err_msg=key
            )
            assert len(found.texts) == len(found.words) > found.code.max()
            seen |= {key} if found.code[reached].any() else set()
    assert {"frequency_1", "frequency_drives"} <= seen


def test_indices_over_the_legs_and_of_z() -> None:
    field, reached = FIELD, check_reach(DESIGN.geometry, FIELD.grid.poses()).ok
    each = [QUANTITIES[f"transmission_{leg}"].over(field, DESIGN) for leg in (1, 2, 3)]
    least = QUANTITIES["transmission"].over(field, DESIGN)
    np.testing.assert_array_equal(least, np.min(each, axis=0))
    z = QUANTITIES["selective_z"].over(field, DESIGN)
    assert z[reached] == pytest.approx(1.0 / DESIGN.geometry.magnification)
    assert np.isnan(z[~reached]).all()


def test_a_quantity_is_the_first_result_of_its_formula_unless_it_says_otherwise() -> None:
    formula = QUANTITIES["condition"].formula
    plain = Quantity("a", "a", "a", "a", "1", formula)
    np.testing.assert_array_equal(plain.over(FIELD, DESIGN), FIELD.solve(formula)[0])
    assert (plain.signed, plain.bounded, plain.flat, plain.missing) == (False, False, False, None)
    assert (plain.family, plain.display.text) == ("other", "")


def test_a_map_of_any_quantity_takes_about_a_second() -> None:
    for key in QUANTITIES:
        assert affordable_cells([key], 10**4) == affordable_cells([key], 10**4, 1.0)
        assert affordable_cells([key], 10**4) >= 50, key
        assert affordable_cells([key], 10**4, 1e-9) == 2


def test_a_text_has_a_length_up_to_which_it_is_read() -> None:
    text = "condition <= 10"
    assert parse_requirement(text + " " * (LONGEST - len(text))).high == 10.0
    with pytest.raises(ValueError, match="characters"):
        parse_requirement(text + " " * (LONGEST + 1 - len(text)))
