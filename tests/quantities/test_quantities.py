"""Quantities of the registry: values against the model's own functions, words beside them."""

from __future__ import annotations

import pickle
import re
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Payload,
    inverse_jacobian,
    singular_radius,
    solve_field,
    static_torques,
)
from paminsa_viz.model.grids import Field, Grid
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.reach import Limit
from paminsa_viz.precision import Bound, field_drive_errors
from paminsa_viz.precision.manufacture import manufactured_pose
from paminsa_viz.quantities import (
    QUANTITIES,
    affordable_cells,
    families,
    find,
    formulas,
    selections,
)
from paminsa_viz.quantities.accuracy import OF_OWN_LEGS
from paminsa_viz.quantities.quantity import kept_over_poses
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)

LOADED = replace(APPENDIX_4, load=LoadCase(force_x=7.0, force_z=-30.0))
OVERBALANCED = replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 30.0, 0.5),))
"""Its arms are pulled up, with torques of the other sign."""

X, Y = np.linspace(-0.1, 0.12, 3), np.linspace(-0.08, 0.1, 4)


def solved(z: float, geometry=APPENDIX_4.geometry) -> Field:  # type: ignore[no-untyped-def]
    return solve_field(geometry, Grid.over((0.0, 0.0, 0.2, z), x=X, y=Y))


def test_values_of_poses_are_found_once_for_what_they_depend_on_and_nan_is_given_out_of_reach():
    asked = []

    def find_first(design, poses):  # type: ignore[no-untyped-def]
        asked.append(poses)
        return poses[..., 0]

    field = solve_field(APPENDIX_4.geometry, Grid.over((0.0, 0.0, 0.2, -0.5), x=[0.0, 9.0], y=Y))
    over = kept_over_poses("first", find_first, lambda design: design.geometry)
    values = over(field, APPENDIX_4)
    assert over(field, LOADED) is values
    (poses,) = asked
    out = field.status != Limit.OK
    assert out[1].all()
    assert not out[0].any()
    assert np.isnan(poses[1]).all()
    np.testing.assert_array_equal(poses[0], field.grid.poses()[0])
    np.testing.assert_array_equal(values, poses[..., 0])


@pytest.mark.parametrize(
    "design", [APPENDIX_4, OVERBALANCED, LOADED], ids=["no load", "overbalanced", "load"]
)
def test_torques_of_a_grid_are_those_of_its_poses(design) -> None:  # type: ignore[no-untyped-def]
    field = solved(-0.5)
    torque = static_torques(design, field.grid.poses())
    expected = {f"tau_{leg + 1}": torque[..., leg] for leg in range(3)} | {
        "f_4": torque[..., 3],
        "max_torque": np.abs(torque[..., :3]).max(axis=-1),
        "rms_torque": np.sqrt((torque[..., :3] ** 2).mean(axis=-1)),
    }
    for key, values in expected.items():
        found = QUANTITIES[key].over(field, design)
        assert found.shape == field.status.shape
        np.testing.assert_allclose(found, values, rtol=1e-9, atol=1e-12, err_msg=key)


def test_flat_quantities_are_the_same_at_all_heights_and_for_all_bars_and_no_others_are() -> None:
    """A volume solves them once a position and heading, so that one too many is a wrong volume."""
    longer = replace(APPENDIX_4.geometry, crank_length=0.55, coupler_length=0.5)
    fields = [solved(-0.5), solved(-0.86), solved(-0.5, longer)]
    assert all((field.status == Limit.OK).all() for field in fields)
    same = set()
    for key, item in QUANTITIES.items():
        if item.family == "kinematics":
            one, *others = (item.over(field, LOADED) for field in fields)
            if all(np.allclose(one, other, rtol=1e-9, atol=0) for other in others):
                same.add(key)
    flat = {key for key, item in QUANTITIES.items() if item.flat}
    assert flat == same - {"selective_z"}  # 1/k, which is no work to solve


