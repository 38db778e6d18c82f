"""Vibration of the whole robot: rigid limit, convergence, reductions, symmetry, lost poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.elastostatics.beams import beam_mass, beam_stiffness, body_mass, point_mass
from paminsa_viz.elastostatics.center_lines import POINTS, center_lines
from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.elastostatics.leg_matrices import leg_matrices, structure
from paminsa_viz.elastostatics.modes import natural_modes
from paminsa_viz.elastostatics.vibration import (
    ReducedRobot,
    first_frequencies,
    guyan_modes,
    iterated_modes,
    platform_mass,
    reduced_robot,
    robot_modes,
    whole_matrices,
    whole_modes,
)
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Design, KneeBranch, LoadCase, inverse_kinematics
from paminsa_viz.model.parameters import Counterweight, Payload
from tests.support import samples

POSES = np.array([[0.0, 0.0, 0.0, -0.5], [0.05, -0.03, 0.4, -0.6], [-0.06, 0.08, -0.5, -0.45]])
SOFT = replace(
    APPENDIX_4,
    elastic=replace(
        APPENDIX_4.elastic, bearing_radial=1e7, bearing_axial=2e7, bearing_tilt=1e4, ball=2e7,
        guide=1e7, guide_tilt=5e4, b4_inertia_in=3e-8,
    ),
)  # fmt: skip
LOADED = replace(
    APPENDIX_4,
    payload=Payload(mass=4.0, inertia=0.02, height=0.07),
    load=LoadCase(12.0, -7.0, -30.0, moment_z=1.5, point_x=0.04),
    counterweights=(
        Counterweight("b8", 8, 0.1, 0.7), Counterweight("b4", 5, 0.15, 0.4),
        Counterweight("b3", 7, 0.05, 0.3), Counterweight("b7", 7, 0.02, 0.2),
    ),
)  # fmt: skip


def stiffer(design: Design, times: float) -> Design:
    """The same robot with stiffer bars."""
    own = design.elastic
    young, shear = times * own.young_modulus, times * own.shear_modulus
    return replace(design, elastic=replace(own, young_modulus=young, shear_modulus=shear))


def test_beam_has_the_mass_and_the_inertia_of_the_bar() -> None:
    length, mass, axial, inertia = 0.6, 0.7, 0.001, 0.05
    rotary = (inertia - mass * length**2 / 12) / length
    m = beam_mass(length, mass / length, axial / length, rotary)
    for axis in range(3):
        both = np.zeros(12)
        both[[axis, axis + 6]] = 1.0
        assert both @ m @ both == pytest.approx(mass, rel=1e-12)
    for axis, sign in ((1, -1.0), (2, 1.0)):  # turns about the middle, displaced along z or y
        turn = np.zeros(12)
        across = 2 if axis == 1 else 1
        turn[[3 + axis, 9 + axis]] = 1.0
        turn[[across, across + 6]] = sign * np.array([-length / 2, length / 2])
        assert turn @ m @ turn == pytest.approx(inertia, rel=1e-12)
    roll = np.zeros(12)
    roll[[3, 9]] = 1.0
    assert roll @ m @ roll == pytest.approx(axial, rel=1e-12)
    assert np.array_equal(m, m.T)


def test_rigid_body_is_its_point_masses() -> None:
    places, masses = np.array([0.1, -0.2, 0.35]), np.array([0.3, 0.5, 0.2])
    expected = sum(point_mass(m, x) for m, x in zip(masses, places, strict=True))
    found = body_mass(masses.sum(), masses @ places, masses @ places**2)
    assert found == pytest.approx(expected, abs=1e-15)
    rotary = 0.03
    found = body_mass(masses.sum(), masses @ places, masses @ places**2, rotary)
    v, w = np.random.default_rng(2).normal(size=(2, 3))
    arms = places[:, None] * [1.0, 0.0, 0.0]
    energy = 0.5 * masses @ ((v + np.cross(w, arms)) ** 2).sum(axis=1)
    energy += 0.5 * rotary * (w[1:] ** 2).sum()
    assert 0.5 * np.r_[v, w] @ found @ np.r_[v, w] == pytest.approx(energy, rel=1e-12)


def test_cantilever_vibrates_as_in_closed_form() -> None:
    """cos(a) cosh(a) = -1: a = 1.8751, 4.6941 (Bernoulli beam); axially (2 i - 1) pi/2."""
    length, count, own = 0.8, 12, APPENDIX_4.elastic
    section = own.section("b8")._replace(inertia_out=1e-6)
    step, mass = length / count, 1.3
    k, m = np.zeros((2, 6 * (count + 1), 6 * (count + 1)))
    for i in range(count):
        part = slice(6 * i, 6 * i + 12)
        k[part, part] += beam_stiffness(step, section, own)
        m[part, part] += beam_mass(step, mass, 0.01, 0.0)
    free = np.setdiff1d(np.arange(6, len(k)), np.arange(3, len(k), 6))  # held root, no roll
    found = natural_modes(k[np.ix_(free, free)], m[np.ix_(free, free)]).frequencies
    bending = own.young_modulus * section.inertia_in / (mass * length**4)
    for a in (1.87510407, 4.69409113):
        expected = a**2 * np.sqrt(bending) / (2 * np.pi)
        assert np.abs(found / expected - 1).min() < 3e-5
    axial = np.sqrt(own.young_modulus * section.area / mass) / (4 * length)
    assert np.abs(found / axial - 1).min() < 1e-3


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_stiff_bars_vibrate_as_the_drives_alone(knee: KneeBranch) -> None:
    """Masses, inertias, weight and load are those of the rigid robot's own dynamics."""
    rng = np.random.default_rng(3)
    drawn = [samples.random_design(rng) for _ in range(3)]
    for design in (d.with_knee(knee) for d in (LOADED, *drawn)):
        poses = samples.random_poses(rng, design, 4)
        rigid = drive_modes(design, poses)
        robot = reduced_robot(leg_matrices(stiffer(design, 1e6)), poses)
        count = int(rigid.ok.sum())
        assert count > 0
        found, expected = iterated_modes(robot, 4).frequencies, rigid.frequencies
        assert found[rigid.ok, :3] == pytest.approx(expected[rigid.ok, :3], rel=2e-5)
        # The fourth moves the shafts, of whose ends only the bars' own stiffness tells.
        assert found[rigid.ok, 3] == pytest.approx(expected[rigid.ok, 3], rel=2e-4)


