"""Stiffness and mass of a leg for many poses at once: matrices that are the same for all of them.

A bar turned by an angle of cosine c and sine s has terms in c^2, c s, s^2, c, s and 1, whose
matrices do not depend on the pose. So a leg's matrix is a sum of 16 constant ones, for the bars
along B8, those along B4, the arm, and what never turns; all poses are one product of matrices. Only
B10, whose length from leg axis to slider changes, is built pose by pose.

Freedoms, elements and joints are those of `leg_model`. The masses are Appendix 4's: bars uniform
(`beam_mass`), pins, slider and counterweights as point masses. What of B10 is beyond the slider is
rigid.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import require_count
from paminsa_viz.elastostatics.beams import beam_mass, beam_stiffness, body_mass, point_mass
from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_model import FIXED, RETAINED, SPANS, LegModel, leg_model
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import kept
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.parameters import PANTOGRAPH

MOST_DIVISIONS = 16
"""Most elements of a bar between two joints."""

TERMS = 16
"""Five of each direction that turns, and the constant one."""

TURNS: Mapping[str, int] = {"b8": 0, "b3": 0, "b4": 5, "b7": 5, "b1": 10}
"""First term of the bars that turn; B2 and B10 do not."""

JOINTS = dict(SPANS)
"""Joints along each bar."""

_PINS = {9: "b8", 4: "b4", 5: "b4", 3: "b3", 7: "b3", 2: "b2"}
"""Bar that the mass of a joint sits on; that of joint 8 is the slider's."""


class BarElementMass(NamedTuple):
    """Lengths of a bar's spans [m], and its mass [kg/m] and inertias along and across it [kg m]."""

    spans: tuple[float, ...]
    mass: float
    axial: float
    rotary: float


def bar_masses(design: Design) -> dict[str, BarElementMass]:
    """Return what every bar of a leg weighs per length.

    Where Appendix 4 gives no transverse inertia, for B1 and B2, the bar is slender.
    """
    g, links, inertias = design.geometry, design.links, design.inertias
    k = g.magnification
    crank, coupler = g.crank_length, g.coupler_length
    spans = {
        "b8": (crank,),
        "b7": (coupler / k,),
        "b4": (coupler / k, coupler * (k - 1) / k),
        "b3": (crank / k, crank * (k - 1) / k),
        "b2": (g.shaft_length,),
        "b1": (g.arm_length,),
        "b10": (g.guide_link_length,),
    }
    axial = {"b2": inertias.b2_vertical}
    across = {"b10": inertias.b10_vertical}
    for bar in PANTOGRAPH:
        axial[bar] = getattr(inertias, f"{bar}_axial")
        across[bar] = getattr(inertias, f"{bar}_transverse")
    found = {}
    for bar, lengths in spans.items():
        mass, length = getattr(links, bar), sum(lengths)
        slender = mass * length**2 / 12
        rotary = across.get(bar, slender) - slender
        found[bar] = BarElementMass(
            lengths, mass / length, axial.get(bar, 0.0) / length, rotary / length
        )
    return found


@dataclass(frozen=True, eq=False)
class LegMatrices:
    """A design's legs as sums of constant matrices.

    Attributes:
        design, model, divisions, shear: What they were built for.
        stiffness, mass: (`TERMS`, size, size).
    """

    design: Design
    model: LegModel
    divisions: int
    shear: bool
    stiffness: Array
    mass: Array

    @property
    def size(self) -> int:
        """Number of freedoms of a leg."""
        return self.model.size

    def assemble(self, frame: LegFrame) -> tuple[Array, Array]:
        """Return stiffness and mass of the legs in their frames, (..., 3 legs, size, size) each."""
        pairs = (frame.phi, frame.psi, frame.arm)
        parts = [
            part
            for c, s in (np.moveaxis(pair, -1, 0) for pair in pairs)
            for part in (c * c, c * s, s * s, c, s)
        ]
        terms = np.stack([*parts, np.ones_like(parts[0])], axis=-1)
        flat, n = terms.reshape(-1, TERMS), self.size
        k = (flat @ self.stiffness.reshape(TERMS, -1)).reshape(-1, n, n)
        m = (flat @ self.mass.reshape(TERMS, -1)).reshape(-1, n, n)
        self._add_guide(k, m, -frame.points[8][..., 0].reshape(-1))
        shape = (*terms.shape[:-1], n, n)
        return k.reshape(shape), m.reshape(shape)

    def _add_guide(self, k: Array, m: Array, length: Array) -> None:
        """Add B10 from the leg axis to the slider, and what of it is beyond."""
        design = self.design
        whole, own = design.geometry.guide_link_length, bar_masses(design)["b10"]
        turn = _turned("b10", 12)
        step = length / self.divisions
        section = design.elastic.section("b10")
        stiff = turn @ beam_stiffness(step, section, design.elastic, shear=self.shear) @ turn.T
        heavy = turn @ beam_mass(step, own.mass, own.axial, own.rotary) @ turn.T
        for element in self.model.elements:
            if element.bar == "b10":
                add_matrix(k, element.freedoms, stiff)
                add_matrix(m, element.freedoms, heavy)
        rest = whole - length
        beyond = body_mass(
            own.mass * rest, own.mass * rest**2 / 2, own.mass * rest**3 / 3, own.rotary * rest
        )
        add_matrix(m, self.model.node("b10", 8).freedoms, turn[:6, :6] @ beyond @ turn[:6, :6].T)