def test_where_errors_have_no_bound_the_reason_is_that_of_the_pose() -> None:
    accuracy = replace(APPENDIX_4.accuracy, control_rotary=0.02)
    design = replace(APPENDIX_4, accuracy=accuracy)
    line = np.linspace(-0.34, 0.34, 61)
    field = solve_field(design.geometry, Grid.over((0.0, 0.0, 0.9, -0.5), x=line, y=line))
    found = field_drive_errors(field, accuracy)
    item = QUANTITIES["error_x"]
    assert item.missing is not None
    code, texts, words = item.missing(field, design)
    np.testing.assert_array_equal(code == 0, found.ok)
    seen = set()
    for place in zip(*np.nonzero(code), strict=True):
        bound, leg = Bound(int(found.status[place])), int(found.leg[place])
        seen.add((bound, leg))
        assert texts[code[place]] == f"no bound: {bound.reason(leg)}"
        assert words[code[place]].startswith(f"no-bound:{bound.word}")
        assert words[code[place]].endswith(f":leg{leg + 1}") == (leg >= 0)
    assert len(seen) > 3


def test_deviations_are_how_far_the_pose_is_from_the_one_that_was_asked_for() -> None:
    """Of a robot with one shaft longer: the legs' heights by hand, the rest as its own solver."""
    design = APPENDIX_4.vary({"leg2.shaft": 2e-4})
    field = solved(-0.5)
    poses = field.grid.poses()
    found = manufactured_pose(design, poses)
    change = found.pose - poses
    expected = {
        "x": change[..., 0], "y": change[..., 1], "theta": change[..., 2], "z": change[..., 3],
        "horizontal": np.hypot(change[..., 0], change[..., 1]),
        "tilt": np.hypot(found.tilt[..., 0], found.tilt[..., 1]),
    }  # fmt: skip
    for name, values in expected.items():
        got = QUANTITIES[f"deviation_{name}"].over(field, design)
        np.testing.assert_allclose(got, values, rtol=1e-9, atol=1e-15, err_msg=name)
    k = design.geometry.magnification
    z = QUANTITIES["deviation_z"].over(field, design)
    np.testing.assert_allclose(np.abs(z), k * 2e-4 / 3, rtol=5e-3)  # of one leg of three


def test_forces_in_a_plane_are_said_to_be_and_that_of_joint_5_is_not() -> None:
    titles = {
        key: item.title
        for key, item in QUANTITIES.items()
        if item.title.startswith("Largest static force at ")
    }
    inside = {key for key, title in titles.items() if title.endswith("in the leg’s plane")}
    assert set(titles) - inside == {"force_5", "joint_force"}


def test_a_workspace_is_about_the_robot_s_axis_unless_it_says_otherwise() -> None:
    assert Workspace(WorkspaceShape.BOX, (0.1, 0.2, 0.3)).center == (0.0, 0.0, None)


def test_pressure_angle_is_zero_where_rounding_makes_the_index_more_than_one() -> None:
    line = np.linspace(-0.3, 0.3, 301)
    field = solve_field(APPENDIX_4.geometry, Grid.over((0.0, 0.0, 0.0, -0.5), x=[0.0], y=line))
    index = QUANTITIES["transmission_3"].over(field, APPENDIX_4)
    above = index > 1.0
    assert above.any()
    assert (QUANTITIES["pressure_3"].over(field, APPENDIX_4)[above] == 0.0).all()


def test_force_and_motion_of_joint_5_include_the_pressure_angle() -> None:
    field = solved(-0.5)
    poses = field.grid.poses()
    lines = inverse_jacobian(APPENDIX_4.geometry, poses)[..., :3, :3]  # turned by legs: the forces
    for leg in range(3):
        pressure = QUANTITIES[f"pressure_{leg + 1}"].over(field, APPENDIX_4)
        index = QUANTITIES[f"transmission_{leg + 1}"].over(field, APPENDIX_4)
        np.testing.assert_allclose(np.cos(pressure), index, atol=1e-12)
        assert ((pressure >= 0) & (pressure <= np.pi / 2)).all()
        # A motion that the others leave: joint 5 moves so, and its force is along the row of leg.
        others = lines[..., [j for j in range(3) if j != leg], :]
        twist = np.cross(others[..., 0, :], others[..., 1, :])
        (ax, ay), c, s = LEG_AXES[leg], np.cos(poses[..., 2]), np.sin(poses[..., 2])
        radius = APPENDIX_4.geometry.platform_radius
        px, py = radius * (c * ax - s * ay), radius * (s * ax + c * ay)
        moved = np.stack([twist[..., 0] - py * twist[..., 2], twist[..., 1] + px * twist[..., 2]])
        force = lines[..., leg, :2]
        along = np.abs(np.einsum("i...,...i->...", moved, force))
        size = np.linalg.norm(moved, axis=0) * np.linalg.norm(force, axis=-1)
        np.testing.assert_allclose(along / size, index, rtol=1e-9)


