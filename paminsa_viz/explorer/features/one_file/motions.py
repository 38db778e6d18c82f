"""Motions of the page in one file, as data: time laws in pieces, and presets by their terms."""

from __future__ import annotations

from typing import Any

from paminsa_viz.model import Geometry
from paminsa_viz.model.lumped import EnergyTerms, term_matrix
from paminsa_viz.model.reach import workspace_height
from paminsa_viz.trajectory import PRESETS
from paminsa_viz.trajectory.plan import Arc, Blend
from paminsa_viz.trajectory.presets import Preset, PresetFrame
from paminsa_viz.trajectory.time_laws import Profile, TimeLaw


def motions_data() -> dict[str, Any]:
    """Return what the page needs for motions, as data that can be written as JSON.

    Returns:
        ``terms``: factors of the energies as rows over c. ``laws``: ``breaks`` and ``pieces``,
        coefficients of each piece from the highest power. ``presets``: see `_preset`. ``radius``,
        ``height``, ``depth``: lengths of the robot that they are given for, which scale them:
        R_b, the workspace's height, and how far joints 5 are from the guides at their center [m].
    """
    robot = Geometry()
    return {
        "terms": dict(zip(EnergyTerms._fields, term_matrix().tolist(), strict=True)),
        "laws": {profile.value: _law(TimeLaw(profile)) for profile in Profile},
        "presets": [found for preset in PRESETS if (found := _preset(preset, robot))],
        "radius": robot.base_radius,
        "height": workspace_height(robot),
        "depth": -(float(PresetFrame(robot).center[3]) + robot.platform_joint_height),
    }


def _law(law: TimeLaw) -> dict[str, Any]:
    return {"breaks": law.breaks.tolist(), "pieces": law.coefficients.T.tolist()}


def _preset(preset: Preset, robot: Geometry) -> dict[str, Any] | None:
    """Return a preset by the poses it is made of, less their center; None for a spline.

    A spline shares its time out by lengths, which do not scale with the robot's.
    """
    plan, center = preset.build(robot), PresetFrame(robot).center
    said = {"key": preset.key, "label": preset.label, "duration": plan.duration}
    # The duration of this one follows from its largest acceleration.
    said["scales"] = preset.key == "paper-like"
    match plan.curve:
        case Blend(start=start, terms=terms):
            moves = [
                {"shift": term.shift.tolist(), "begin": term.begin, "end": term.end}
                for term in terms
            ]
            return said | {
                "law": terms[0].law.profile.value,
                "start": (start - center).tolist(),
                "moves": moves,
            }
        case Arc() as arc:
            return said | {
                "law": arc.law.profile.value,
                "start": (arc.center - center).tolist(),
                "first": arc.first.tolist(),
                "second": arc.second.tolist(),
                "angle": arc.angle,
            }
    return None