def leg_matrices(design: Design, divisions: int = 1, shear: bool = False) -> LegMatrices:
    """Build the constant matrices of a design's legs.

    Args:
        design: The robot with its elastic data.
        divisions: Elements of a bar between two joints.
        shear: Whether bars deform by shear (Timoshenko).

    Raises:
        InvalidInput: If arm or shaft has no length, or ``divisions`` is not possible.
    """
    require_count(divisions, "divisions", MOST_DIVISIONS)
    for name in ("arm_length", "shaft_length"):
        if getattr(design.geometry, name) == 0:
            raise InvalidInput(f"geometry.{name}", "a bar without length is no beam element")
    return _built(design, divisions, shear)


@kept(16)
def _built(design: Design, divisions: int, shear: bool) -> LegMatrices:
    model = leg_model(design.elastic, divisions)
    stiffness, mass = np.zeros((2, TERMS, model.size, model.size))
    own = bar_masses(design)
    for element in model.elements:
        bar = element.bar
        if bar != "b10":
            # the second node is between two joints of the bar
            length = own[bar].spans[JOINTS[bar].index(element.second.second) - 1] / divisions
            section = design.elastic.section(bar)
            stiff = beam_stiffness(length, section, design.elastic, shear=shear)
            _add_turned(stiffness, bar, element.freedoms, stiff)
            _add_turned(mass, bar, element.freedoms, beam_mass(length, *own[bar][1:]))
    for joint, bar in _PINS.items():
        pin = point_mass(getattr(design.joints, f"j{joint}"))
        _add_turned(mass, bar, model.node(bar, joint).freedoms, pin)
    add_matrix(mass[-1], model.node("slider", 8).freedoms, point_mass(design.joints.j8))
    for weight in design.counterweights:
        ahead = weight.beyond if weight.joint == JOINTS[weight.bar][-1] else -weight.beyond
        freedoms = model.node(weight.bar, weight.joint).freedoms
        _add_turned(mass, weight.bar, freedoms, point_mass(weight.mass, ahead))
    for name, *pair in model.springs:
        stiff = getattr(design.elastic, name) * np.array([[1.0, -1.0], [-1.0, 1.0]])
        add_matrix(stiffness[-1], pair, stiff)
    return LegMatrices(design, model, divisions, shear, stiffness, mass)


def add_matrix(out: Array, freedoms: Sequence[int], matrix: Array) -> None:
    """Add matrices (..., n, n) to the larger ones (..., size, size) where their freedoms are."""
    places = np.array(freedoms, dtype=np.intp)
    kept = np.flatnonzero(places != FIXED)
    target = places[kept]
    out[..., target[:, None], target] += matrix[..., kept[:, None], kept]


@cache
def _axes_parts(bar: str, repeated: int = 1) -> tuple[Array, Array, Array]:
    """Return A, B, C: the element axes e, n, b in the leg frame are the columns of c A + s B + C.

    c and s are cosine and sine of the bar's elevation, or for B1 of its direction. Repeated along
    the diagonal they turn several vectors.
    """
    a, b, c = np.zeros((3, 3, 3))
    if bar == "b1":  # e = (c, s, 0), n = (0, 0, -1), b = (-s, c, 0)
        a[0, 0] = a[1, 2] = b[1, 0] = 1.0
        b[0, 2] = c[2, 1] = -1.0
    else:  # e = (c, 0, s), n = (s, 0, -c), b = (0, 1, 0)
        a[0, 0] = b[2, 0] = b[0, 1] = c[1, 2] = 1.0
        a[2, 1] = -1.0
    eye = np.eye(repeated)
    first, second, third = (np.asarray(np.kron(eye, part), np.float64) for part in (a, b, c))
    return first, second, third