@given(
    keys=st.lists(st.sampled_from(sorted(QUANTITIES)), min_size=1, max_size=3, unique=True),
    most=st.integers(2, 2000),
    budget=st.floats(1e-3, 10.0),
)
def test_cells_are_as_many_as_the_time_allows(keys: list[str], most: int, budget: float) -> None:
    cells = affordable_cells(keys, most, budget)
    costs = [QUANTITIES[key].cost for key in keys]
    rounding = 1 + 1e-9
    assert 2 <= cells <= most
    assert cells == 2 or cells**2 * max(costs) <= budget * rounding
    assert cells == most or (cells + 1) ** 2 * sum(costs) * rounding > budget
    assert affordable_cells(keys[::-1], most, budget) == cells
    assert all(affordable_cells([key], most, budget) >= cells for key in keys)
    assert affordable_cells(keys, most, 1e308) == affordable_cells((), most, budget) == most


CELLS = (
    (1825, "condition determinant transmission.* pressure_. selective_(x|y|theta) conditioning"),
    (1000, "payload horizontal_force vertical_force moment (turn_)?speed"),
    (500, "joint_force force_m guide_force force_8_b. force_. bearing_moment arm_moment"),
    (447, "(turn_)?acceleration (linear_|rms_)?error_.*"),
    (288, "bar_moment bar_axial utilization"),
    (223, "frequency_drives"),
    (200, "(rms_)?tolerance_.* stiffness_.* deflection deflection_tilt"),
    (182, "clearance"),
    (141, "deviation_.*"),
    (70, "clearance_.*"),
    (57, "frequency_1"),
)
"""Cells a side that a map of a second has, by what a pose takes where that was measured; the
others, which say no `Quantity.cost`, have 3162."""


def test_maps_of_all_quantities_have_the_cells_that_were_settled_on() -> None:
    def settled(key: str) -> int:
        rows = (cells for cells, names in CELLS if any(re.fullmatch(n, key) for n in names.split()))
        return next(rows, 3162)

    for key in QUANTITIES:
        assert affordable_cells([key], 10**6, 1.0) == settled(key), key


def test_cells_of_results_that_share_their_work_are_as_many_as_of_one() -> None:
    together = affordable_cells(["pressure_1", "pressure_2", "pressure_3"], 10**6)
    assert together == affordable_cells(["pressure_1"], 10**6)


def test_clearances_of_bodies_that_a_robot_has_not_say_so_where_it_can_be() -> None:
    bare = replace(APPENDIX_4, payload=Payload(), counterweights=())
    wide = np.linspace(-0.6, 0.6, 7)
    field = solve_field(bare.geometry, Grid.over((0.0, 0.0, 0.2, -0.5), x=wide, y=wide))
    reached = field.status == Limit.OK
    assert reached.any()
    assert not reached.all()
    words = {}
    for item in QUANTITIES.values():
        if item.family == "clearance" and item.missing is not None:
            code = item.missing(field, bare).code
            words[item.key] = code[reached].all()
            assert not code[~reached].any()  # those are out of reach, which is said instead
            without = np.isnan(item.over(field, bare))[reached]
            np.testing.assert_array_equal(code[reached] > 0, without, err_msg=item.key)
    assert words["clearance_payload"]
    assert not words["clearance_same_leg"]