@pytest.mark.slow
def test_more_elements_converge() -> None:
    found = [whole_modes(leg_matrices(LOADED, n), POSES[1], 3).frequencies for n in (1, 2, 3)]
    assert (found[0] > found[1]).all()
    assert (found[1] > found[2]).all()
    assert found[0] == pytest.approx(found[2], rel=2e-5)
    assert found[1] == pytest.approx(found[2], rel=1e-6)


@pytest.mark.parametrize(
    ("design", "error"), [(APPENDIX_4, 1.5e-4), (LOADED, 1.5e-4), (SOFT, 2e-3)],
    ids=["rigid", "loaded", "elastic"],
)  # fmt: skip
def test_reductions_are_upper_bounds_of_the_whole(design: Design, error: float) -> None:
    robot = reduced_robot(leg_matrices(design), POSES)
    whole = [float(whole_modes(leg_matrices(design), p, 1).frequencies[0]) for p in POSES]
    iterated = iterated_modes(robot).frequencies[:, 0]
    static = guyan_modes(robot).frequencies[:, 0]
    assert (static > iterated).all()
    assert (iterated >= np.array(whole) * (1 - 1e-12)).all()
    assert iterated == pytest.approx(whole, rel=error)
    assert first_frequencies(design, POSES).tolist() == iterated.tolist()


def test_whole_modes_solve_the_matrices() -> None:
    matrices = leg_matrices(LOADED)
    k, m = whole_matrices(matrices, POSES[1])
    found = whole_modes(matrices, POSES[1], 4)
    assert found.ok
    squared = (2 * np.pi * found.frequencies) ** 2
    residual = k @ found.shapes - m @ found.shapes * squared
    assert np.abs(residual).max() < 1e-8 * np.abs(k @ found.shapes).max()
    assert found.shapes.T @ m @ found.shapes == pytest.approx(np.eye(4), abs=1e-9)


