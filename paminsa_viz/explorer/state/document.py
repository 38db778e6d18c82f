"""What a person works on, and where the robot is."""

from __future__ import annotations

from dataclasses import dataclass, field

from paminsa_viz.explorer.state.motion import Motion
from paminsa_viz.model import APPENDIX_4, Design, Geometry
from paminsa_viz.model.arrays import Pose
from paminsa_viz.quantities.requirements import Requirements


@dataclass(frozen=True)
class LastReachable:
    """The last reachable pose; the robot stays there while a requested one is out of reach.

    Attributes:
        geometry: The lengths and the knee's root it was solved with.
        pose: Platform pose [m, m, rad, m].
    """

    geometry: Geometry
    pose: Pose


@dataclass(frozen=True)
class Document:
    """What a person works on: undo, saving and share codes are about this.

    Attributes:
        design: The robot.
        pose: The requested pose; it may be out of reach.
        reference: A pinned design to compare with, or None.
        motion: The motion that is planned.
        requirements: What the robot is needed for.
    """

    design: Design = APPENDIX_4
    pose: Pose = (0.0, 0.0, 0.0, 0.0)
    reference: Design | None = None
    motion: Motion = field(default_factory=Motion)
    requirements: Requirements = field(default_factory=Requirements)
