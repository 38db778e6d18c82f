"""The mechanism given to the engines stands where first principles say, and carries all mass."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.mechanism import Link, build_mechanism, identifier
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.poses import joint_values, start_pose, unclosed
from paminsa_viz.engines.urdf import urdf_text
from paminsa_viz.engines.usd import usd_text
from paminsa_viz.errors import InvalidDesign, UnreachablePose
from paminsa_viz.model.design import APPENDIX_4, Design, Geometry, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.parameters import Counterweight
from tests import oracle
from tests.support import samples
from tests.support.cases import BOTH
from tests.support.samples import with_knee

EACH = samples.each_robot((20, 21))


def frames(design: Design, pose: Any) -> dict[str, tuple[Any, Rotation]]:
    """Origin and orientation of every link at one pose, from the joint values alone."""
    values = joint_values(inverse_kinematics(design.geometry, pose))
    found: dict[str | None, tuple[Any, Rotation]] = {None: (np.zeros(3), Rotation.identity())}
    for link in build_mechanism(design).links:
        place, turn = found[link.parent]
        place = place + turn.apply(link.place)
        turn = turn * Rotation.from_euler("z", link.heading)
        for joint in link.joints:
            value = float(values[joint.name])
            if joint.kind == "slide":
                place = place + value * turn.apply(joint.axis)
            else:
                turn = turn * Rotation.from_rotvec(value * np.asarray(joint.axis, float))
        found[link.name] = place, turn
    return {name: frame for name, frame in found.items() if name is not None}


@EACH
def test_loops_close(design: Design) -> None:
    for pose in samples.random_poses(np.random.default_rng(0), design, 10, natural=False):
        at = frames(design, pose)
        for pin in build_mechanism(design).pins:
            ends = [
                at[name][0] + at[name][1].apply(point)
                for name, point in ((pin.first, pin.first_point), (pin.second, pin.second_point))
            ]
            np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-13, err_msg=pin.name)


def part_name(body: oracle.Body) -> str:
    """The mechanism's name for a body of the oracle."""
    leg, _, name = body.name.rpartition(": ")
    return (leg + "_" + name).replace(" ", "") if leg else name


@EACH
def test_every_mass_is_where_first_principles_put_it(design: Design) -> None:
    pose = samples.random_poses(np.random.default_rng(1), design, 1)[0]
    at = frames(design, pose)
    owners: dict[str, tuple[Link, Any]] = {
        part.name: (link, part) for link in build_mechanism(design).links for part in link.parts
    }
    arms = 0.0
    for body in oracle.bodies(design, oracle.split(pose)):
        name = part_name(body)
        if name.endswith("B1"):  # the arms stand in the lift as one: only their height counts
            arms += body.mass
            assert at["lift"][0][2] == pytest.approx(body.center[2], abs=1e-14)
            continue
        link, part = owners.pop(name) if name in owners else (None, None)
        if part is None:
            assert (name, body.mass, body.inertia[2]) == ("payload", 0.0, 0.0)
            continue
        place, turn = at[link.name]
        assert part.mass == body.mass
        center = [float(c) for c in body.center]
        np.testing.assert_allclose(place + turn.apply(part.center), center, rtol=0, atol=1e-13)
        if body.axes is not None:
            assert part.inertia[2] == body.inertia[2]
            if name[-2:] in ("B3", "B4", "B7", "B8"):
                assert part.inertia == body.inertia
                axis = [float(c) for c in body.axes[0]]
                along = turn.apply([1.0, 0.0, 0.0])
                np.testing.assert_allclose(along, axis, rtol=0, atol=1e-13)
    assert owners.pop("arms_3xB1")[1].mass == pytest.approx(arms, rel=1e-15)
    assert not owners


@BOTH
def test_start_pose_is_regular_and_on_the_natural_side(knee: KneeBranch) -> None:
    rng = np.random.default_rng(2)
    for design in (APPENDIX_4, *(samples.random_design(rng) for _ in range(10))):
        pose = start_pose(with_knee(design, knee))
        assert np.isfinite(inverse_kinematics(with_knee(design.geometry, knee), pose).phi).all()
        assert (pose[3] + design.geometry.platform_joint_height) * knee.sign < 0


@BOTH
@pytest.mark.parametrize(
    ("crank", "coupler"), [(0.6, 0.7), (1.4, 0.7), (0.7, 1.4)], ids=["alike", "crank", "coupler"]
)
def test_a_start_is_halfway_between_the_shortest_and_the_longest_reach(
    knee: KneeBranch, crank: float, coupler: float
) -> None:
    """From joint 8 to joint 5: no less than across at the center, nor than when folded."""
    design = APPENDIX_4.vary(
        {"geometry.crank_length": crank, "geometry.coupler_length": coupler}
    ).with_knee(knee)
    configuration = inverse_kinematics(design.geometry, start_pose(design))
    eight, five = (np.asarray(configuration.points[number])[0] for number in (8, 5))
    across = np.linalg.norm((five - eight)[:2])
    least = max(across, abs(crank - coupler))
    assert np.linalg.norm(five - eight) == pytest.approx(0.5 * (least + crank + coupler))
    np.testing.assert_array_equal(start_pose(design)[:3], 0.0)


