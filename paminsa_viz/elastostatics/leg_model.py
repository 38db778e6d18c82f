"""One leg as nodes, bars and joints: which freedoms there are, the same for all legs and poses.

Every bar has nodes of its own, in the leg frame (see `leg_frame`): displacements along u, w, z and
rotations about them. A joint makes freedoms of two nodes one where it is rigid, leaves them apart
where it is released, and puts a spring between them where it is elastic, so that constraints hold
exactly. Released are the rotation about w at joints 3, 4, 7, 8 (two pins) and 9, about the leg axis
at joint 2 and M_k (where the drive is the spring), all rotations at joint 5, and the slider's
motion along the guide. Carriage and platform are rigid; a leg meets them at its first four
freedoms, the displacements of joint 5 and the carriage's height Z.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import NamedTuple

from paminsa_viz.kept import kept
from paminsa_viz.model.elastic import Elastic

FIXED = -1
"""Index of a freedom that the base holds."""

TURN_W, TURN_Z = 4, 5
"""Freedoms of a node that revolutes release."""

RETAINED = 4
"""First freedoms of a leg: joint 5 along u, w, z on the platform's side, and Z of the carriage."""

CARRIAGE = 3
"""The freedom Z of the carriage."""

JOINT_STIFFNESSES = ("bearing_radial", "bearing_axial", "bearing_tilt", "ball", "guide",
                     "guide_tilt")  # fmt: skip
"""Fields of `Elastic` that may be rigid."""

SPANS: tuple[tuple[str, tuple[int, ...]], ...] = (
    ("b10", (0, 8)),
    ("b8", (8, 9)),
    ("b7", (8, 7)),
    ("b4", (9, 4, 5)),
    ("b3", (7, 3, 4)),
    ("b2", (3, 2)),
    ("b1", (1, 2)),
)
"""Bars and the joints along each; 0 is M_k, on the leg axis at the guides' height, and 1 the root
of the arm at the carriage."""


@dataclass(frozen=True)
class LegNode:
    """A node of a bar.

    Attributes:
        bar: Its bar, ``"b4"``; ``"slider"`` for joint 8.
        first, second: Joints that it lies between, the same one twice at a joint.
        share: Share of the way from the first to the second.
        freedoms: (6,) indices of its freedoms, `FIXED` where the base holds it.
    """

    bar: str
    first: int
    second: int
    share: float
    freedoms: tuple[int, ...]


class LegElement(NamedTuple):
    """A piece of a bar between two of its nodes."""

    bar: str
    first: LegNode
    second: LegNode

    @property
    def freedoms(self) -> tuple[int, ...]:
        """Those of the first node, then those of the second, (12,)."""
        return self.first.freedoms + self.second.freedoms


class JointSpring(NamedTuple):
    """An elastic joint: a spring between two freedoms, of the stiffness of a field of `Elastic`."""

    stiffness: str
    first: int
    second: int


@dataclass(frozen=True)
class LegModel:
    """Freedoms of a leg.

    Attributes:
        size: How many freedoms there are.
        nodes: Nodes of the bars.
        elements: Elements of the bars.
        springs: Elastic joints, the drive of M_k among them.
    """

    size: int
    nodes: tuple[LegNode, ...]
    elements: tuple[LegElement, ...]
    springs: tuple[JointSpring, ...]

    def node(self, bar: str, joint: int) -> LegNode:
        """Return the node of a bar at a joint."""
        return next(n for n in self.nodes if (n.bar, n.first, n.share) == (bar, joint, 0.0))


def leg_model(elastic: Elastic, divisions: int = 1) -> LegModel:
    """Return the freedoms of a leg, each bar cut into ``divisions`` elements between its joints."""
    soft = frozenset(n for n in JOINT_STIFFNESSES if getattr(elastic, n) is not None)
    return _leg_model(soft, divisions)


@kept(32)
def _leg_model(soft: frozenset[str], divisions: int) -> LegModel:
    made = _LegBuilder(soft)
    joint5, carriage = made.new(3), *made.new(1)
    base = (FIXED,) * 6
    b10_root = made.revolute(base, TURN_Z, "drive_rotary")
    b10_tip = made.new(6)
    slider = made.guide(b10_tip)
    at: dict[tuple[str, int], tuple[int, ...]] = {
        ("b10", 0): b10_root,
        ("b10", 8): b10_tip,
        ("b8", 8): made.revolute(slider, TURN_W),
        ("b7", 8): made.revolute(slider, TURN_W),
        ("b8", 9): made.new(6),
    }
    at["b4", 9] = made.revolute(at["b8", 9], TURN_W)
    at["b4", 4] = made.new(6)
    at["b3", 4] = made.revolute(at["b4", 4], TURN_W)
    at["b3", 3], at["b3", 7] = made.new(6), made.new(6)
    at["b7", 7] = made.revolute(at["b3", 7], TURN_W)
    at["b2", 3] = made.revolute(at["b3", 3], TURN_W)
    at["b2", 2] = made.new(6)
    at["b1", 2] = made.revolute(at["b2", 2], TURN_Z)
    at["b1", 1] = (FIXED, FIXED, carriage, FIXED, FIXED, FIXED)
    at["b4", 5] = made.ball(joint5)

    nodes = [LegNode("slider", 8, 8, 0.0, slider)]
    elements = []
    for bar, joints in SPANS:
        nodes.append(LegNode(bar, joints[0], joints[0], 0.0, at[bar, joints[0]]))
        for first, second in itertools.pairwise(joints):
            for part in range(1, divisions + 1):
                before = nodes[-1]
                if part == divisions:
                    nodes.append(LegNode(bar, second, second, 0.0, at[bar, second]))
                else:
                    nodes.append(LegNode(bar, first, second, part / divisions, made.new(6)))
                elements.append(LegElement(bar, before, nodes[-1]))
    return LegModel(made.count, tuple(nodes), tuple(elements), tuple(made.springs))


class _LegBuilder:
    """Numbers freedoms, and makes joints of them."""

    def __init__(self, soft: frozenset[str]) -> None:
        self.soft = soft
        self.count = 0
        self.springs: list[JointSpring] = []

    def new(self, count: int) -> tuple[int, ...]:
        self.count += count
        return tuple(range(self.count - count, self.count))

    def revolute(self, node: tuple[int, ...], axis: int, drive: str = "") -> tuple[int, ...]:
        """Return the freedoms of the node on a revolute's other side."""
        kinds = ["bearing_radial"] * 3 + ["bearing_tilt"] * 3
        kinds[axis - 3] = "bearing_axial"
        kinds[axis] = drive or "free"
        return self._joined(node, kinds)

    def guide(self, node: tuple[int, ...]) -> tuple[int, ...]:
        """Return the freedoms of the slider on the guide."""
        return self._joined(node, ["free", "guide", "guide", *["guide_tilt"] * 3])

    def ball(self, node: tuple[int, ...]) -> tuple[int, ...]:
        """Return the freedoms of B4's end at the platform's joint 5."""
        return (*self._joined(node, ["ball"] * 3), *self.new(3))

    def _joined(self, node: tuple[int, ...], kinds: list[str]) -> tuple[int, ...]:
        found = []
        for freedom, kind in zip(node, kinds, strict=True):
            if kind == "free":
                found.append(self.new(1)[0])
            elif kind in self.soft or kind == "drive_rotary":
                found.append(self.new(1)[0])
                self.springs.append(JointSpring(kind, freedom, found[-1]))
            else:
                found.append(freedom)
        return tuple(found)
