"""The designs that come with the program, each made by what it is an example of: masses that
balance, drives that carry 10 kg, and lengths of a small robot by a global search."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.selection import select_drives
from paminsa_viz.balancing import balance
from paminsa_viz.clearance import clearance
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_file import write_design
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import (
    APPENDIX_4,
    Payload,
    check_reach,
    inverse_kinematics,
    resized,
    static_imbalance,
)
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.trajectory import PRESET

RADIUS, HEIGHT, TURN = 0.1, 0.2, np.radians(30.0)
"""Workspace of the compact robot: a cylinder about the vertical [m], and theta up to [rad]."""
MARGIN, CONDITION, APART = 0.01, 10.0, 0.005
"""Least distance to a limit of reach [m], largest condition number, least clearance [m]."""
BAR_WEIGHT = 0.25
"""Weight of the bars' lengths next to the footprint's radius."""
SEARCHED = {
    "geometry.base_radius": (0.1, 0.35),
    "geometry.platform_radius": (0.05, 0.1),
    "geometry.magnification": (2.0, 4.0),
    "geometry.crank_length": (0.1, 0.6),
    "geometry.coupler_length": (0.2, 0.7),
}
FOLLOWING = ("geometry.arm_length", "geometry.guide_link_length")
"""Lengths that follow from those that are searched."""


def without_rounding(design):
    """Return a balanced design with M_p2 = 0 to the last bit: m_B7 changes in its last digits."""
    held = design.links.b7
    for step in sorted(range(-300, 301), key=abs):
        trial = design.vary({"links.b7": held + step * np.spacing(held)})
        if static_imbalance(trial) == 0.0:
            return trial
    return design


def balanced():
    return replace(balance(APPENDIX_4).after, name="Balanced by masses")


def heavy_payload():
    loaded = replace(balance(APPENDIX_4).after, payload=Payload(10.0, 0.06, 0.1))
    motion = PRESET["paper-like"].build(loaded.geometry).sample(1000.0)
    found = select_drives(duty_cycle(loaded, [Duty(motion)]), generic_catalog())
    return replace(loaded, drives=found.drives, name="Heavy payload")


def workspace(top: float, finer: int = 1):
    """Return poses (n, 4) on the surface of the cylinder and on its axis; ``top`` is its top."""
    angle = np.linspace(-np.pi, np.pi, 12 * finer, endpoint=False)
    radius = np.array([1.0, 0.5]) * RADIUS
    x = np.concatenate([[0.0], np.outer(radius, np.cos(angle)).ravel()])
    y = np.concatenate([[0.0], np.outer(radius, np.sin(angle)).ravel()])
    theta = np.linspace(-TURN, TURN, 4 * finer + 1)
    z = np.linspace(top - HEIGHT, top, 2 * finer + 1)
    i, j, k = np.meshgrid(np.arange(x.size), theta, z, indexing="ij")
    return np.stack([x[i], y[i], j, k], axis=-1).reshape(-1, 4)


def top_of(design) -> float:
    """Return where the cylinder is: as far below the guides as half of what the legs reach."""
    g = design.geometry
    return HEIGHT / 2 - g.platform_joint_height - 0.5 * reach_down(g)


def reach_down(g) -> float:
    """Return how far below the guides joint 5 can be at the middle, the pantograph stretched."""
    longest = g.magnification * g.crank_length + g.coupler_length - g.crank_length
    return float(np.sqrt(max(longest**2 - (g.base_radius - g.platform_radius) ** 2, 0.0)))


def footprint(design, poses) -> float:
    """Return the radius about the vertical that joints 5, 8 and 9 sweep [m]."""
    points = inverse_kinematics(design.geometry, poses).points
    return float(max(np.hypot(*np.moveaxis(points[j][..., :2], -1, 0)).max() for j in (5, 8, 9)))


def broken(design, poses, spare: float = 1.0) -> float:
    """Return by how much the needs are not met, tightened by a factor; 0 if all are."""
    reach = check_reach(design.geometry, poses)
    short = np.clip(spare * MARGIN - np.nan_to_num(reach.margins, nan=-1.0), 0.0, None).max()
    condition = measure_singularity(design.geometry, poses).condition
    worst = np.nan_to_num(condition, nan=1e6, posinf=1e6).max()
    lack = float(short + max(spare * worst / CONDITION - 1.0, 0.0))
    if lack > 0:
        return lack + 1.0
    return max(spare * APART - float(np.nanmin(clearance(design, poses).least)), 0.0)


def compact(generations: int = 50):
    """Search for the least footprint and bars; the guide is as long as it has to be."""

    def robot(lengths, stroke=None):
        values = dict(zip(SEARCHED, map(float, lengths), strict=True))
        share = values["geometry.base_radius"] / APPENDIX_4.geometry.base_radius
        following = (round(share * APPENDIX_4.geometry.arm_length, 3), stroke or 0.9)
        values |= zip(FOLLOWING, following, strict=True)
        return resized(APPENDIX_4, values)

    def cost(lengths):
        try:
            trial = robot(lengths)
        except InvalidDesign:
            return 1e6
        poses = workspace(top_of(trial))
        lack = broken(trial, poses, spare=1.2)
        if lack > 0:
            return 10.0 + lack
        return footprint(trial, poses) + BAR_WEIGHT * (lengths[3] + lengths[4])

    found = differential_evolution(
        cost, list(SEARCHED.values()), maxiter=generations, popsize=8, rng=0, polish=False
    )
    lengths = np.round(found.x, 3)
    longest = robot(lengths)
    points = inverse_kinematics(longest.geometry, workspace(top_of(longest), finer=4)).points
    axes = longest.geometry.base_radius * np.stack([np.cos(AXIS_ANGLES), np.sin(AXIS_ANGLES)], -1)
    away = np.linalg.norm(points[8][..., :2] - axes, axis=-1).max()
    best = robot(lengths, round(float(np.ceil(1e3 * away) / 1e3 + MARGIN), 3))
    return replace(without_rounding(balance(best).after), name="Compact robot")


if __name__ == "__main__":
    for stem, design in {
        "balanced": balanced(), "payload": heavy_payload(), "compact": compact()
    }.items():  # fmt: skip
        comment = "An example of paminsa_viz, made by assets/make_designs.py."
        Path(f"example_{stem}.toml").write_text(
            write_design(design, comment=comment), encoding="utf-8"
        )
        print(f"{design.name}: M_p2 = {balance(design).values[0].before:.1e} N")
        poses = workspace(top_of(design), finer=4)
        print(f"  footprint {footprint(design, poses):.3f} m, lacks {broken(design, poses):.3g}")
