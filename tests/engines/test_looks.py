"""What exported models look like: every format draws the same rods, from end to end."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from paminsa_viz.engines import verification
from paminsa_viz.engines.exported import exported_mjcf, exported_usd
from paminsa_viz.engines.mechanism import Link, Rod, as_cylinder, build_mechanism, link_color
from paminsa_viz.engines.mjcf import SERVO_FREQUENCY, TIME_STEP, Servos, mjcf_text
from paminsa_viz.engines.mujoco_model import play
from paminsa_viz.engines.poses import start_values, workspace_poses
from paminsa_viz.engines.simulated_log import simulate_log
from paminsa_viz.engines.urdf import MOST_EFFORT, MOST_SPEED, urdf_text
from paminsa_viz.engines.usd import usd_text
from paminsa_viz.engines.verification import verify
from paminsa_viz.model.design import APPENDIX_4, PARAMETERS, Design
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.reach import workspace_height, workspace_radius
from paminsa_viz.palette import LEG_COLORS, LIFT_COLOR, PLATFORM, rgb
from tests.engines.test_usd import frame, prims
from tests.support import samples
from tests.support.documentation import defaults_of, missing

WEIGHTED = replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.1, 0.8),))
RANDOM = samples.random_design(np.random.default_rng(7))
SLIM = APPENDIX_4.vary({"geometry.platform_radius": 0.03})
BALL = Rod((0.1, 0.0, 0.2), (0.1, 0.0, 0.2), 0.02)
"""A rod without length, which is drawn as a ball."""


@pytest.fixture(params=["appendix-4", "random", "ball"])
def drawn(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A design and its links, once with a link that has no length."""
    design = RANDOM if request.param == "random" else WEIGHTED
    tree = build_mechanism(design)
    if request.param == "ball":
        links = [
            replace(link, rods=(BALL, *link.rods)) if link.name == "leg2_B10" else link
            for link in tree.links
        ]
        tree = replace(tree, links=tuple(links))
    for module in ("mjcf", "urdf", "usd"):
        monkeypatch.setattr(f"paminsa_viz.engines.{module}.build_mechanism", lambda _: tree)
    return design, tree.links


Drawn = dict[str, list[tuple[Any, Any, float]]]
"""Ends and radius of the rods of each link."""


def ends(place: Any, turn: Rotation, length: float) -> tuple[Any, Any]:
    half = turn.apply([0.0, 0.0, length / 2])
    return place - half, place + half


def numbers(text: str) -> Any:
    return np.array([float(word) for word in text.split()])


def assert_drawn(links: Sequence[Link], found: Drawn) -> None:
    assert found.keys() == {link.name for link in links}
    for link in links:
        drawn = found[link.name]
        assert len(drawn) == len(link.rods)
        for (start, end, radius), rod in zip(drawn, link.rods, strict=True):
            np.testing.assert_allclose([start, end], [rod.start, rod.end], atol=1e-12)
            assert radius == rod.radius


points = st.tuples(*[st.sampled_from([-0.4, 0.0, 0.3])] * 3)


@given(start=points, end=points)
def test_a_cylinder_goes_from_end_to_end(start: Any, end: Any) -> None:
    bar = as_cylinder(Rod(start, end, 0.02))
    if start == end:
        assert bar is None
        return
    assert bar is not None
    found = ends(np.array(bar.middle), bar.turn, bar.length)
    np.testing.assert_allclose(found, [start, end], atol=1e-12)
    assert bar.radius == 0.02


def test_looks_grow_with_the_robot() -> None:
    lengths = {
        item.path: 2.0 * APPENDIX_4.value(item.path)
        for item in PARAMETERS
        if item.group == "geometry" and item.unit == "m" and APPENDIX_4.value(item.path)
    }
    one, two = (build_mechanism(d).links for d in (APPENDIX_4, APPENDIX_4.vary(lengths)))
    for small, large in zip(one, two, strict=True):
        assert small.rods
        for rod, other in zip(small.rods, large.rods, strict=True):
            assert other.radius == pytest.approx(2.0 * rod.radius)
            assert rod.radius < 0.2 * APPENDIX_4.geometry.base_radius
            np.testing.assert_allclose(
                [other.start, other.end], 2.0 * np.array([rod.start, rod.end]), atol=1e-15
            )


