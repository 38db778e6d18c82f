"""Masses nearest to a design that explain a log."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.design_file import load_design, save_design
from paminsa_viz.identification import (
    IdentificationSettings,
    base_parameters,
    identify,
    nearest_masses,
)
from paminsa_viz.identification.base_parameters import mass_columns
from paminsa_viz.identification.nearest import (
    MassEstimate,
    _drive,
    _prior_deviation,
    _told,
    _with_actuators,
)
from paminsa_viz.model import APPENDIX_4, Design, Friction, Geometry
from paminsa_viz.model.design import PARAMETER
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import Counterweight
from tests.support.identification_logs import simulated

QUICK = IdentificationSettings(robustness=False)
BUILT = replace(
    APPENDIX_4.vary({"links.b4": 0.8, "joints.j9": 0.4, "platform.mass": 3.0}),
    friction=Friction(0.3, 0.4, 20.0, 8.0),
)


@pytest.fixture(scope="module")
def identified() -> Any:
    return identify(APPENDIX_4, simulated(1, BUILT, rate=500.0, noise_seed=1), QUICK)


def test_the_written_design_explains_the_log(identified: Any, tmp_path: Any) -> None:
    found = nearest_masses(identified)
    save_design(found.design, tmp_path / "built.toml")
    design = load_design(tmp_path / "built.toml")
    assert design == found.design
    b = base_parameters(design)
    for symbol, value in zip(("b_1", "M_p2", "b_6", "b_7"), b[[0, 1, 5, 6]], strict=True):
        estimate = identified.estimate(symbol)
        assert estimate.low < value < estimate.high
    assert found.misfit < 1.0
    assert design.actuator_friction.viscous == pytest.approx((0.3, 0.3, 0.3, 20.0), rel=0.5)
    assert design.actuator_friction.coulomb == pytest.approx((0.4, 0.4, 0.4, 8.0), rel=0.2)
    assert design.friction.transition_speed == APPENDIX_4.friction.transition_speed


def test_masses_say_whether_the_log_adds_anything(identified: Any) -> None:
    masses = {item.parameter.path: item for item in nearest_masses(identified).masses}
    assert masses["platform.mass"].told
    assert masses["links.b4"].told
    assert not masses["joints.j2"].told  # with joint 3 and the shaft it is one weight
    assert not masses["inertias.b4_axial"].told
    for item in masses.values():
        assert 0 < item.deviation <= item.prior_deviation * (1 + 1e-9)
        assert abs(item.value - BUILT.value(item.parameter.path)) < 3 * item.deviation
    assert "payload.mass" not in masses


def test_an_exact_log_of_the_design_returns_the_design() -> None:
    log = simulated(1, APPENDIX_4, rate=500.0, noise_seed=None)
    found = nearest_masses(identify(APPENDIX_4, log, QUICK))
    for item in found.masses:
        assert item.value == pytest.approx(item.prior, rel=0.02)


def test_deviations_are_right_however_sure_a_log_is(identified: Any) -> None:
    """Of one without noise only what is left beside the ten combinations that it tells counts.

    It tells 1e16 times as much as the designer's word, and the sum of both has no inverse.
    """
    solution = identified.solution
    spread = 1e-8 * (solution.without - solution.x)
    sure = replace(identified, solution=replace(solution, without=solution.x + spread))
    masses = nearest_masses(sure).masses
    prior = np.array([item.prior_deviation for item in masses])
    free = [MASS_PATHS.index(item.parameter.path) for item in masses]
    told = np.linalg.svd(mass_columns(APPENDIX_4)[0][:, free] * prior)[2][:10]
    left = prior * np.sqrt(1.0 - (told**2).sum(axis=0))
    np.testing.assert_allclose([item.deviation for item in masses], left, rtol=1e-6)


def test_masses_of_a_robot_a_hundredth_as_large_are_not_taken_for_zero() -> None:
    """Its inertias are 1e-10 of the prototype's, and so is its friction."""
    units = {"m": 1e-2, "kg": 1e-6, "kg m^2": 1e-10}
    paths = [*(f"geometry.{item.name}" for item in fields(Geometry)), *MASS_PATHS]
    sizes = {
        path: BUILT.value(path) * units[PARAMETER[path].unit]
        for path in paths
        if path in PARAMETER and PARAMETER[path].unit and path != "geometry.guide_stroke"
    }
    small = replace(BUILT.vary(sizes), friction=Friction(0.3e-8, 0.4e-8, 20e-6, 8e-6, 1e-3))
    found = nearest_masses(identify(small, simulated(1, small, rate=50.0, noise_seed=None), QUICK))
    for item in found.masses:
        assert item.value == pytest.approx(item.prior, rel=0.05)
    viscous, coulomb, _ = found.design.actuator_friction
    assert viscous == pytest.approx((0.3e-8,) * 3 + (20e-6,), rel=0.05)
    assert coulomb == pytest.approx((0.4e-8,) * 3 + (8e-6,), rel=0.05)


