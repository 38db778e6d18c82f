"""What a report is asked for, and the sections that it is made of."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

from paminsa_viz.blocks.kinds import Block
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Pose

if TYPE_CHECKING:
    from paminsa_viz.identification.log import Log
    from paminsa_viz.model.design import Design
    from paminsa_viz.precision.measurements import Measurements
    from paminsa_viz.quantities.requirements import Requirements
    from paminsa_viz.synthesis.search.result import SynthesisResult
    from paminsa_viz.trajectory import Trajectory


@dataclass(frozen=True)
class Section:
    """A section of the report.

    Attributes:
        key: Its anchor.
        title: Its heading.
        blocks: What it holds.
    """

    key: str
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, eq=False)
class ReportRequest:
    """A robot, a pose and a motion to report on.

    Attributes:
        design: The robot.
        pose: (x, y, theta, z) [m, m, rad, m]; maps are at its theta and z.
        trajectory: The motion.
        made: When, with a time zone.
        command: The command that makes the report again.
        verified: Whether to compare with physics engines, if they are installed.
        seed: Of random poses.
        log: A log of the built robot, to identify it from; None for none.
        requirements: What the robot is needed for; None for no section on it.
        synthesis: The search that the robot comes from; None for none.
        measured: Measured poses of the built robot, to calibrate it with; None for none.
        reference: Another design, to compare with on the same motion; None for none.

    Raises:
        InvalidInput: If the pose is not four numbers.
    """

    design: Design
    pose: Pose
    trajectory: Trajectory
    made: datetime
    command: str
    verified: bool = True
    seed: int = 0
    log: Log | None = None
    requirements: Requirements | None = None
    synthesis: SynthesisResult | None = None
    measured: Measurements | None = None
    reference: Design | None = None

    def __post_init__(self) -> None:
        if len(self.pose) != 4:
            raise InvalidInput("pose", f"four numbers are needed, not {len(self.pose)}")