def _turned(bar: str, size: int) -> Array:
    """Return the turn of a bar that never turns: B2 points up, B10 outward; (size, size)."""
    a, b, c = _axes_parts(bar, size // 3)
    return np.asarray(c + b if bar == "b2" else c - a)


def _add_turned(terms: Array, bar: str, freedoms: Sequence[int], matrix: Array) -> None:
    """Add a matrix in element axes to the terms of its bar."""
    size = len(matrix)
    if bar not in TURNS:
        turn = _turned(bar, size)
        add_matrix(terms[-1], freedoms, turn @ matrix @ turn.T)
        return
    a, b, c = _axes_parts(bar, size // 3)
    am, bm, cm = a @ matrix, b @ matrix, c @ matrix
    ab, ac, bc = am @ b.T, am @ c.T, bm @ c.T
    products = np.stack([am @ a.T, ab + ab.T, bm @ b.T, ac + ac.T, bc + bc.T])
    add_matrix(terms[TURNS[bar] : TURNS[bar] + 5], freedoms, products)
    add_matrix(terms[-1], freedoms, cm @ c.T)


def axes_of(bar: str, frame: LegFrame) -> Array:
    """Return the element axes of a bar in the leg frames, columns e, n, b, (..., 3 legs, 3, 3)."""
    a, b, c = _axes_parts(bar)
    if bar not in TURNS:
        return np.broadcast_to(_turned(bar, 3), (*frame.rho.shape, 3, 3))
    pair = (frame.phi, frame.psi, frame.arm)[TURNS[bar] // 5]
    cosine, sine = pair[..., :1, None], pair[..., 1:, None]
    return cosine * a + sine * b + c


# --------------------------------------------------------------------- legs and drives put together
# The direct stiffness method (Klimchik, Chablat, Pashkevich, arXiv 1805.11366), without a preload:
# a leg's matrix (`leg_matrices`) is condensed to the displacements of joint 5 and the carriage's
# height, and the platform's 6x6 at P is what three legs and the drive of M4 give. It is the general
# route; maps use `leg_compliance`, which agrees with it to rounding.


@dataclass(frozen=True, eq=False)
class Structure:
    """The three legs at poses of batch shape (...), before platform and carriage join them.

    Attributes:
        matrices: The legs of the design.
        frame: Where they are.
        stiffness: (..., 3 legs, size, size) of a leg in the leg frame, the drive of M4 left out
            [N/m, N, N m]; the freedoms are those of `leg_model`.
    """

    matrices: LegMatrices
    frame: LegFrame
    stiffness: Array

    def condensed(self) -> Array:
        """Return the legs' stiffness at joint 5 (u, w, z) and Z, (..., 3 legs, 4, 4)."""
        k, coupling = self.stiffness, self.stiffness[..., RETAINED:, :RETAINED]
        inside = _solved(k[..., RETAINED:, RETAINED:], coupling)
        return k[..., :RETAINED, :RETAINED] - np.swapaxes(coupling, -1, -2) @ inside

    def joined(self) -> Array:
        """Return the stiffness at the platform's twist and Z, drive of M4 included, (..., 7, 7)."""
        t = self.frame.shared_map
        k = (np.swapaxes(t, -1, -2) @ self.condensed() @ t).sum(axis=-3)
        k[..., 6, 6] += self.matrices.design.elastic.drive_linear
        return k

    def platform_stiffness(self) -> Array:
        """Return K at P, (..., 6, 6) [N/m, N, N m/rad], rows (F_x, F_y, F_z, M_x, M_y, M_z)."""
        k = self.joined()
        lift = k[..., :6, 6:]
        return k[..., :6, :6] - lift @ np.swapaxes(lift, -1, -2) / k[..., 6:, 6:]

    def displacements(self, twist: Array) -> Array:
        """Return all freedoms of the legs for small motions of the platform.

        Args:
            twist: (..., 6) displacement of P [m] and rotation [rad], in base axes.

        Returns:
            (..., 3 legs, size), in leg frames [m, rad].
        """
        k = self.joined()
        lift = -(k[..., 6, :6] * twist).sum(axis=-1, keepdims=True) / k[..., 6:, 6]
        whole = np.concatenate([twist, lift], axis=-1)
        ends = np.einsum("...kij,...j->...ki", self.frame.shared_map, whole)
        pull = self.stiffness[..., RETAINED:, :RETAINED] @ ends[..., None]
        inside = -_solved(self.stiffness[..., RETAINED:, RETAINED:], pull)[..., 0]
        return np.concatenate([ends, inside], axis=-1)


@of_design
def structure(
    design: Design, pose: ArrayLike, *, divisions: int = 1, shear: bool = False
) -> Structure:
    """Assemble the legs of a design.

    Args:
        design: The robot with its elastic data.
        pose: (..., 4) [m, m, rad, m]; where it cannot be reached, all is NaN.
        divisions: Elements of a bar between two joints.
        shear: Whether bars deform by shear (Timoshenko).

    Raises:
        InvalidInput: If arm or shaft has no length, or ``divisions`` is not possible.
    """
    matrices, frame = leg_matrices(design, divisions, shear), leg_frame(design.geometry, pose)
    return Structure(matrices, frame, matrices.assemble(frame)[0])


def _solved(matrix: Array, right: Array) -> Array:
    """Solve, with NaN where the matrix is not finite."""
    good = np.all(np.isfinite(matrix), axis=(-1, -2))[..., None, None]
    usable = np.where(good, matrix, np.eye(matrix.shape[-1]))
    return np.where(good, np.linalg.solve(usable, np.where(good, right, 0.0)), np.nan)