def test_a_payload_that_is_known_is_taken_off_what_the_log_says() -> None:
    """The payload is the design's: an exact log of the robot with it returns the other masses."""
    design = APPENDIX_4.vary({"payload.mass": 2.5, "payload.inertia": 0.01})
    log = simulated(1, design, rate=250.0, noise_seed=None)
    found = nearest_masses(identify(design, log, QUICK))
    assert found.design.payload == design.payload
    for item in found.masses:
        assert item.value == pytest.approx(item.prior, rel=0.02)


def test_masses_stay_possible_whatever_the_log_says(identified: Any) -> None:
    light = APPENDIX_4.vary(
        {"links.b4": 0.0, "inertias.b4_transverse": 0.0, "inertias.b4_axial": 0.0}
    )
    heavy = light.vary({"platform.mass": 9.0, "links.b8": 2.0, "inertias.b8_axial": 0.04})
    against = replace(identified, design=heavy)
    design = nearest_masses(against, spread=0.05).design
    inertias = design.inertias
    for bar in ("b3", "b4", "b7", "b8"):
        axial = getattr(inertias, f"{bar}_axial")
        assert 0 <= axial <= 2 * getattr(inertias, f"{bar}_transverse") + 1e-12
    assert np.isfinite([design.value(path) for path in ("links.b4", "platform.mass")]).all()
    with pytest.raises(InvalidInput, match="above 0"):
        nearest_masses(identified, spread=0.0)


def test_a_fit_that_holds_the_identity_tells_the_masses_too() -> None:
    """Of a right robot's log without noise, the ten parameters that are left give the design."""
    settings = replace(QUICK, constrain=True)
    log = simulated(1, BUILT, noise_seed=None, rate=250.0)
    found = nearest_masses(identify(BUILT, log, settings))
    assert found.misfit < 1e-2
    np.testing.assert_allclose(
        base_parameters(found.design), base_parameters(BUILT), rtol=1e-3, atol=1e-4
    )
    other = nearest_masses(identify(APPENDIX_4, log, settings))
    np.testing.assert_allclose(
        base_parameters(other.design)[5:], base_parameters(BUILT)[5:], rtol=1e-2, atol=1e-3
    )


def test_friction_and_rotors_go_to_the_drives() -> None:
    ratio = 20.0
    drives = tuple(
        Drive(name="d", rotor_inertia=inertia, gear_ratio=ratio, viscous=1e-4)
        for inertia in (1e-4, 1e-4, 1.6e-4)
    )
    built: Design = replace(BUILT, drives=(*drives, None))
    meant: Design = replace(BUILT, drives=(drives[0],) * 3 + (None,))
    settings = replace(QUICK, rotors=True)
    found = identify(meant, simulated(1, built, rate=500.0), settings)
    design = nearest_masses(found).design
    expected = np.array(built.drive_inertia[:3])
    differences = np.array(design.drive_inertia[:3]) - np.mean(design.drive_inertia[:3])
    if found.estimate("ΔJ_1").known:
        np.testing.assert_allclose(differences, expected - expected.mean(), atol=4e-3)
    assert design.drives[0] is not None
    assert design.drives[0].gear_ratio == ratio
    assert design.actuator_friction.viscous[0] == pytest.approx(0.34, rel=0.2)
    assert design.actuator_friction.coulomb[3] == pytest.approx(8.0, rel=0.3)
    assert found.estimate("ΔJ_1").value == pytest.approx(-8e-3, abs=4e-3)


