"""Claims on worked numbers of the documentation, each measured in another way than it was found.

Corners of drives by Newton's method where the program has closed forms, sensitivities by
differences, masses as roots of the potential energy's slope, proofs at random poses, volumes by
counting points.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import qmc

from paminsa_viz.balancing import balance
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.energy import potential_energy
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.lumped import lumped_coefficients
from paminsa_viz.model.reach import check_reach, home_pose
from paminsa_viz.model.regressor import regressor_torques, torque_regressor
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.precision.leg_lengths import INDEX, nominal_lengths
from paminsa_viz.precision.manufacture import BAR_LENGTHS, monte_carlo, tolerance_widths
from paminsa_viz.precision.unequal_legs import solve_pose
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.report.claim import Claim
from paminsa_viz.synthesis.volume.grid import Resolution
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.trajectory import PRESET, PRESETS
from paminsa_viz.units import ARCSEC, MM

MICRONS = 1e6

PAYLOAD = 5.0
"""Payload of the table of `docs/drives.md` [kg]."""

VOLUMES = {
    8_000: (31.6, 92.17, 1.40),
    30_000: (20.3, 92.09, 0.75),
    120_000: (12.8, 92.12, 0.44),
    500_000: (8.0, 92.07, 0.34),
    1_000_000: (6.3, 92.05, 0.32),
}
"""By nodes, the table of `docs/requirements.md`: cell [mm], volume and error [dm³]."""

POINTS = 2**18
"""Points of a volume that are counted."""

SLOWER = {
    "paper-like": (4.281, 2.920, 2.497),
    "quintic": (3.528, 2.407, 2.058),
    "trapezoid": (3.450, 2.758, 1.999),
    "s-curve": (4.234, 3.008, 2.068),
    "waypoints": (2.752, 1.929, 1.734),
    "line": (3.683, 1.101, 2.911),
    "circle": (5.487, 5.087, 4.668),
    "arch": (5.640, 3.450, 2.868),
}
"""Factors on the durations there: by the largest change, the peak and the RMS."""


def _corners(poses: Array) -> Array:
    """Return the largest errors at poses (n, 4) in the corners of the drives' box, (n, 5).

    Of x, y, in the plane and z [µm], and of theta [″].
    """
    geometry, half = APPENDIX_4.geometry, np.array(APPENDIX_4.accuracy.half_widths)
    actuators = inverse_kinematics(geometry, poses).actuators
    signs = np.array(list(product((-1.0, 1.0), repeat=4)))[:, None]
    found = solve_pose(geometry, nominal_lengths(geometry), actuators + signs * half, poses)
    x, y, theta, z = np.moveaxis(found.pose - poses, -1, 0)
    sizes = np.abs(
        [MICRONS * x, MICRONS * y, MICRONS * np.hypot(x, y), MICRONS * z, ARCSEC * theta]
    )
    return sizes.max(axis=1).T


def _drive_errors() -> Array:
    return _corners(np.array([home_pose(APPENDIX_4.geometry)]))[0]


def _drive_rms() -> Array:
    """Independent uniform errors, through differences of Newton's solutions."""
    geometry, pose = APPENDIX_4.geometry, np.array(home_pose(APPENDIX_4.geometry))
    lengths, actuators = nominal_lengths(geometry), inverse_kinematics(geometry, pose).actuators
    h = 1e-5
    ends = [
        solve_pose(geometry, lengths, actuators + s * h * np.eye(4), pose).pose for s in (1, -1)
    ]
    slope = (ends[0] - ends[1]) / (2 * h)
    x, y, theta, z = (slope**2).T @ (np.array(APPENDIX_4.accuracy.half_widths) ** 2 / 3.0)
    scales = (MICRONS, MICRONS, MICRONS, MICRONS, ARCSEC)
    return np.sqrt([x, y, x + y, z, theta]) * scales


def _drive_medians() -> Array:
    """Over 2 × 400 poses spread evenly over the disc."""
    g = APPENDIX_4.geometry
    at = (np.arange(400) + 0.5) / 400
    radius, angle = g.base_radius / 2 * np.sqrt(at), np.pi * (3 - np.sqrt(5)) * np.arange(400)
    z = np.full(400, home_pose(g)[3])
    poses = [
        np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(400, theta), z], axis=1)
        for theta in (0.0, np.radians(30.0))
    ]
    return np.median(_corners(np.concatenate(poses)), axis=0)[[2, 4]]


