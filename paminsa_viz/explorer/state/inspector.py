"""Parts of the robot that can be inspected: bars and joints of each leg, motors."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

from paminsa_viz.model import PARAMETER
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.parameters import LEG_JOINTS


class PartKind(Enum):
    """What a part is."""

    BAR = "bar"
    JOINT = "joint"
    MOTOR = "motor"


@dataclass(frozen=True)
class RobotPart:
    """A part of the robot.

    Attributes:
        kind: What it is.
        name: Of a bar its key, ``"b4"``; of a joint the paper's number; of a motor ``"M1"``.
        leg: Index of its leg; None of M4, which lifts all of them.
    """

    kind: PartKind
    name: str
    leg: int | None

    @property
    def title(self) -> str:
        """Its short name: ``B4 leg 2``, ``Joint 5 leg 1``, ``M4``."""
        if self.leg is None or self.kind is PartKind.MOTOR:
            return self.name
        name = self.name.upper() if self.kind is PartKind.BAR else f"Joint {self.name}"
        return f"{name} leg {self.leg + 1}"

    @property
    def mass_path(self) -> str:
        """Path of its mass in the design, empty for a motor."""
        start = {PartKind.BAR: "links.", PartKind.JOINT: "joints.j"}.get(self.kind)
        return "" if start is None else f"{start}{self.name}"

    @property
    def words(self) -> str:
        """What it is."""
        if self.mass_path:
            return PARAMETER[self.mass_path].label.partition(", ")[2]
        return "lifts the carriage" if self.leg is None else "turns the guide of its leg"


LEGS: Final = range(3)

PARTS: Final = (
    *(RobotPart(PartKind.BAR, bar, leg) for bar in BARS for leg in LEGS),
    *(RobotPart(PartKind.JOINT, str(joint), leg) for joint in LEG_JOINTS for leg in LEGS),
    *(RobotPart(PartKind.MOTOR, name, leg) for leg, name in enumerate(ACTUATORS[:3])),
    RobotPart(PartKind.MOTOR, ACTUATORS[3], None),
)
"""All parts: bars, joints, motors."""