def test_rotors_keep_their_mean_and_differ_as_the_log_says() -> None:
    """Only differences of M1..M3 are told: with all well above zero their mean is the design's."""
    drives = tuple(
        Drive(name="d", rotor_inertia=inertia, gear_ratio=20.0) for inertia in (1e-4, 2e-4, 4.5e-4)
    )
    axis = Drive(name="axis", transmission="screw", lead=0.01, rotor_inertia=1e-5)
    design = replace(BUILT, drives=(*drives, axis))
    settings = replace(QUICK, rotors=True)
    found = identify(design, simulated(1, design, noise_seed=None, rate=250.0), settings)
    before = np.array(design.drive_inertia[:3])
    told = [found.estimate(name).value for name in ("ΔJ_1", "ΔJ_2")]
    *rotors, lift = nearest_masses(found).design.drive_inertia
    assert lift == pytest.approx(design.drive_inertia[3], rel=1e-12)
    after = np.array(rotors)
    assert after.mean() == pytest.approx(before.mean(), rel=1e-9)
    np.testing.assert_allclose(after[:2] - after.mean(), told, atol=1e-12)
    # what the log is compared with is the design's own difference from the mean
    meant = [found.estimate(name).parameter.design for name in ("ΔJ_1", "ΔJ_2")]
    np.testing.assert_allclose(meant, before[:2] - before.mean(), rtol=1e-12)


def test_one_difference_of_two_rotors_says_nothing_of_the_third() -> None:
    """M1 minus the mean alone could come with any M2 and M3: the design's rotors stay."""
    drives = tuple(
        Drive(name="d", rotor_inertia=inertia, gear_ratio=20.0) for inertia in (1e-4, 2e-4, 4.5e-4)
    )
    design = replace(BUILT, drives=(*drives, None))
    log = simulated(1, design, noise_seed=None, rate=250.0)
    found = identify(design, log, replace(QUICK, rotors=True))
    for hidden in ("ΔJ_1", "ΔJ_2"):
        less = replace(found, estimates=tuple(e for e in found.estimates if e.symbol != hidden))
        after = nearest_masses(less).design.drive_inertia
        assert after == pytest.approx(design.drive_inertia, rel=1e-12)


def test_a_mass_of_nothing_is_believed_to_be_a_tenth_of_those_like_it() -> None:
    """Of the same group and unit: its spread is a share of that, of others of themselves."""
    paths = ["links.b3", "links.b4", "links.b7", "joints.j3", "inertias.b3_axial"]
    prior = np.array([0.0, 0.4, 0.8, 0.02, 0.0])
    found = _prior_deviation(paths, prior, 0.3)
    typical = 0.6  # the median of those above zero
    expected = [0.1 * typical, 0.4, 0.8, 0.02, 0.1 * 0.8]  # no other inertia: the largest of all
    np.testing.assert_allclose(found, 0.3 * np.array(expected))
    tiny = _prior_deviation(["links.b3", "links.b4"], np.array([1e-3, 0.8]), 0.3)
    np.testing.assert_allclose(tiny, [0.3 * 0.1 * (1e-3 + 0.8) / 2, 0.3 * 0.8])