def test_rods_reach_the_joints_of_their_link() -> None:
    """Where a link is joined to others; the platform's have posts from its plane to its joints."""
    mechanism = build_mechanism(APPENDIX_4)
    places: dict[str, list[Any]] = {link.name: [(0.0, 0.0, 0.0)] for link in mechanism.links}
    for link in mechanism.links:
        if link.parent is not None:
            places[link.parent].append(link.place)
    for pin in mechanism.pins:
        places[pin.first].append(pin.first_point)
        places[pin.second].append(pin.second_point)
    for link in mechanism.links:
        starts = np.array([rod.start for rod in link.rods])
        ways = np.array([rod.end for rod in link.rods]) - starts
        for place in np.array(places[link.name]):
            share = np.einsum("ij,ij->i", place - starts, ways) / (ways**2).sum(axis=1)
            nearest = starts + np.clip(share, 0.0, 1.0)[:, None] * ways
            assert np.linalg.norm(place - nearest, axis=1).min() < 1e-12, link.name
    (platform, lift, *_) = mechanism.links
    assert len(platform.rods) == 6
    assert len(lift.rods) == 3
    flat = APPENDIX_4.vary({"geometry.platform_joint_height": 0.0})
    assert len(build_mechanism(flat).links[0].rods) == 3  # no posts


@pytest.mark.parametrize("design", [APPENDIX_4, RANDOM, SLIM], ids=["paper", "random", "slim"])
def test_rods_are_as_thick_as_documented(design: Design) -> None:
    said = [
        "radius is 1.5 % of crank plus coupler, 1.2 times that at guides and twice at sliders",
        "3 % of the base radius at the arms of the lift",
        "for the platform 6 % of its radius, or of a fifth of the base radius where that is more",
        "its arms are twice as thick",
        "camera starts at 120° and looks down 15° at an extent of 1.5 times crank plus coupler",
        "has a ball for each other mass, 1.3 times as thick as its link",
    ]
    assert missing("drawn-sizes", said) == []
    g = design.geometry
    bar = 0.015 * (g.crank_length + g.coupler_length)
    post = max(0.06 * g.platform_radius, 0.012 * g.base_radius)
    wanted = {"platform": [2 * post] * 3 + [post] * 3, "lift": [0.03 * g.base_radius] * 3}
    of_leg = {"B10": 1.2 * bar, "slider": 2 * bar}
    for link in build_mechanism(design).links:
        thick = wanted.get(link.name) or [of_leg.get(link.name.partition("_")[2], bar)]
        assert [rod.radius for rod in link.rods] == pytest.approx(thick)
    view = ET.fromstring(mjcf_text(design)).find("visual/global")
    assert view is not None
    assert (view.attrib["azimuth"], view.attrib["elevation"]) == ("120", "-15")


def test_links_have_the_colors_of_their_legs() -> None:
    for link in build_mechanism(APPENDIX_4).links:
        color = PLATFORM if link.name == "platform" else LIFT_COLOR
        color = color if link.leg is None else LEG_COLORS[link.leg]
        np.testing.assert_allclose(link_color(link), np.array(rgb(color)) / 255, atol=5e-5)


def test_mjcf_draws_the_rods_and_a_ball_for_each_other_mass(drawn: Any) -> None:
    design, links = drawn
    root = ET.fromstring(mjcf_text(design))
    bodies = {body.attrib["name"]: body for body in root.iter("body")}
    found: Drawn = {}
    for link in links:
        found[link.name] = []
        color = [*link_color(link), 1.0]
        for geom in bodies[link.name].findall("geom"):
            radius = float(geom.attrib["size"])
            if geom.attrib["type"] == "sphere":
                start = end = numbers(geom.attrib["pos"])
            else:
                assert geom.attrib["type"] == "capsule"
                start, end = numbers(geom.attrib["fromto"]).reshape(2, 3)
            found[link.name].append((start, end, radius))
            np.testing.assert_allclose(numbers(geom.attrib["rgba"]), color)
        for part in link.parts[1:]:
            balls = bodies[part.name].findall("geom")
            assert len(balls) == (part.name != "payload")
            for ball in balls:
                np.testing.assert_allclose(numbers(ball.attrib["pos"]), part.center)
                assert float(ball.attrib["size"]) == pytest.approx(1.3 * link.rods[0].radius)
                np.testing.assert_allclose(numbers(ball.attrib["rgba"]), color)
    assert_drawn(links, found)


