"""A leg in its plane by hand: Castigliano's theorem on the pin forces of a pantograph."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics.beams import tube_fits
from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.elastostatics.leg_loads import _two_force_bars
from paminsa_viz.elastostatics.stiffness import leg_compliance, platform_stiffness
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.reach import home_pose
from tests.elastostatics.robots import elastic_design

HEIGHTS = (-0.35, -0.6, -0.8)


def integral(moment, length: float) -> float:
    """Integral of the square of a bending moment over a bar, by Gauss's rule."""
    x, w = np.polynomial.legendre.leggauss(4)
    places = 0.5 * length * (x + 1)
    return float(0.5 * length * w @ np.array([moment(s) ** 2 for s in places]))


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("seed", [0, 9])
def test_vertical_compliance_of_a_leg_in_the_plane_of_its_arm(seed: int, height: float) -> None:
    """Centered at theta = 0 arms lie in the planes of their legs, and nothing leaves the planes."""
    design = elastic_design(seed, soft_joints=False) if seed else APPENDIX_4
    g, e = design.geometry, design.elastic
    pose = np.array([0.0, 0.0, 0.0, height * g.coupler_length / 0.63 * g.knee.sign])
    found = inverse_kinematics(g, pose)
    axis = g.base_radius * np.array([0.0, 1.0, 0.0])  # of leg 3, whose plane is x = 0
    at = {}
    for joint, place in found.points.items():
        at[joint] = np.array([axis[1] - place[2][1], place[2][2]])

    # unknown pin forces, in the plane: on B4 at 9 and 4, on B3 at 7 and 3; 1 N up at joint 5
    def cross(a, b) -> float:
        return a[0] * b[1] - a[1] * b[0]

    rows, right = [], []
    unknown = {9: 0, 4: 2, 7: 4, 3: 6}  # B8 and B7 carry along themselves alone

    def equation(forces, value: float) -> None:
        row = np.zeros(8)
        for joint, factor, component in forces:
            row[unknown[joint] + component] += factor
        rows.append(row)
        right.append(value)

    for component, load in ((0, 0.0), (1, 1.0)):
        equation([(9, 1.0, component), (4, 1.0, component)], -load)
        equation([(7, 1.0, component), (3, 1.0, component), (4, -1.0, component)], 0.0)
    arm = at[9] - at[4]
    equation([(9, arm[0], 1), (9, -arm[1], 0)], -cross(at[5] - at[4], (0.0, 1.0)))
    up, down = at[4] - at[3], at[7] - at[3]
    equation([(4, -up[0], 1), (4, up[1], 0), (7, down[0], 1), (7, -down[1], 0)], 0.0)
    for joint, other in ((9, 8), (7, 8)):
        along = at[joint] - at[other]
        equation([(joint, along[0], 1), (joint, -along[1], 0)], 0.0)
    force = np.linalg.solve(rows, right)
    pin = {joint: force[i : i + 2] for joint, i in unknown.items()}
    np.testing.assert_allclose(pin[3], [0.0, -g.magnification], atol=1e-12)

    young = e.young_modulus
    compliance = 0.0

    def bar(name: str, first: int, second: int, pull: np.ndarray) -> float:
        """Add a bar's energy for a force on its second end, its moment zero there; its tension."""
        nonlocal compliance
        along = at[second] - at[first]
        length = float(np.hypot(*along))
        section = e.section(name)
        axial, shear = pull @ along / length, cross(along, pull) / length
        compliance += axial**2 * length / (young * section.area)
        compliance += integral(lambda s: shear * s, length) / (young * section.inertia_in)
        return float(axial)

    up5 = np.array([0.0, 1.0])
    bar("b4", 4, 5, up5)
    bar("b4", 4, 9, pin[9])
    bar("b3", 3, 4, -pin[4])
    bar("b3", 3, 7, pin[7])
    pulled = bar("b8", 8, 9, -pin[9]), bar("b7", 8, 7, -pin[7])
    pressed = _two_force_bars(leg_frame(g, pose))
    assert [float(bars[2]) for bars in pressed] == pytest.approx([-pull for pull in pulled])
    k = g.magnification
    compliance += k**2 * g.shaft_length / (young * e.section("b2").area)
    compliance += k**2 * g.arm_length**3 / (3 * young * e.section("b1").inertia_in)
    reach = abs(at[8][0])
    compliance += (k - 1) ** 2 * reach**3 / (3 * young * e.section("b10").inertia_in)

    leg = leg_compliance(leg_frame(g, pose), e).matrix[2]
    assert leg[1, 1] == pytest.approx(compliance, rel=1e-9)
    assert abs(leg[0, 1]) < 1e-12 * leg[1, 1]
    whole = platform_stiffness(design, pose).compliance
    lifted = (compliance + 3 * k**2 / e.drive_linear) / 3
    assert whole[2, 2] == pytest.approx(lifted, rel=1e-9)


def test_a_design_whose_bars_are_tubes_is_its_tubes() -> None:
    """Mass and inertias of hollow cylinders, by sums over thin rings; then twice as heavy bars."""
    design = elastic_design(4, soft_joints=False)
    own = design.elastic
    points = inverse_kinematics(design.geometry, home_pose(design.geometry)).points
    numbers: dict[str, float | None] = {}
    lengths = {}
    for bar, (first, last) in BAR_ENDS.items():
        length = float(np.linalg.norm(points[last][0] - points[first][0]))
        edges = np.linspace(getattr(own, f"{bar}_inner"), getattr(own, f"{bar}_outer"), 2001) / 2
        radius, rings = (edges[1:] + edges[:-1]) / 2, np.pi * np.diff(edges**2)
        mass = own.density * length * float(rings.sum())
        axial = own.density * length * float(rings @ radius**2)
        lengths[bar.upper()] = length
        numbers |= {
            f"links.{bar}": mass,
            f"inertias.{bar}_axial": axial,
            f"inertias.{bar}_transverse": axial / 2 + mass * length**2 / 12,
        }
    twice = {path: 2 * value for path, value in numbers.items() if value is not None}
    for factor, found in (
        (1.0, tube_fits(design.vary(numbers))),
        (2.0, tube_fits(design.vary(twice))),
    ):
        assert [fit.bar for fit in found] == sorted(lengths)
        for fit in found:
            bar, length = fit.bar.lower(), lengths[fit.bar]
            mass, axial, across = (
                numbers[path]
                for path in (f"links.{bar}", f"inertias.{bar}_axial", f"inertias.{bar}_transverse")
            )
            assert fit.length == pytest.approx(length)
            assert fit.mass == pytest.approx(mass)
            assert (fit.mass_ratio, fit.axial_ratio, fit.transverse_ratio) == pytest.approx(
                (factor, 1.0, 1.0), rel=1e-5
            )
            assert (fit.axial, fit.transverse) == pytest.approx(
                (factor * axial, factor * across), rel=1e-5
            )
            assert fit.slender == pytest.approx(factor * mass * length**2 / 12)
            assert fit.slender_ratio == pytest.approx(across / (mass * length**2 / 12))
    light = design.vary({"links.b4": 0.0, "inertias.b4_transverse": 0.0, "inertias.b4_axial": 0.0})
    fit = next(fit for fit in tube_fits(light) if fit.bar == "B4")
    assert np.isnan([fit.slender_ratio, fit.transverse_ratio, fit.axial_ratio]).all()
