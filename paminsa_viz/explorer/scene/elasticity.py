"""Elasticity in the scene: the animated mode, the deflected robot, the compliance ellipsoid."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray
from viser import GlbHandle, LabelHandle, MeshHandle

from paminsa_viz import palette
from paminsa_viz.explorer.elasticity import CASES, ElasticOutcome
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import Curve
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.meshes.vibrating import vibrating_glb
from paminsa_viz.model.arrays import Array
from paminsa_viz.units import number

MODE_COLOR: Final = "#CC79A7"
DEFLECTED_COLOR: Final = "#000000"
ELLIPSOID_COLOR: Final = "#56B4E9"
"""Hues of the Okabe-Ito set that no leg has."""

MODE_NODE: Final = "/elastic/mode"
"""Scene name of the animation; ``page.js`` looks for it."""

LONGEST_SWING: Final = 0.06
"""Largest displacement of an animated mode, as drawn [m]."""

PERIOD: Final = 1.6
"""Time of a swing on the page [s]: all modes are shown as slowly."""

TUBE: Final = 0.006
"""Radius of the lines of a mode [m]."""

LARGEST: Final = 0.12
"""Largest deflection, as drawn [m]."""

LONGEST_AXIS: Final = 0.3
"""Largest half axis of the ellipsoid, as drawn [m]: the platform must not hide it."""

BELOW: Final = {"mode": 0.16, "deflection": 0.23, "compliance": 0.3}
"""Distances of the labels below the platform [m]."""

_LATITUDES, _LONGITUDES = 13, 24


def nice_scale(largest: float, longest: float) -> float:
    """Return 1, 2 or 5 times a power of ten by which ``largest`` is at most ``longest`` long."""
    most = longest / max(largest, 1e-15)
    power = 10.0 ** math.floor(math.log10(most))
    return next(step * power for step in (5, 2, 1) if step * power <= most * (1 + 1e-9))


def sphere() -> tuple[Array, NDArray[np.uint32]]:
    """Return vertices (n, 3) and triangles of a unit sphere."""
    up = np.pi * np.arange(_LATITUDES) / (_LATITUDES - 1)
    around = 2 * np.pi * np.arange(_LONGITUDES) / _LONGITUDES
    vertices = np.stack(
        [
            np.outer(np.sin(up), np.cos(around)),
            np.outer(np.sin(up), np.sin(around)),
            np.outer(np.cos(up), np.ones(_LONGITUDES)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    low = _LONGITUDES * np.arange(_LATITUDES - 1)[:, None]
    i = np.arange(_LONGITUDES)
    j = (i + 1) % _LONGITUDES
    high = low + _LONGITUDES
    faces = np.stack([low + i, high + i, high + j, low + i, high + j, low + j], axis=-1)
    return vertices, faces.reshape(-1, 3).astype(np.uint32)


def _belongs(outcome: ElasticOutcome | None, frame: Frame) -> bool:
    """Whether a result is about the pose and the lengths that are shown."""
    if outcome is None:
        return False
    job, last = outcome.job, frame.state.last_reachable
    return job.pose == last.pose and job.design.geometry == last.geometry


class ModeShape:
    """The layer ``mode_shape``: the chosen mode as tubes that swing about the center lines.

    The browser plays the animation by itself. A new one is sent when the page is idle, and the old
    one is removed as soon as the robot moves.
    """

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: tuple[object, ...] = ()
        self._node: GlbHandle | None = None
        self._label: LabelHandle | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the modes; nothing is sent while hidden."""
        view = frame.state.elastic_view
        outcome, found, mode = view.outcome, view.result, view.mode
        shown = "mode_shape" in frame.state.layers and _belongs(outcome, frame)
        lines = None if found is None or mode >= len(found.frequencies) else found.shapes
        if not shown or outcome is None or found is None or lines is None:
            self._remove()
            return
        key = (outcome, mode)
        if key == self._drawn or (dragging and self._node is not None):
            return
        self._remove()
        self._drawn = key
        moves = lines.moves[..., mode] * LONGEST_SWING / lines.largest[mode]
        data = vibrating_glb(lines.points, moves, radius=TUBE, color=MODE_COLOR, period=PERIOD)
        self._node = self._scene.add_glb(MODE_NODE, data, cast_shadow=False, receive_shadow=False)
        x, y, _, z = outcome.job.pose
        self._label = self._scene.add_label(
            "/elastic/mode_label", mode_text(mode, found.frequencies[mode]),
            position=(x, y, z - BELOW["mode"]), font_screen_scale=0.9, anchor="top-center",
        )  # fmt: skip

    def _remove(self) -> None:
        for node in (self._node, self._label):
            if node is not None:
                node.remove()
        self._node = self._label = None
        self._drawn = ()