def test_mjcf_is_seen_whole_from_aside_and_lit_from_above() -> None:
    text = mjcf_text(APPENDIX_4, pose=[0.05, 0.0, 0.1, -0.6])
    root = ET.fromstring(text)

    def of(path: str) -> Any:
        found = root.find(path)
        assert found is not None
        return found.attrib

    center, extent = numbers(of("statistic")["center"]), float(of("statistic")["extent"])
    np.testing.assert_allclose(center, [0.0, 0.0, -0.3])  # between guides and platform
    g = APPENDIX_4.geometry
    for far in ((g.base_radius, 0.0, 0.0), (0.05, 0.0, -0.6)):
        assert np.linalg.norm(far - center) < extent
    assert extent == pytest.approx(1.5 * (g.crank_length + g.coupler_length))
    assert float(of("visual/global")["elevation"]) < 0  # the camera looks down
    light = of("worldbody/light")
    place, way = numbers(light["pos"]), numbers(light["dir"])
    np.testing.assert_allclose([place[:2], way[:2]], 0.0)
    assert place[2] > g.crank_length
    assert way[2] < 0
    defaults = of("default/geom")
    assert [float(defaults[name]) for name in ("contype", "conaffinity", "mass")] == [0, 0, 0]
    assert int(defaults["group"]) < 3 <= int(of("default/site")["group"])  # what a viewer shows
    assert numbers(of("default/equality")["solref"]) == pytest.approx([2 * TIME_STEP, 1.0])


def test_servos_and_time_steps_are_those_of_the_documentation() -> None:
    said = f"servos of {SERVO_FREQUENCY:g} rad/s in time steps of {1e3 * TIME_STEP:g} ms"
    assert missing("verification", [said]) == []


def test_servos_are_critically_damped_where_the_other_actuators_are_free() -> None:
    """A unit torque on one gives it (M^-1)_ii; m q'' + d q' + k q = 0 has a double root."""
    rng = np.random.default_rng(3)
    half = rng.normal(size=(4, 4))
    inertia = half @ half.T + np.eye(4)
    found = Servos.critical(inertia)
    for i in range(4):
        felt = 1.0 / np.linalg.solve(inertia, np.eye(4)[i])[i]
        roots = np.roots([felt, found.damping[i], found.stiffness[i]])
        np.testing.assert_allclose(roots, -SERVO_FREQUENCY, rtol=1e-6)


def test_actuators_of_mjcf_are_servos_about_the_start_or_motors_with_what_holds_it() -> None:
    """Affine in position, speed and control: gain c + holding - gain (q - q_0) - damping q'."""
    design = replace(WEIGHTED, load=LoadCase(force_z=-20.0))
    pose = np.array([0.03, -0.02, 0.2, -0.55])
    start, joints = start_values(design, pose), build_mechanism(design).actuated
    holding = (1.0, -2.0, 3.0, 250.0)
    servos = Servos((10.0, 20.0, 30.0, 400.0), (1.0, 2.0, 3.0, 40.0))
    g = design.geometry
    for chosen in (servos, None):
        root = ET.fromstring(
            mjcf_text(design, pose=pose.tolist(), holding=holding, servos=chosen, load=True)
        )
        found = root.find("actuator")
        assert found is not None
        *motors, load = [dict(one.attrib) for one in found]
        assert [one["name"] for one in motors] == ["M1", "M2", "M3", "M4"]
        assert [one["joint"] for one in motors] == list(joints)
        assert load["name"] == "load"
        assert numbers(load["ctrlrange"]).tolist() == [-1.0, 1.0]  # -1 takes the load away
        assert numbers(load["gear"]).tolist() == list(design.load.wrench)
        assert (numbers(load["biasprm"]).tolist(), load["gainprm"]) == ([1.0, 0.0, 0.0], "1")
        key = root.find("keyframe/key")
        if chosen is None:
            assert key is not None
            assert numbers(key.attrib["ctrl"]).tolist() == [*holding, 0.0]
            continue
        assert key is None
        for j, one in enumerate(motors):
            gain, damping = servos.stiffness[j], servos.damping[j]
            assert float(one["gainprm"]) == gain
            bias = [holding[j] + gain * start[joints[j]], -gain, -damping]
            np.testing.assert_allclose(numbers(one["biasprm"]), bias)
            low, high = numbers(one["ctrlrange"])
            assert low == -high
            most = np.pi / 3 if j < 3 else 0.3 * (g.crank_length + g.coupler_length)
            assert high == pytest.approx(most)


def test_numbers_of_the_command_line_are_those_of_the_program() -> None:
    sentences = [
        f"| `--poses N` | `{verification.POSES}` |",
        f"| `--tolerance X` | `{verification.TOLERANCE}` |",
    ]
    assert missing("command-line", sentences) == []


@pytest.mark.parametrize(
    ("function", "defaults"),
    [
        (verify, {"poses": verification.POSES, "seed": 0, "tolerance": verification.TOLERANCE}),
        (play, {"step": 1e-4, "limit": np.inf, "loads": None}),
        (simulate_log, {"rate": 1000.0, "seed": 0}),
        (mjcf_text, {"holding": (0.0,) * 4, "servos": None, "load": False}),
        (exported_mjcf, {"pose": None, "servos": True}),
        (exported_usd, {"pose": None, "servos": True}),
        (workspace_poses, {"seed": 0}),
    ],
)
def test_defaults_are_those_of_the_descriptions(function: Any, defaults: dict[str, Any]) -> None:
    """Servos that hold the start pose, steps of a tenth of a millisecond, 1 kHz."""
    assert defaults_of(function, defaults) == defaults