def _unbalance(design: Design) -> float:
    """Return the slope of the potential energy along x through J: a torque of M1."""
    pose, h = np.array([0.1, 0.03, 0.2, -0.5]), 1e-4
    step = h * np.eye(4)
    slope = (potential_energy(design, pose + step) - potential_energy(design, pose - step)) / (
        2 * h
    )
    return float((jacobian(design, pose).T @ slope)[0])


def _balancing_masses() -> Array:
    """Torques are linear in a mass: its root from two of them."""
    before = APPENDIX_4.value("joints.j7")
    one, two = (_unbalance(APPENDIX_4.vary({"joints.j7": mass})) for mass in (before, before + 1.0))
    seventh = before - one / (two - one)
    weight = Counterweight("b3", 7, 0.2, 1.0)
    hung = _unbalance(replace(APPENDIX_4, counterweights=(weight,)))
    return np.array([seventh, 3.0 * (seventh - before), -one / (hung - one)])


def _sensitivities() -> tuple[Array, Array, Array]:
    """Return slopes of x, y, z, theta, tilts by all lengths (6, 3, 14), tolerances, clearances."""
    g, pose = APPENDIX_4.geometry, np.array(home_pose(APPENDIX_4.geometry))
    lengths, actuators = nominal_lengths(g), inverse_kinematics(g, pose).actuators
    h = 1e-6
    changes = h * np.eye(lengths.size).reshape(-1, *lengths.shape)
    one, two = (
        solve_pose(g, lengths + sign * changes, actuators, pose).coordinates for sign in (1, -1)
    )
    slope = ((one - two) / (2 * h)).T.reshape(6, *lengths.shape)[[0, 1, 3, 2, 4, 5]]
    clearance = np.zeros_like(lengths)
    clearance[:, [INDEX[name] for name in BAR_LENGTHS]] = APPENDIX_4.tolerances.pin_clearance / 2
    clearance[:, INDEX["guide_height"]] = APPENDIX_4.tolerances.guide_clearance / 2
    return slope, tolerance_widths(APPENDIX_4.tolerances), clearance


SIZES = np.array([MICRONS, MICRONS, MICRONS, ARCSEC])


def _tolerances_worst() -> Array:
    slope, tolerance, clearance = _sensitivities()
    wide = tolerance + clearance
    straight = (np.abs(slope[:4]) * wide).sum(axis=(1, 2)) * SIZES
    turns = np.linspace(0.0, np.pi, 3601)
    along = np.cos(turns)[:, None, None] * slope[4] + np.sin(turns)[:, None, None] * slope[5]
    tilt = (np.abs(along) * wide).sum(axis=(1, 2)).max() * ARCSEC
    part = (np.abs(slope[:3]) * clearance).sum(axis=(1, 2)) * MICRONS
    return np.array([*straight, tilt, *part])


def _tolerances_rms() -> Array:
    slope, tolerance, clearance = _sensitivities()
    variance = (slope**2 * (tolerance**2 + clearance**2) / 3.0).sum(axis=(1, 2))
    each = ARCSEC * np.sqrt(variance[4])
    return np.array([*np.sqrt(variance[:4]) * SIZES, ARCSEC * np.sqrt(variance[4:].sum()), each])


def _drawn_robots() -> Array:
    errors = monte_carlo(APPENDIX_4, home_pose(APPENDIX_4.geometry), robots=2000).errors
    x, y, theta, z, *tilt = np.sqrt(np.nanmean(errors**2, axis=0))
    return np.array([*np.array([x, y, z]) * MICRONS, ARCSEC * theta, ARCSEC * np.hypot(*tilt)])