def test_stiffness_above_the_center_is_the_same_in_all_horizontal_directions() -> None:
    """Three legs make no direction stiffer there, where the robot is its own image by 120 deg."""
    field = solve_field(APPENDIX_4.geometry, Grid.over((0.0, 0.0, 0.3, -0.5), x=[0.0], y=[0.0]))
    x, y, least = (
        float(QUANTITIES[f"stiffness_{key}"].over(field, APPENDIX_4).squeeze())
        for key in ("x", "y", "horizontal")
    )
    assert y == pytest.approx(x, rel=1e-9)
    assert least == pytest.approx(x, rel=1e-6)


def test_selective_indices_are_the_loads_of_unit_torques() -> None:
    """How long the torques of M1..M3 are that hold a unit load is the inverse of that load."""
    field = solved(-0.5)
    plain = static_torques(APPENDIX_4, field.grid.poses())[..., :3]
    for name, load in (("x", "force_x"), ("y", "force_y"), ("theta", "moment_z")):
        pushed = replace(APPENDIX_4, load=LoadCase(**{load: 1.0}))
        changed = static_torques(pushed, field.grid.poses())[..., :3] - plain
        expected = 1 / np.linalg.norm(changed, axis=-1)
        found = QUANTITIES[f"selective_{name}"].over(field, APPENDIX_4)
        np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_clearances_have_a_sign_and_a_bound() -> None:
    found = [item for item in QUANTITIES.values() if item.family == "clearance"]
    assert len(found) > 3
    assert all(item.signed and item.bounded for item in found)


def test_quantities_are_found_by_key_family_and_choice() -> None:
    assert [item.key for item in find(["f_4", "condition"])] == ["f_4", "condition"]
    with pytest.raises(InvalidInput, match=r"there is no quantity 'conditionx'; .*condition"):
        find(["f_4", "conditionx"])
    by_family = families()
    assert [item for items in by_family.values() for item in items] == sorted(
        QUANTITIES.values(), key=lambda item: list(by_family).index(item.family)
    )
    assert all(item.family == name for name, items in by_family.items() for item in items)
    assert {"tau_1", "tau_2", "tau_3"} == set(selections()["torques"])
    assert set(selections()) == {"torques", *QUANTITIES}
    assert all(selections()[key] == (key,) for key in QUANTITIES)
    assert len(formulas()) == len(set(formulas()))
    assert set(formulas()) == {item.formula for item in QUANTITIES.values()}


def test_poses_that_no_robot_holds_or_can_be_assembled_in_say_so() -> None:
    """Drives that are much too soft; and legs that are not as long as they should be."""
    field = solved(-0.5)
    soft = replace(APPENDIX_4, elastic=replace(APPENDIX_4.elastic, drive_rotary=1.0))
    pushed = replace(soft, payload=Payload(mass=20.0))
    item = QUANTITIES["frequency_1"]
    assert item.missing is not None
    empty = np.isnan(item.over(field, pushed))
    assert empty.any()
    found = item.missing(field, pushed)
    assert [bool(found.texts[code]) for code in found.code.ravel()] == empty.ravel().tolist()
    crooked = APPENDIX_4.vary({"leg1.bar_94": -0.42})
    item = QUANTITIES["deviation_x"]
    assert item.missing is not None
    empty = np.isnan(item.over(field, crooked))
    assert empty.any()
    found = item.missing(field, crooked)
    assert [bool(found.texts[code]) for code in found.code.ravel()] == empty.ravel().tolist()


@pytest.mark.slow
def test_values_of_a_grid_are_those_of_its_poses_alone() -> None:
    """Of every quantity, and where it has none for a reason of its own, with the same reason."""
    design = LOADED.vary({"leg1.bar_94": 1e-4, "payload.mass": 2.0})
    x, y = [-0.1, 0.02, 0.11], [-0.05, 0.06]
    field = solve_field(design.geometry, Grid.over((0.0, 0.0, 0.2, -0.5), y=y, x=x))
    places = [(0, 2), (1, 0)]
    alone = [
        solve_field(design.geometry, Grid.over((0.0, 0.0, 0.2, -0.5), y=[y[i]], x=[x[j]]))
        for i, j in places
    ]
    for key, item in QUANTITIES.items():
        values = item.over(field, design)
        assert values.shape == field.status.shape, key
        for place, single in zip(places, alone, strict=True):
            found = item.over(single, design)[0, 0]
            assert values[place] == pytest.approx(found, rel=1e-6, abs=1e-12, nan_ok=True), key
            if item.missing is not None:
                every, own = item.missing(field, design), item.missing(single, design)
                assert every.texts[every.code[place]] == own.texts[own.code[0, 0]]
        if key != "clearance_counterweights":  # which it has not
            assert np.isfinite(values).any(), key


