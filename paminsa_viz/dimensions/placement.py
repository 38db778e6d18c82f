"""Where each body of the robot is in a configuration: positions and quaternions, batched.

Bodies and their frames, for leg k = 1, 2, 3 (all origins lie on the leg plane; bars are drawn at
their own offset across it, see `paminsa_viz.dimensions.layers`):

| body | origin | axes |
|---|---|---|
| carriage | robot axis at the height Z of the arms | world |
| platform | the platform's point P | turned by theta about z |
| leg{k}/guide | leg axis at z = 0 | leg |
| leg{k}/shaft | joint 3 | leg |
| leg{k}/slider | joint 8 | leg |
| leg{k}/swivel | joint 5 | leg |
| leg{k}/b3 | joint 3 | x from 4 to 7 |
| leg{k}/b4 | joint 9 | x from 9 to 5 |
| leg{k}/b7 | joint 8 | x from 8 to 7 |
| leg{k}/b8 | joint 8 | x from 8 to 9 |

Leg axes: x along the leg plane from the leg axis toward the platform, y across, z up. Bar axes are
the leg's turned about y.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import Configuration

LEG_BODIES: Final = ("guide", "shaft", "slider", "swivel", "b3", "b4", "b7", "b8")
"""Bodies of one leg."""

BODIES: Final = (
    "carriage",
    "platform",
    *(f"leg{leg}/{body}" for leg in (1, 2, 3) for body in LEG_BODIES),
)
"""Names of all moving bodies."""

ORIGIN: Final = {"shaft": 3, "slider": 8, "swivel": 5, "b3": 3, "b4": 9, "b7": 8, "b8": 8}
"""The paper's number of the joint at a body's origin; the guide's is the leg axis at z = 0."""


class Placement(NamedTuple):
    """Where a body frame is: position (..., 3) [m] and unit quaternion (..., 4), w first."""

    position: Array
    wxyz: Array

    @property
    def matrix(self) -> Array:
        """A placement of shape () as a homogeneous matrix, (4, 4)."""
        from scipy.spatial.transform import Rotation  # takes a while to load

        out = np.eye(4)
        out[:3, :3] = Rotation.from_quat(self.wxyz, scalar_first=True).as_matrix()
        out[:3, 3] = self.position
        return out


def heading_and_elevation(heading: Array, elevation: Array) -> Array:
    """Return the quaternion (..., 4) of a turn about z, after one that lifts x toward z [rad]."""
    h, e = np.asarray(heading) / 2, np.asarray(elevation) / 2
    ch, sh, ce, se = np.cos(h), np.sin(h), np.cos(e), np.sin(e)
    return np.stack([ch * ce, sh * se, -ch * se, sh * ce], axis=-1)


def about_z(angle: Array) -> Array:
    """Return the quaternion (..., 4) of a turn about z by ``angle`` [rad]."""
    return heading_and_elevation(angle, np.zeros_like(angle))


def elevated(angle: Array) -> Array:
    """Return the quaternion (..., 4) that lifts x by ``angle`` [rad] toward z, about -y."""
    return heading_and_elevation(np.zeros_like(angle), angle)


@kinds_checked
def place_parts(configuration: Configuration) -> dict[str, Placement]:
    """Return the placement of every moving body, by the names in `BODIES`.

    Poses may be single (4,) or batched (..., 4); placements are NaN where the configuration is.
    """
    pose, points = configuration.pose, configuration.points
    lift = np.zeros((*pose.shape[:-1], 3))
    lift[..., 2] = configuration.actuators[..., 3]
    level = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (*pose.shape[:-1], 4))
    placements = {
        "carriage": Placement(lift, level),
        "platform": Placement(pose[..., [0, 1, 3]], about_z(pose[..., 2])),
    }
    plane = about_z(configuration.beta)
    along_b8 = heading_and_elevation(configuration.beta, configuration.phi)
    along_b4 = heading_and_elevation(configuration.beta, configuration.psi)
    # B3 runs from 4 to 7 as B8 does from 9 to 8, so it points the other way.
    along_b3 = heading_and_elevation(configuration.beta, configuration.phi + np.pi)
    turned = {"b3": along_b3, "b4": along_b4, "b7": along_b4, "b8": along_b8}
    axis = points[3] * [1.0, 1.0, 0.0]
    for leg in range(3):
        for body in LEG_BODIES:
            origin = axis if body == "guide" else points[ORIGIN[body]]
            wxyz = turned.get(body, plane)
            placements[f"leg{leg + 1}/{body}"] = Placement(origin[..., leg, :], wxyz[..., leg, :])
    return placements