def _slower() -> Array:
    """Return how much slower motions have to be, from inverse dynamics at two paces, (24,)."""
    found = []
    for preset in PRESETS:
        motion = preset.build(APPENDIX_4.geometry).sample(500)
        rest = static_torques(APPENDIX_4, motion.pose)[:, :3]
        moving = [
            inverse_dynamics(one, motion.pose, motion.velocity, motion.acceleration).torque[:, :3]
            - static_torques(one, motion.pose)[:, :3]
            for one in (APPENDIX_4, APPENDIX_4.vary({"payload.mass": PAYLOAD}))
        ]

        def changes(factor: float, rest: Array = rest, moving: list[Array] = moving) -> Array:
            bare, full = (rest + part / factor**2 for part in moving)
            peak, rms = np.abs(bare).max(axis=0), np.sqrt(_mean(bare**2))
            largest = np.abs(full - bare).max(axis=0) / peak
            of_peak = np.abs(np.abs(full).max(axis=0) / peak - 1)
            return np.array(
                [largest.max(), of_peak.max(), np.abs(np.sqrt(_mean(full**2)) / rms - 1).max()]
            )

        for kind, stated in enumerate(SLOWER[preset.key]):
            low, high = 0.98 * stated, 1.02 * stated
            try:
                root = brentq(lambda at, k=kind, of=changes: of(at)[k] - 0.05, low, high, xtol=1e-6)
            except ValueError:  # no change of sign: it is elsewhere
                root = np.nan
            found.append(float(root))  # type: ignore[arg-type]
    return np.array(found)


def _mean(values: Array) -> Array:
    """Return the mean over equal steps of time, by the trapezoidal rule."""
    return (values[:-1] + values[1:]).sum(axis=0) / (2 * (len(values) - 1))


def _met(poses: Array, lift: float) -> NDArray[np.bool_]:
    """Return where κ ≤ 10, torques ≤ 15 N m and F₄ ≤ a limit hold, pose by pose."""
    found = measure_singularity(APPENDIX_4.geometry, poses)
    torque = static_torques(APPENDIX_4, poses)
    with np.errstate(invalid="ignore"):
        return (
            check_reach(APPENDIX_4.geometry, poses).ok
            & (found.rotation_distance > 0.0)
            & (found.condition <= 10.0)
            & (np.abs(torque[:, :3]).max(axis=1) <= 15.0)
            & (torque[:, 3] <= lift)
        )


def _cylinder() -> float:
    """Return the diameter at which the first of many poses on the rim breaks a requirement [mm]."""
    rng = np.random.default_rng(0)
    turn = np.radians(30.0)
    angle, z = rng.uniform(0, 2 * np.pi, 20_000), rng.uniform(-0.8, -0.4, 20_000)
    angle[:500], z[:500] = np.pi / 2 + rng.normal(0.0, 0.02, 500), -0.6
    theta = rng.uniform(-turn, turn, 20_000)
    theta[:500] = rng.normal(0.0, 0.02, 500)

    def holds(diameter: float) -> bool:
        r = diameter / 2
        poses = np.stack([r * np.cos(angle), r * np.sin(angle), theta, z], axis=1)
        return bool(_met(poses, 450.0).all())

    low, high = 0.36, 0.38
    while high - low > 1e-5:
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return MM * low


def _volume() -> float:
    """Return the volume of κ ≤ 10, torques ≤ 15 N m, F₄ ≤ 250 N, ± 30°, by counted points [dm³]."""
    low, size = np.array([-0.42, -0.42, -1.05]), np.array([0.84, 0.84, 1.05])
    left = low + size * qmc.Sobol(3, rng=0).random(POINTS)
    for theta in np.radians(np.linspace(-30.0, 30.0, 9)):
        left = left[_met(np.insert(left, 2, theta, axis=1), 250.0)]
    return 1e3 * float(np.prod(size)) * len(left) / POINTS


def _volumes() -> Array:
    bounds = tuple(
        map(parse_requirement, ("condition <= 10", "max_torque <= 15 N m", "f_4 <= 250 N"))
    )
    asked = Requirements(bounds, (-np.radians(30.0), np.radians(30.0)))
    found = []
    for nodes in VOLUMES:
        volume = solve_volume(APPENDIX_4, asked, resolution=Resolution(nodes, 9, 5.0))
        found += [MM * volume.cell, 1e3 * volume.volume, 1e3 * volume.error]
    return np.array(found)


