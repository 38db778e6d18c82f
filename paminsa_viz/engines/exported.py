"""Exported models, MJCF and USD: held in a pose, with servos to move them."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from paminsa_viz.engines.mechanism import PLATFORM, MechanismTree, build_mechanism
from paminsa_viz.engines.missing import EngineMissing
from paminsa_viz.engines.mjcf import Servos, mjcf_text
from paminsa_viz.engines.mujoco_model import compiled_model
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.engines.usd import usd_text
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.units import rounded_to_side

LEAST_MASS = 1e-3
"""Least mass of a sliding link at an end of the tree, its joints included [kg]."""

LEAST_INERTIA = 1e-6
"""Least inertia about its hinge of a turning link at an end of the tree [kg m^2].

Both are of robots not shorter than Appendix 4's. What counts is a link beside the others that the
closures tie it to, so that a shorter robot's are smaller as lengths cubed, and to the fifth.
"""

WORST_CONDITION = 1e4
"""Condition number from which a pose counts as singular; gains would be as large as its square."""


@of_design
def exported_mjcf(
    design: Design,
    *,
    pose: Sequence[float] | None = None,
    servos: bool = True,
) -> str:
    """Return a design's MJCF text; MuJoCo's viewer opens it standing still.

    It needs no engine: the holding forces and the servos' gains are the model's. Where MuJoCo is
    installed, it has loaded the text. The design's load acts on the platform, see `mjcf`.

    Args:
        design: The robot.
        pose: Start pose [m, m, rad, m]; default `start_pose`.
        servos: Position servos about the start pose; otherwise plain motors.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If the start pose is singular, so that nothing could hold it, if nothing
            resists the motion of a link, so that MuJoCo could not step it, or if MuJoCo refuses
            the model.
        UnreachablePose: If the robot cannot be in the start pose.
    """
    _check_inertia(build_mechanism(design), length_ratio(design.geometry))
    start = _held_pose(design, pose)
    holding = static_torques(design, start)
    text = mjcf_text(
        design, pose=start.tolist(), holding=holding.tolist(),
        servos=_servos(design, start) if servos else None, load=True,
    )  # fmt: skip
    with suppress(EngineMissing):  # without the engine nobody can say
        compiled_model(text)
    return text


@of_design
def exported_usd(
    design: Design, *, pose: Sequence[float] | None = None, servos: bool = True
) -> str:
    """Return a design's USD text, see `usd`; arguments as of `exported_mjcf`.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If the start pose is singular, or a link has no mass or no inertia.
        UnreachablePose: If the robot cannot be in the start pose.
    """
    start = _held_pose(design, pose)
    held = _servos(design, start) if servos else None
    return usd_text(design, pose=start.tolist(), servos=held)


def _held_pose(design: Design, pose: Sequence[float] | None) -> Array:
    """Return the start pose (4,), in which actuators can hold the robot."""
    start = start_pose(design, pose)
    require_reachable(design.geometry, start)
    if not measure_singularity(design.geometry, start).condition < WORST_CONDITION:
        raise InvalidInput("pose", "it is singular, so that nothing holds the platform there")
    return start


def _servos(design: Design, pose: Array) -> Servos:
    j = jacobian(design.geometry, pose)
    return Servos.critical(j.T @ mass_matrix(design, pose) @ j)


def _check_inertia(mechanism: MechanismTree, size: float) -> None:
    """Refuse links that nothing but the stiff closures would hold back.

    Links that carry others may be without mass, and so may the platform's turns.

    Args:
        mechanism: The robot.
        size: Its lengths over Appendix 4's.
    """
    shorter = min(size, 1.0)
    carriers = {link.parent for link in mechanism.links}
    for link in mechanism.links:
        if link.name in carriers or link.name == PLATFORM:
            continue
        if link.joints[-1].kind == "slide":
            held, least, unit = sum(part.mass for part in link.parts), LEAST_MASS * shorter**3, "kg"
        else:
            held = sum(part.inertia[1] + part.mass * part.center[0] ** 2 for part in link.parts)
            least, unit = LEAST_INERTIA * shorter**5, "kg·m²"
        if held < least:
            raise InvalidInput(
                "design",
                f"{link.name} with its joints has {held:g} {unit}; MuJoCo cannot move less than "
                f"{rounded_to_side(least, 6, up=True):g} {unit}",
            )
