"""The wrench polytope of a pose: every external wrench that M1..M3 hold within their limits.

See `wrench_capability` for what it is and for the limits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.actuation.wrench_capability import capability
from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_pose
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.reach import check_reach


@dataclass(frozen=True, eq=False)
class WrenchPolytope:
    """The external wrenches (F_x, F_y, M_z) that can be held at one pose [N, N, N m].

    Attributes:
        rows: (3, 3) J for (x, y, theta) and M1..M3.
        torque: (3,) static torques of M1..M3 [N m].
        limits: (3,) their limits [N m].
        length: Characteristic length L = R_pl that M_z is divided by where it is drawn [m].
    """

    rows: Array
    torque: Array
    limits: Array
    length: float

    @property
    def center(self) -> Array:
        """Wrench that unloads M1..M3, (3,)."""
        return np.asarray(np.linalg.solve(self.rows.T, self.torque), dtype=np.float64)

    @property
    def vertices(self) -> Array:
        """The corners, (8, 3), in the order of the signs of tau_1, tau_2, tau_3."""
        signs = np.array(np.meshgrid(*[(-1, 1)] * 3, indexing="ij")).reshape(3, 8)
        corners = self.torque[:, None] - signs * self.limits[:, None]
        return np.asarray(np.linalg.solve(self.rows.T, corners).T, dtype=np.float64)

    @property
    def faces(self) -> tuple[str, ...]:
        """Names of the six faces: the actuator that is at its limit there, and its sign."""
        return tuple(f"{name} at {sign}T" for name in ACTUATORS[:3] for sign in ("+", "−"))

    @property
    def normals(self) -> tuple[Array, Array]:
        """Faces as half spaces n . w <= h: unit normals (6, 3), distances (6,), as `faces`.

        In (F_x, F_y, M_z / L), so that all three are forces [N].
        """
        scale = np.array([1.0, 1.0, self.length])
        # tau_0 - J^T w <= T and -(tau_0 - J^T w) <= T, by actuator
        columns = (self.rows * scale[:, None]).T
        normals = np.stack([-columns, columns], axis=1).reshape(6, 3)
        offsets = np.stack([self.limits - self.torque, self.limits + self.torque], axis=1).ravel()
        size = np.linalg.norm(normals, axis=1)
        return normals / size[:, None], offsets / size

    @property
    def holds(self) -> bool:
        """Whether the robot holds itself: zero is inside."""
        return bool((np.abs(self.torque) <= self.limits).all())

    @property
    def limiting_face(self) -> int:
        """Index of the face nearest to zero in (F_x, F_y, M_z / L), as `faces`."""
        return int(np.argmin(self.normals[1]))

    @kinds_checked
    def section(self, moment: float = 0.0) -> Array:
        """Return the force polygon at one M_z [N m]: corners (F_x, F_y), (n, 2), in order [N].

        Empty if no horizontal force is held with this moment.
        """
        from scipy.spatial import ConvexHull, HalfspaceIntersection  # slow to load

        gx, gy, gt = self.rows
        middle = self.torque - gt * moment
        half_planes = np.concatenate(
            [
                np.column_stack([-gx, -gy, middle - self.limits]),
                np.column_stack([gx, gy, -middle - self.limits]),
            ]
        )
        inside = _point_inside(half_planes)
        if inside is None:
            return np.empty((0, 2))
        corners = HalfspaceIntersection(half_planes, inside).intersections
        return corners[ConvexHull(corners).vertices]

    @property
    def sectors(self) -> tuple[str, ...]:
        """Which actuator limits each side of the force polygon, from a corner to the next."""
        polygon = self.section()
        middles = 0.5 * (polygon + np.roll(polygon, -1, axis=0))
        found = []
        for fx, fy in middles:
            use = (self.torque - self.rows[0] * fx - self.rows[1] * fy) / self.limits
            worst = int(np.argmax(np.abs(use)))
            found.append(f"{ACTUATORS[worst]} at {'+' if use[worst] > 0 else '−'}T")
        return tuple(found)


def _point_inside(half_planes: Array) -> Array | None:
    """Return the center of the largest disc in half planes a x + b y + c <= 0, None if empty."""
    from scipy.optimize import linprog  # slow to load

    size = np.linalg.norm(half_planes[:, :2], axis=1)
    if not (np.isfinite(half_planes).all() and (size > 0).all()):
        return None
    found = linprog(
        [0, 0, -1],
        A_ub=np.column_stack([half_planes[:, :2], size]),
        b_ub=-half_planes[:, 2],
        bounds=(None, None),
    )
    return found.x[:2] if found.status == 0 and found.x[2] > 1e-9 else None


@of_design
def wrench_polytope(design: Design, pose: ArrayLike) -> WrenchPolytope:
    """Return the wrench polytope of a design at one pose (4,) [m, m, rad, m].

    Raises:
        InvalidInput: If it is not one pose, or one that cannot be taken or is singular, so that it
            has none.
    """
    at = capability(design, as_pose(pose))
    if not (np.isfinite(at.torque).all() and np.isfinite(at.rows).all()):
        why = check_reach(design.geometry, at.pose).reason() or "it is singular"
        raise InvalidInput("pose", f"one that can be taken and is not singular is needed; {why}")
    length = design.geometry.platform_radius
    return WrenchPolytope(at.rows, at.torque[:3], at.limits.rated[:3], length)