def test_coordinates_without_inertia_have_infinite_frequencies() -> None:
    """Of all modes, more of them than have inertia; those that have are as few as asked for."""
    bars = [f"inertias.b{bar}_{axis}" for bar in (3, 4, 7, 8) for axis in ("axial", "transverse")]
    matrices = leg_matrices(APPENDIX_4.vary(dict.fromkeys(bars, 0.0)))
    found = whole_modes(matrices, POSES[1], 1000).frequencies
    assert (np.diff(found[np.isfinite(found)]) >= 0).all()
    assert not np.isnan(found).any()
    assert np.isinf(found[-40:]).all()
    assert found[:6] == pytest.approx(whole_modes(matrices, POSES[1], 6).frequencies, rel=1e-9)


def test_a_step_of_iteration_leaves_out_what_has_no_mass() -> None:
    """Without inertia inside the legs the condensed matrices are exact, and the step adds none."""
    rng = np.random.default_rng(5)
    roots = rng.normal(size=(2, 2, 7, 7))
    stiffness = 1e4 * roots[0] @ np.swapaxes(roots[0], 1, 2)
    mass = roots[1] @ np.swapaxes(roots[1], 1, 2)
    stiffness[1], mass[1] = np.diag(1e4 * np.arange(1.0, 8.0)), np.diag([2, 1, 0, 3, 0, 1, 4])
    legs = np.zeros((2, 3, 4, 4))
    robot = ReducedRobot(stiffness, mass, legs, legs, rng.normal(size=(2, 3, 4, 7)))
    found = iterated_modes(robot, 7).frequencies
    assert found == pytest.approx(natural_modes(stiffness, mass).frequencies, rel=1e-6)
    assert np.isinf(found).tolist() == [[False] * 7, [False] * 5 + [True] * 2]


def test_inertia_about_horizontal_axes_counts_where_it_is_given() -> None:
    """As much as in the tilt of the shapes: f^2 falls by 2 pi f^2 times what v^T dM v adds."""
    heavy = APPENDIX_4.vary({"elastic.platform_tilt_inertia": 0.0076})
    modes = robot_modes(APPENDIX_4, POSES[1], 6)
    changed = robot_modes(heavy, POSES[1], 6).frequencies
    added = (0.0076 - 0.0075) * (modes.shapes[3:5] ** 2).sum(axis=0)
    expected = modes.frequencies * (1 - added / 2)
    assert changed == pytest.approx(expected, rel=1e-4)
    assert (1 - changed / modes.frequencies).max() > 1e-3


def test_a_third_of_a_turn_changes_no_frequency() -> None:
    turned = POSES.copy()
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turned[:, :2] = POSES[:, :2] @ np.array([[c, s], [-s, c]])
    found = first_frequencies(APPENDIX_4, turned)
    assert found == pytest.approx(first_frequencies(APPENDIX_4, POSES), rel=1e-9)


def test_lost_poses_have_no_frequency() -> None:
    """Out of reach, singular by turn and by place, and pushed away by a large load."""
    turn = float(np.arccos(0.1 / 0.35))
    poses = np.array(
        [[0.0, 0.0, 0.0, -0.5], [2.0, 0.0, 0.0, -0.5], [0.0, 0.0, turn, -0.5],
         [0.25, 0.0, 0.0, -0.5], [np.nan, 0.0, 0.0, -0.5]]
    )  # fmt: skip
    found = first_frequencies(APPENDIX_4, poses)
    assert np.isfinite(found).tolist() == [True, False, False, False, False]
    for pose in poses[1:]:
        lost = robot_modes(APPENDIX_4, pose, 3)
        assert not lost.ok
        assert np.isnan(lost.frequencies).all()
    weak = replace(APPENDIX_4, elastic=replace(APPENDIX_4.elastic, drive_rotary=1.0))
    pushed = replace(weak, payload=Payload(mass=20.0))
    assert np.isnan(first_frequencies(pushed, np.array([0.08, 0.05, 0.6, -0.5])))


def test_all_modes_are_of_one_pose_that_weight_does_not_push_away() -> None:
    with pytest.raises(InvalidInput, match=r"pose: one pose \(4,\) is needed; got \(3, 4\)"):
        robot_modes(APPENDIX_4, POSES)
    heavy = replace(APPENDIX_4, payload=Payload(mass=1e4, height=20.0))
    for count in (1, 6):
        pushed = robot_modes(heavy, POSES[1], count)
        assert not pushed.ok
        assert np.isnan(pushed.frequencies).all()
        assert np.isnan(pushed.shapes).all()
        assert pushed.shapes.shape[1] == len(pushed.frequencies) == count