def _paper_like() -> Array:
    """Return the largest f_4 [N], its power [W] and torque of M1 to M3 [N m], before and after."""
    motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample()
    found = []
    for design in (APPENDIX_4, balance(APPENDIX_4).after):
        states = (motion.pose, motion.velocity, motion.acceleration)
        y = torque_regressor(design.geometry, *states, gravity=design.gravity)
        torque = regressor_torques(y, lumped_coefficients(design))
        speed = motion.velocity[:, 3] / design.geometry.magnification
        found += [
            torque[:, 3].max(),
            np.abs(torque[:, 3] * speed).max(),
            np.abs(torque[:, :3]).max(),
        ]
    return np.array(found)


WORKED: tuple[Claim, ...] = (
    Claim(
        "accuracy.md",
        "Errors by the drives at home: x, y, in the plane, z [µm] and θ [″]",
        "Newton’s method in the 16 corners of the drives’ box",
        "",
        4e-3,
        _drive_errors,
        (29.1, 25.2, 29.1, 15.0, 45.0),
    ),
    Claim(
        "accuracy.md",
        "RMS of the same",
        "differences of Newton’s solutions, w²/12 each",
        "",
        6e-3,
        _drive_rms,
        (10.3, 10.3, 14.5, 8.7, 15.0),
    ),
    Claim(
        "accuracy.md",
        "Medians over the disc, in the plane [µm] and of θ [″]",
        "corners by Newton’s method, 800 poses",
        "",
        2e-2,
        _drive_medians,
        (49.0, 64.0),
    ),
    Claim(
        "balancing.md",
        "m₇ that balances, added mass of three legs, and the counterweight that does the same",
        "roots of the slope of the potential energy",
        "kg",
        2e-4,
        _balancing_masses,
        (3.063, 8.349, 1.146),
    ),
    Claim(
        "calibration.md",
        "Largest errors by tolerances: x, y, z [µm], θ, tilt [″], and clearances’ part of x, y, z",
        "differences of Newton’s solutions by 42 lengths",
        "",
        1.2e-2,
        _tolerances_worst,
        (1546.0, 1609.0, 2939.0, 949.0, 8082.0, 29.0, 34.0, 92.0),
    ),
    Claim(
        "calibration.md",
        "RMS of the same, and of the tilt about one axis",
        "differences of Newton’s solutions by 42 lengths",
        "",
        3e-3,
        _tolerances_rms,
        (207.0, 207.0, 414.0, 190.0, 1709.0, 1208.0),
    ),
    Claim(
        "calibration.md",
        "RMS of 2000 random robots: x, y, z [µm], θ and tilt [″]",
        "every robot solved by Newton’s method",
        "",
        4e-3,
        _drawn_robots,
        (208.0, 207.0, 415.0, 188.0, 1706.0),
    ),
    Claim(
        "drives.md",
        "Times that motions have to be slower for 5 kg to change M1 to M3 by 5 %",
        "roots from inverse dynamics with and without the payload",
        "",
        2e-3,
        _slower,
        tuple(factor for row in SLOWER.values() for factor in row),
    ),
    Claim(
        "largest-workspace.md",
        "The largest cylinder of 400 mm height is between 367.5 and 368.5 mm wide",
        "20,000 poses on its rim, one by one",
        "mm",
        0.6,
        _cylinder,
        368.1,
    ),
    Claim(
        "requirements.md",
        "Cell [mm], volume and its error [dm³] with 8,000 to 1,000,000 nodes",
        "solved again; the last volume is counted below",
        "",
        6e-3,
        _volumes,
        tuple(figure for row in VOLUMES.values() for figure in row),
    ),
    Claim(
        "requirements.md",
        "All requirements hold in 92.05 dm³",
        "262,144 points counted at nine headings",
        "dm³",
        0.2,
        _volume,
        92.05,
    ),
    Claim(
        "README.md",
        "f₄ [N], its power [W] and torques of M1 to M3 [N·m] at most, before and after balance",
        "products of regressor and coefficients along the paper-like motion",
        "",
        2e-2,
        _paper_like,
        (250.0, 19.1, 4.0, 320.0, 24.8, 2.7),
    ),
)
