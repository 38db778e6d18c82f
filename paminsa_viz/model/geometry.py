"""Lengths of the mechanism, the size of its bodies, and the branch of its knees."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.parameters import SMALLEST, Group, parameter
from paminsa_viz.units import rounded_to_side

BODY_SCALE = "geometry.body_scale"
"""Path of the one number of a geometry that the mechanism does not depend on."""


class KneeBranch(Enum):
    """Which of the two roots the knee 9 takes.

    ``LOWER`` is the root that Appendix 1 prints for F; the platform then hangs below the guides,
    z < 0. ``UPPER`` is the other one, its mirror image. A robot changes its branch only by being
    put together again: on the way the pantographs would pass through the stretched configuration.
    The field calls such a branch of the inverse kinematics a working mode.
    """

    LOWER = "lower"
    UPPER = "upper"

    @property
    def sign(self) -> float:
        """+1 for the published root, -1 for its mirror image."""
        return 1.0 if self is KneeBranch.LOWER else -1.0

    @property
    def label(self) -> str:
        """ "lower knee" or "upper knee", for captions."""
        return f"{self.value} knee"


@dataclass(frozen=True)
class Geometry(Group, path="geometry"):
    """Lengths of the mechanism (Appendix 4), and the branch of its knees.

    Link B7 is as long as B4 divided by k, and B8 as long as B3; without that 8-9-4-7 would be no
    parallelogram, so they are no parameters of their own. The knee of each leg is the lower or the
    upper one.

    ``body_scale`` is how large all bodies are over the prototype's, as they are drawn and checked
    for clearance: tubes, joints, motors and frame. No force and no stiffness depends on it.
    """

    magnification: float = parameter(3.0, "k", "", "pantograph magnification factor", positive=True)
    base_radius: float = parameter(0.35, "R_b", "m", "radius of the leg axes", positive=True)
    platform_radius: float = parameter(0.1, "R_pl", "m", "radius of platform joints", positive=True)
    arm_length: float = parameter(0.308, "l_B1", "m", "length of arm B1")
    shaft_length: float = parameter(0.442, "l_B2", "m", "length of shaft B2")
    crank_length: float = parameter(0.42, "l_B3 = l_B8", "m", "length of B3 and B8", positive=True)
    coupler_length: float = parameter(0.63, "l_B4 = k l_B7", "m", "length of B4", positive=True)
    platform_joint_height: float = parameter(0.0275, "l_B5", "m", "joint 5 above the platform")
    guide_link_length: float = parameter(
        0.3635, "l_B10", "m", "length of guide link B10", positive=True
    )
    guide_stroke: float | None = parameter(
        None, "|X_4| max", "m", "stroke of joint 8 (default: l_B10)", positive=True
    )
    axis_clearance: float = parameter(0.0, "X_1 min", "m", "least distance of 5 from its leg axis")
    body_scale: float = parameter(
        1.0, "s_b", "", "size of the bodies over the prototype’s", positive=True
    )
    knee: KneeBranch = KneeBranch.LOWER

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.knee, KneeBranch):
            raise InvalidDesign("geometry.knee", self.knee, "a KneeBranch is needed")
        if self.magnification < 1 + SMALLEST:
            raise InvalidDesign(
                "geometry.magnification",
                self.magnification,
                f"k has to be greater than 1, by {SMALLEST:g} or more, or joint 4 would not lie "
                f"between 9 and 5",
            )
        if self.home_span >= self.crank_length + self.coupler_length:
            longest = self.crank_length + self.coupler_length
            needed = rounded_to_side(self.home_span, 6, up=True)
            raise InvalidDesign(
                "geometry.coupler_length",
                self.coupler_length,
                f"B4 and B8 cannot close the pantograph with the platform at the center: together "
                f"they reach {longest:.6g} m, and joints 8 and 5 are at least "
                f"{needed:.6g} m apart there; lengthen B4 or B8, or bring R_b and R_pl "
                f"closer together",
            )

    @property
    def home_span(self) -> float:
        """Horizontal distance from 8 to 5 at x = y = theta = 0 [m]."""
        return self.span_ratio * abs(self.base_radius - self.platform_radius)

    @property
    def span_ratio(self) -> float:
        """Horizontal distance from 8 to 5 divided by X_1, that is k/(k-1)."""
        return self.magnification / (self.magnification - 1)

    @property
    def stroke(self) -> float:
        """Largest distance of joint 8 from the leg axis, |X_4| [m]."""
        return self.guide_link_length if self.guide_stroke is None else self.guide_stroke

    def in_force(self, name: str) -> float:
        """Return a number as it counts; the guide stroke follows l_B10 until it is set."""
        return self.stroke if name == "guide_stroke" else super().in_force(name)

    @property
    def short_coupler_length(self) -> float:
        """Length of link B7, l_B4/k [m]."""
        return self.coupler_length / self.magnification