@pytest.mark.slow
def test_quantities_are_signed_if_they_have_both_signs_and_no_others() -> None:
    """But for the force of M4, of whose natural center nothing is known: it lifts."""
    crooked = {"leg1.bar_94": 1e-3, "leg2.bar_94": -1e-3, "leg3.joint_height": 1e-3}
    far = np.linspace(-0.3, 0.3, 5)
    found: dict[str, set[int]] = {key: set() for key in QUANTITIES}
    for design in (LOADED.vary(crooked), APPENDIX_4.vary({"leg1.bar_94": -1e-3})):
        field = solve_field(design.geometry, Grid.over((0.0, 0.0, 0.2, -0.45), y=far, x=far))
        for key, item in QUANTITIES.items():
            values = item.over(field, design)[field.status == Limit.OK]
            found[key] |= set(np.sign(values[np.isfinite(values)]).astype(int).tolist())
    both = {key for key, signs in found.items() if {-1, 1} <= signs} - {"f_4"}
    signed = {key for key, item in QUANTITIES.items() if item.signed}
    assert both <= signed
    assert all(key.startswith("clearance") for key in signed - both)


@pytest.mark.slow
def test_quantities_of_a_design_s_own_legs_are_listed() -> None:
    field = solve_field(LOADED.geometry, Grid.over((0.03, -0.02, 0.2, -0.45), y=[-0.02], x=[0.03]))
    crooked = LOADED.vary({"leg2.bar_94": 1e-3, "leg3.joint_angle": 1e-3})
    own = {
        key
        for key, item in QUANTITIES.items()
        if not np.array_equal(item.over(field, crooked), item.over(field, LOADED), equal_nan=True)
    }
    assert own == OF_OWN_LEGS


def test_no_bounded_quantity_grows_at_a_singularity() -> None:
    """And of stiffness and clearance, which are to keep off 0, all others do."""
    radius = float(singular_radius(LOADED.geometry, 0.2))
    near, far = (
        solve_field(
            LOADED.geometry,
            Grid.over(((radius - d) * np.cos(0.7), (radius - d) * np.sin(0.7), 0.2, -0.45)),
        )
        for d in (1e-6, 1e-2)
    )
    for key, item in QUANTITIES.items():
        here, there = (float(np.abs(item.over(field, LOADED)).item()) for field in (near, far))
        grows = here > 10.0 * there
        assert not (item.bounded and grows), key
        if item.family in ("stiffness", "clearance"):
            assert item.bounded != grows, key


def test_requirements_hold_at_the_heading_of_zero_unless_they_say_otherwise() -> None:
    own = Requirement("condition", high=3.0, theta=(0.1, 0.2))
    plain = Requirement("condition", high=3.0)
    assert Requirements().theta == (0.0, 0.0)
    asked = Requirements((own, plain), (-0.3, 0.4))
    assert (asked.headings(own), asked.headings(plain)) == ((0.1, 0.2), (-0.3, 0.4))
    assert [bound.size for bound in (plain, Requirement("f_4", low=-200.0, high=300.0))] == [3, 200]
    assert Requirement("clearance", low=0.0).size == 1.0


def test_a_quantity_goes_to_another_process_as_the_registrys_own() -> None:
    for item in QUANTITIES.values():
        assert pickle.loads(pickle.dumps(item)) is item, item.key
        assert deepcopy(item) is item
    own = replace(QUANTITIES["condition"], title="mine", value=None)
    assert pickle.loads(pickle.dumps(own)) == own