def test_sites_of_mjcf_are_where_its_loads_and_loops_are() -> None:
    load = LoadCase(5.0, 0.0, -20.0, point_x=0.05, point_y=-0.02, point_z=0.1)
    root = ET.fromstring(exported_mjcf(replace(APPENDIX_4, load=load)))
    sites = {site.attrib["name"]: numbers(site.attrib["pos"]) for site in root.iter("site")
             if "pos" in site.attrib}  # fmt: skip
    np.testing.assert_allclose(sites["load"], [0.05, -0.02, 0.1])
    np.testing.assert_allclose(sites["world"], 0.0)
    for pin in build_mechanism(APPENDIX_4).pins:
        np.testing.assert_allclose(sites[f"{pin.name}_a"], pin.first_point)
        np.testing.assert_allclose(sites[f"{pin.name}_b"], pin.second_point)


def test_urdf_draws_the_rods(drawn: Any) -> None:
    root = ET.fromstring(urdf_text(drawn[0]))
    links = {link.name: link for link in drawn[1]}
    found: Drawn = {}
    for element in root.findall("link"):
        name = element.attrib["name"]
        if name not in links:  # the base, and those between the platform's joints
            assert element.find("visual") is None
            continue
        found[name] = []
        for visual in element.findall("visual"):
            shape = visual.find("geometry/*")
            origin, color = visual.find("origin"), visual.find("material/color")
            assert shape is not None
            assert origin is not None
            assert color is not None
            place, rpy = (numbers(origin.attrib[key]) for key in ("xyz", "rpy"))
            length = float(shape.attrib.get("length", 0.0))
            assert (length == 0.0) == (shape.tag == "sphere")
            pair = ends(place, Rotation.from_euler("xyz", rpy), length)
            found[name].append((*pair, float(shape.attrib["radius"])))
            expected = [*link_color(links[name]), 1.0]
            np.testing.assert_allclose(numbers(color.attrib["rgba"]), expected)
        inertia = element.find("inertial/inertia")
        origin = element.find("inertial/origin")
        assert inertia is not None
        assert origin is not None
        assert {inertia.attrib[key] for key in ("ixy", "ixz", "iyz")} == {"0.0"}
        assert not numbers(origin.attrib["rpy"]).any()
    assert_drawn(drawn[1], found)


def test_sliding_joints_of_the_urdf_reach_all_of_the_workspace_to_both_sides() -> None:
    g = APPENDIX_4.geometry
    joints = ET.fromstring(urdf_text(APPENDIX_4)).findall("joint")
    sliding = [joint for joint in joints if joint.attrib["type"] == "prismatic"]
    assert len(sliding) == 3 + 1 + 3 * 2
    for joint in sliding:
        limit = joint.find("limit")
        assert limit is not None
        low, high, effort, speed = (
            float(limit.attrib[key]) for key in ("lower", "upper", "effort", "velocity")
        )
        assert low == -high
        assert high == pytest.approx(2.0 * (workspace_radius(g) + workspace_height(g)))
        assert (effort, speed) == (MOST_EFFORT, MOST_SPEED)
    said = (
        f"limits that the format demands: {MOST_EFFORT:g} N and {MOST_SPEED:g} m/s, which are not"
    )
    assert missing("machine", [f"{said} the robot's, and to both sides twice its radius"]) == []
    offsets = [float(mimic.attrib["offset"]) for joint in joints for mimic in joint.iter("mimic")]
    assert offsets == [0.0] * 6


def test_usd_draws_the_rods(drawn: Any) -> None:
    text = usd_text(drawn[0])
    links = {link.name: link for link in drawn[1]}
    found: Drawn = {}
    for name, link in links.items():
        inside = text.partition(f'    def Xform "{name}"')[2].partition("\n    }")[0]
        rods = prims(inside + "\n", "        ")
        found[name] = []
        assert list(rods) == [f"rod{number}" for number in range(1, len(link.rods) + 1)]
        for kind, _, own in rods.values():
            length = own.get("height", 0.0)
            assert (length == 0.0) == (kind == "Sphere")
            found[name].append((*ends(*frame((kind, "", own)), length), own["radius"]))
            assert own.get("axis", "Z") == "Z"
            color = own["primvars:displayColor"]
            assert str(color).strip("[]()").split(", ") == [repr(c) for c in link_color(link)]
    assert_drawn(drawn[1], found)