def test_robot_singular_at_the_center_has_no_start_pose() -> None:
    same = Design(Geometry(base_radius=0.2, platform_radius=0.2))
    with pytest.raises(UnreachablePose, match="cannot close"):
        start_pose(same)


def test_a_pose_at_which_the_bars_cannot_close_is_told_to_six_digits() -> None:
    error = unclosed(np.array([1.23456789, -0.02, np.pi / 3, -5.0]))
    assert str(error) == ("the bars cannot close at x 1234.57 mm, y -20 mm, theta 60°, z -5000 mm")
    assert error.pose == (1.23456789, -0.02, np.pi / 3, -5.0)
    assert (error.leg, error.limit, error.excess) == (0, "configuration", 0.0)


def test_inertias_of_no_rigid_body_are_refused() -> None:
    odd = APPENDIX_4.vary({"inertias.b7_axial": 0.0061, "inertias.b7_transverse": 0.003})
    with pytest.raises(InvalidDesign) as caught:
        build_mechanism(odd)
    assert caught.value.field == "inertias.b7_axial"


def test_what_only_turns_about_the_vertical_is_a_flat_disc() -> None:
    """So that it is a possible body; its inertias about x and y do nothing."""
    design = APPENDIX_4.vary({"payload.inertia": 0.02, "payload.mass": 1.0})
    parts = {part.name: part for link in build_mechanism(design).links for part in link.parts}
    for name in ("platform", "payload", "leg2_B10", "leg3_B2"):
        x, y, z = parts[name].inertia
        assert x == y == 0.5 * z > 0.0


def test_a_flat_disc_is_just_a_rigid_body() -> None:
    flat = APPENDIX_4.vary({"inertias.b7_axial": 0.0060, "inertias.b7_transverse": 0.003})
    assert build_mechanism(flat).links


@pytest.mark.parametrize(("mass", "inertia"), [(0.0, 0.0), (0.5, 0.0), (0.0, 0.01), (0.5, 0.01)])
def test_a_payload_is_there_if_it_has_mass_or_inertia(mass: float, inertia: float) -> None:
    design = APPENDIX_4.vary({"payload.mass": mass, "payload.inertia": inertia})
    parts = [part for link in build_mechanism(design).links for part in link.parts]
    found = [part for part in parts if part.name == "payload"]
    assert [part.mass for part in found] == ([mass] if mass or inertia else [])
    assert all(part.inertia[2] == inertia for part in found)


def test_counterweights_have_the_numbers_of_the_design_and_stand_in_their_bars() -> None:
    weights = (
        Counterweight("b8", 8, 0.1, 0.8), Counterweight("b3", 7, 0.2, 0.4),
        Counterweight("b8", 9, 0.3, 0.2),
    )  # fmt: skip
    design = replace(APPENDIX_4, counterweights=weights)
    found = {
        part.name: (link.name, part.mass)
        for link in build_mechanism(design).links
        for part in link.parts
        if "counterweight" in part.name
    }
    assert found == {
        f"leg{leg}_counterweight{number}": (f"leg{leg}_{weight.bar.upper()}", weight.mass)
        for leg in (1, 2, 3)
        for number, weight in enumerate(weights, 1)
    }


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("Appendix 4", "Appendix_4"), ("Größe 2/B", "Gro_e_2_B"), ("4 legs", "PAMINSA_4_legs"),
        ("", "PAMINSA"), ("機械", "PAMINSA"), ('a"<&>\\b', "a_b"),
    ],
)  # fmt: skip
def test_models_carry_the_name_of_the_design(name: str, plain: str) -> None:
    """As an identifier where the format takes no other names, and whole where it does."""
    design = replace(APPENDIX_4, name=name)
    assert ET.fromstring(urdf_text(design)).attrib["name"] == identifier(name) == plain
    assert ET.fromstring(mjcf_text(design)).attrib["model"] == name
    usd = usd_text(design)
    assert f'defaultPrim = "{plain}"' in usd
    assert f'def Xform "{plain}" (' in usd
    assert f"rel physics:body1 = </{plain}/base>" in usd
    (shown,) = re.findall(r'displayName = "(.*)"\n', usd)
    assert shown.replace('\\"', '"').replace("\\\\", "\\") == name