def test_what_a_log_tells_is_its_information_without_all_that_is_no_mass(identified: Any) -> None:
    """By the covariance of the eleven alone; deviations and misfit are those that follow from it.

    What moves with each mass is taken by differences.
    """
    root, target = _told(identified)
    solution = identified.solution
    assert solution.hidden.shape[1] == 0
    size = np.sqrt(np.diag(solution.information))
    covariance = np.linalg.inv(solution.information / size / size[:, None]) / size / size[:, None]
    expected = np.linalg.inv(covariance[:11, :11]) / solution.widening**2
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        root.T @ root / scale / scale[:, None], expected / scale / scale[:, None], atol=1e-6
    )
    np.testing.assert_allclose(target, root @ solution.x[:11])
    found = nearest_masses(identified)
    left = root @ base_parameters(found.design) - target
    assert found.misfit == pytest.approx(np.sqrt((left**2).sum() / 11), rel=1e-6)
    paths = [item.parameter.path for item in found.masses]
    steps = np.array([0.01 * found.design.value(path) + 1e-4 for path in paths])
    slopes = [
        (base_parameters(found.design.vary({path: found.design.value(path) + step}))
         - base_parameters(found.design)) / step
        for path, step in zip(paths, steps, strict=True)
    ]  # fmt: skip
    inverse = np.diag([1 / item.prior_deviation**2 for item in found.masses])
    precise = np.array(slopes) @ root.T @ root @ np.array(slopes).T + inverse
    deviations = np.sqrt(np.diag(np.linalg.inv(precise)))
    np.testing.assert_allclose([item.deviation for item in found.masses], deviations, rtol=1e-6)


@pytest.mark.parametrize(("share", "told"), [(1.05e-11, 11), (0.95e-11, 10)])
def test_what_is_left_without_the_others_is_told_down_to_a_smallest_eigenvalue(
    share: float, told: int
) -> None:
    """Two masses of correlation c, and one that goes along with friction; nothing shows an offset.

    By hand: with a correlation of 1/2, three quarters of what is known of it are left.
    """
    c = (1.0 - share) / (1.0 + share)
    matrix = np.diag([1.0] * 12 + [0.0])
    matrix[[0, 1], [1, 0]], matrix[[2, 11], [11, 2]] = c, 0.5
    size = np.array([10.0 ** (i % 4) for i in range(13)])
    solution = SimpleNamespace(
        information=4.0 * matrix * size * size[:, None], widening=2.0, x=np.arange(13.0)
    )
    settings = SimpleNamespace(constrain=False)
    root, target = _told(SimpleNamespace(solution=solution, settings=settings))  # type: ignore[arg-type]
    assert root.shape == (told, 11)
    expected = matrix[:11, :11]
    expected[2, 2] = 0.75
    np.testing.assert_allclose(root.T @ root / size[:11] / size[:11, None], expected, atol=1e-10)
    np.testing.assert_allclose(target, root @ np.arange(11.0))


def test_the_nearest_masses_are_the_most_likely_ones_that_are_possible(identified: Any) -> None:
    """No possible step away from them is downhill, which for a convex sum of squares is enough.

    A step is one mass; with an axial inertia goes half as much of the transverse one.
    """
    bounded = set()
    meant = APPENDIX_4.vary(
        {"links.b4": 0.0, "inertias.b4_transverse": 0.0, "inertias.b4_axial": 0.0,
         "platform.mass": 9.0, "links.b8": 2.0, "inertias.b8_axial": 0.04,
             "inertias.b8_transverse": 1e-3, "payload.mass": 1.5}
    )  # fmt: skip
    for design in (
        replace(meant, counterweights=(Counterweight("b8", 8, 0.3, 0.5),)),
        replace(APPENDIX_4, counterweights=(Counterweight("b3", 4, 0.5, 9.0),)).vary(
            {"payload.mass": 30.0}
        ),
    ):
        against = replace(identified, design=design)
        root, target = _told(against)
        found = nearest_masses(against, spread=0.05)
        masses = {item.parameter.path: item for item in found.masses}
        b = base_parameters(found.design)
        left = root @ b - target
        assert found.misfit == pytest.approx(np.sqrt((left**2).mean()), rel=1e-6)
        for path, item in masses.items():
            step = {path: 1e-3}
            if path.endswith("_axial"):
                step[path.replace("axial", "transverse")] = 0.5e-3
            moved = found.design.vary({p: masses[p].value + s for p, s in step.items()})
            slope = 2 * left @ root @ (base_parameters(moved) - b) / 1e-3
            pull = [
                2 * (masses[p].value - masses[p].prior) / masses[p].prior_deviation ** 2 * s / 1e-3
                for p, s in step.items()
            ]
            least = 1e-6 * item.prior if path == "platform.mass" else 0.0  # a design needs one
            if path.endswith("_transverse"):
                least = 0.5 * masses[path.replace("transverse", "axial")].value
            size = max(map(abs, [slope, *pull]), default=0.0) + 1e-9
            assert item.value >= least * (1 - 1e-9)
            if item.value > least + 1e-9:
                assert slope + sum(pull) == pytest.approx(0.0, abs=1e-5 * size)
            else:
                bounded.add("half an axial one" if least > 1e-3 else path)
                assert slope + sum(pull) > -1e-5 * size
                assert item.value == pytest.approx(least, rel=1e-9, abs=0.0)
    assert {"platform.mass", "half an axial one"} < bounded
    assert any(path.startswith(("links.", "joints.")) for path in bounded)