def mode_text(mode: int, frequency: float) -> str:
    """Return the label of an animated mode: its frequency and its scale."""
    return (
        f"mode {mode + 1}: {number(frequency, 3)} Hz, largest swing drawn as "
        f"{1e3 * LONGEST_SWING:.0f} mm, slowed down"
    )


class Deflection:
    """The layer ``deflection``: center lines under the load case, their displacements enlarged."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._curve = Curve(context.scene, "/elastic/deflected", DEFLECTED_COLOR, 4.0)
        self._drawn: ElasticOutcome | None = None
        self._label: LabelHandle | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the result; nothing is sent while hidden."""
        del dragging
        view = frame.state.elastic_view
        outcome, found = view.outcome, view.result
        shown = "deflection" in frame.state.layers and _belongs(outcome, frame)
        lines = None if found is None else found.deflected
        shown = shown and lines is not None
        if shown and outcome is not None and lines is not None and outcome is not self._drawn:
            self._drawn = outcome
            scale = nice_scale(float(lines.largest[0]), LARGEST)
            self._curve.draw(list(lines.points + scale * lines.moves[..., 0]))
            place = lines.points[lines.names.index("platform"), 0] - [0, 0, BELOW["deflection"]]
            text = f"deflection × {number(scale, 3)}: {CASES[outcome.job.case][0]}"
            if self._label is None:
                self._label = self._scene.add_label(
                    "/elastic/deflected_label", text, font_screen_scale=0.9, anchor="top-center"
                )
            self._label.text, self._label.position = text, place
        self._curve.recolor(frame.state.theme.shown(DEFLECTED_COLOR))
        self._curve.visible = shown
        if self._label is not None:
            self._label.visible = shown


class ComplianceEllipsoid:
    """The layer ``compliance``: displacements of P by a force of one size in every direction."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: ElasticOutcome | None = None
        self._mesh: MeshHandle | None = None
        self._label: LabelHandle | None = None
        self._sphere = sphere()

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the result; nothing is sent while hidden."""
        del dragging
        view = frame.state.elastic_view
        outcome, found = view.outcome, view.result
        shown = "compliance" in frame.state.layers and _belongs(outcome, frame)
        compliance = None if found is None else found.stiffness.compliance
        shown = shown and compliance is not None
        if shown and outcome is not None and compliance is not None and outcome is not self._drawn:
            self._drawn = outcome
            self._draw(outcome, compliance[:3, :3])
        for node in (self._mesh, self._label):
            if node is not None:
                node.visible = shown

    def _draw(self, outcome: ElasticOutcome, compliance: Array) -> None:
        vertices, faces = self._sphere
        scale = nice_scale(float(np.linalg.norm(compliance, 2)), LONGEST_AXIS)
        shape = (scale * vertices @ compliance.T).astype(np.float32)
        if self._mesh is None:
            self._mesh = self._scene.add_mesh_simple(
                "/elastic/ellipsoid", shape, faces, color=palette.rgb(ELLIPSOID_COLOR),
                opacity=0.45, side="double", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
            self._label = self._scene.add_label(
                "/elastic/ellipsoid_label", "", font_screen_scale=0.9, anchor="top-center"
            )
        self._mesh.vertices = shape
        x, y, _, z = outcome.job.pose
        self._mesh.position = (x, y, z)
        if self._label is not None:
            self._label.text = ellipsoid_text(scale)
            self._label.position = (x, y, z - BELOW["compliance"])


def ellipsoid_text(scale: float) -> str:
    """Return the scale of the ellipsoid: drawn length for a displacement by 100 N."""
    return f"compliance: 100 mm = {number(1e3 * 100 * 0.1 / scale, 3)} mm by 100 N"