@pytest.mark.slow
def test_usually_bars_are_single_elements_without_shear_and_six_modes_are_found() -> None:
    pose = POSES[1]
    found = robot_modes(LOADED, pose).frequencies
    for divisions, shear, count in ((1, False, 6), (2, False, 6), (1, True, 6), (1, False, 7)):
        given = robot_modes(LOADED, pose, count, divisions=divisions, shear=shear).frequencies
        whole = whole_modes(leg_matrices(LOADED, divisions, shear), pose, count).frequencies
        assert given.tolist() == whole.tolist()
        assert (given.tolist() == found.tolist()) is ((divisions, shear, count) == (1, False, 6))
    assert whole_modes(leg_matrices(LOADED), pose).frequencies.tolist() == found.tolist()
    robot = reduced_robot(leg_matrices(LOADED), POSES)
    assert guyan_modes(robot).frequencies.shape == (3, 7)
    assert iterated_modes(robot).frequencies.shape == (3, 1)


def test_batches_give_what_single_poses_give() -> None:
    whole = first_frequencies(APPENDIX_4, POSES.reshape(3, 1, 4))
    single = [float(first_frequencies(APPENDIX_4, pose)) for pose in POSES]
    assert whole.shape == (3, 1)
    assert whole[:, 0] == pytest.approx(single, rel=1e-10)


def test_bars_without_length_or_too_many_elements_are_refused() -> None:
    design = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, shaft_length=0.0))
    with pytest.raises(InvalidInput, match="shaft_length"):
        leg_matrices(design)
    for divisions in (0, 17):
        with pytest.raises(InvalidInput, match="divisions"):
            leg_matrices(APPENDIX_4, divisions)


@pytest.mark.slow
def test_center_lines_meet_at_the_joints_and_move_with_the_platform() -> None:
    matrices = leg_matrices(SOFT, 2)
    rigid = leg_matrices(APPENDIX_4, 2)
    pose = POSES[1]
    lines = center_lines(rigid, pose, whole_modes(rigid, pose, 3).shapes)
    by = {name: i for i, name in enumerate(lines.names[:8])}
    joints = inverse_kinematics(APPENDIX_4.geometry, pose).points
    ends = (("b8", -1, 9), ("b4", 0, 9), ("b8", 0, 8), ("b7", 0, 8), ("b7", -1, 7), ("b3", 0, 7),
            ("b3", -1, 4), ("b2", 0, 3), ("b4", -1, 5), ("platform", -1, 5))  # fmt: skip
    moves: dict[int, np.ndarray] = {}
    for bar, end, joint in ends:
        line = by[bar if bar == "platform" else f"leg1/{bar}"]
        assert lines.points[line, end] == pytest.approx(joints[joint][0], abs=1e-12)
        moved = lines.moves[line, end]
        assert moved == pytest.approx(moves.setdefault(joint, moved), abs=1e-12)
    assert lines.points.shape == (24, POINTS, 3)
    soft = center_lines(matrices, pose, whole_modes(matrices, pose, 1).shapes)
    gap = soft.moves[by["leg1/b4"], -1] - soft.moves[by["platform"], -1]
    assert 1e-6 < np.abs(gap).max() < 0.1 * soft.largest[0]  # the elastic ball joint gives way


@pytest.mark.slow
def test_between_two_nodes_a_loaded_bar_has_the_cubic_of_its_element() -> None:
    """Forces act at joints alone, so that more elements change no point of a center line."""
    found = []
    for divisions in (1, 4):
        matrices = leg_matrices(SOFT, divisions)
        k, _ = whole_matrices(matrices, POSES[1], loaded=False)
        force = np.zeros((len(k), 1))
        force[:6, 0] = [30.0, -20.0, 50.0, 2.0, 3.0, -4.0]
        found.append(center_lines(matrices, POSES[1], np.linalg.solve(k, force)).moves)
    assert np.abs(found[1] - found[0]).max() < 1e-7 * np.abs(found[0]).max()