def test_without_the_identity_s_third_nothing_is_said_of_it(identified: Any) -> None:
    held = replace(identified, settings=replace(QUICK, constrain=True))
    root, _ = _told(held)
    assert root.shape[1] == 11
    assert not root[:, 2].any()
    assert np.delete(root, 2, axis=1).any(axis=0).all()


def test_a_mass_is_told_if_its_deviation_falls_by_a_tenth() -> None:
    (item,) = (PARAMETER[path] for path in ("links.b4",))
    for deviation, told in ((0.9, True), (0.901, False), (0.5, True)):
        assert MassEstimate(item, 1.0, 1.0, 1.0, deviation).told == told


def test_a_drive_gets_friction_and_inertia_at_its_own_shaft() -> None:
    """Viscous friction and inertia by the ratio's square, less the gear's; nothing is negative."""
    own = Drive("d", rotor_inertia=1e-4, gear_inertia=2e-5, gear_ratio=20.0, coulomb=1.0)
    found = _drive(own, 0.4, 0.6, 0.06, 0.048)
    assert found is not None
    numbers = (found.viscous, found.coulomb, found.rotor_inertia, found.gear_inertia)
    assert numbers == pytest.approx((1e-3, 0.03, 1.3e-4, 2e-5), rel=1e-12)
    same = _drive(own, -0.4, -0.6, 0.048, 0.048)
    assert same == replace(own, viscous=0.0, coulomb=0.0)
    less = _drive(own, 0.0, 0.0, 0.004, 0.048)
    assert less == replace(own, coulomb=0.0, rotor_inertia=0.0)
    assert _drive(None, -1.0, 0.0, 0.0, 0.0) is None
    assert _drive(None, 0.0, 0.0, 1e-12, 0.0) is not None  # a small robot's
    for place in range(3):
        values = 0.5 * np.eye(3)[place]
        made = _drive(None, *values.tolist(), 0.0)
        assert made is not None
        assert [made.viscous, made.coulomb, made.rotor_inertia] == values.tolist()
        assert (made.name, made.ratio) == ("identified", 1.0)


def test_rotors_that_would_be_negative_are_raised_together() -> None:
    """Of a design without drives, whose mean is zero; M4 without a drive keeps its own friction."""

    def item(symbol: str, value: float, known: bool = True) -> Any:
        return SimpleNamespace(symbol=symbol, value=value, known=known)

    design = replace(APPENDIX_4, friction=Friction(0.1, 0.2, 30.0, 4.0, 0.02))
    estimates = [
        item("ΔJ_1", -0.03), item("ΔJ_2", 0.01), item("b_v1", 0.5), item("b_v2", 9.0, known=False),
        item("b_v3", -0.1), item("b_v4", 0.25), item("c_4", -1.0), item("c_1", 0.7),
    ]  # fmt: skip
    found = _with_actuators(SimpleNamespace(design=design, estimates=estimates))  # type: ignore[arg-type]
    np.testing.assert_allclose(found.drive_inertia, [0.0, 0.04, 0.05, 0.0], atol=1e-12)
    assert found.actuator_friction.viscous == pytest.approx((0.5, 0.1, 0.0, 0.25))
    assert found.actuator_friction.coulomb == pytest.approx((0.7, 0.2, 0.2, 0.0))
    assert found.friction == Friction(0.0, 0.0, 0.25, 0.0, 0.02)