def test_center_lines_of_a_static_shape_are_the_structure_s() -> None:
    """The platform moves by 1 mm along x: nodes as of `Structure.displacements`, cubic between."""
    matrices = leg_matrices(APPENDIX_4, 2)
    pose, twist = POSES[1], np.array([1e-3, 0, 0, 0, 0, 0])
    own = structure(APPENDIX_4, pose, divisions=2)
    freedoms = own.displacements(twist)
    vector = np.concatenate([twist, freedoms[0][3:4], *(part[4:] for part in freedoms)])
    lines = center_lines(matrices, pose, vector[:, None])
    b4 = lines.names.index("leg2/b4")
    node = own.matrices.model.node("b4", 4)
    along = APPENDIX_4.geometry.short_coupler_length / APPENDIX_4.geometry.coupler_length
    expected = freedoms[1][list(node.freedoms[:3])] @ own.frame.axes[1]
    index = along * (POINTS - 1)
    near, far = lines.moves[b4, int(index), :, 0], lines.moves[b4, int(index) + 1, :, 0]
    assert near + (index % 1) * (far - near) == pytest.approx(expected, abs=2e-6)


def test_center_lines_are_linear_have_a_middle_and_are_straight_beyond_the_last_node() -> None:
    """For any coordinates, also those that move one thing alone."""
    matrices, pose = leg_matrices(SOFT), POSES[1]
    size = len(whole_matrices(matrices, pose)[0])
    each = center_lines(matrices, pose, np.eye(size))
    assert np.isfinite(each.moves).all()
    every = center_lines(matrices, pose, np.ones((size, 1)))
    np.testing.assert_allclose(each.moves.sum(axis=-1), every.moves[..., 0], atol=1e-12)
    ways = np.linalg.norm(np.moveaxis(each.moves, 2, -1), axis=-1)
    np.testing.assert_allclose(each.largest, ways.reshape(-1, size).max(axis=0), rtol=1e-12)
    ends = each.points[:, [0, POINTS // 2, -1]]
    np.testing.assert_allclose(ends[:, 1], 0.5 * (ends[:, 0] + ends[:, 2]), atol=1e-12)
    platform = each.names.index("platform")
    np.testing.assert_allclose(ends[platform, 0], pose[[0, 1, 3]], atol=1e-12)
    # B10 is straight from the slider's node outward, as that moves and turns
    line, frame = each.names.index("leg1/b10"), leg_frame(SOFT.geometry, pose)
    node = matrices.model.node("b10", 8)
    first = 7 + np.array(node.freedoms) - 4  # the shared coordinates, those of leg 1
    way = each.points[line, -1] - inverse_kinematics(SOFT.geometry, pose).points[8][0]
    assert np.linalg.norm(way) > 0.05
    move = every_turn = np.zeros((3, size))
    move, every_turn = move.copy(), every_turn.copy()
    move[:, first[:3]], every_turn[:, first[3:]] = frame.axes[0].T, frame.axes[0].T
    expected = move + np.cross(every_turn, way, axisa=0, axisc=0)
    np.testing.assert_allclose(each.moves[line, -1], expected, atol=1e-12)


def test_payload_above_the_center_has_the_energies_of_its_rigid_body() -> None:
    payload = Payload(mass=3.0, inertia=0.02, height=0.11)
    platform = APPENDIX_4.platform
    rng = np.random.default_rng(4)
    found = platform_mass(replace(APPENDIX_4, payload=payload))
    spin = np.array([0.5, 0.5, 1.0])
    for _ in range(5):
        v, w = rng.normal(size=(2, 3))
        center = v + np.cross(w, [0.0, 0.0, payload.height])
        energy = 0.5 * (platform.mass * v @ v + payload.mass * center @ center)
        energy += 0.5 * (platform.inertia + payload.inertia) * spin @ w**2
        assert 0.5 * np.r_[v, w] @ found @ np.r_[v, w] == pytest.approx(energy, rel=1e-12)
    raised = replace(APPENDIX_4, payload=payload)
    level = replace(APPENDIX_4, payload=replace(payload, height=0.0))
    pose = np.array([[0.05, -0.03, 0.2, -0.5]])
    change = np.subtract(
        *(reduced_robot(leg_matrices(design), pose).stiffness[0] for design in (raised, level))
    )
    # V = m g h cos(tilt)
    expected = np.zeros((7, 7))
    expected[3, 3] = expected[4, 4] = -payload.mass * APPENDIX_4.gravity * payload.height
    np.testing.assert_allclose(change, expected, atol=1e-8)
