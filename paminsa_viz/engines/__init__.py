"""The same robot in physics engines written by others, to check the model against.

The robot is described once as a tree of links with loop closures (`mechanism`), and each engine
builds its own model from that: MuJoCo from an MJCF text (`mjcf`, `mujoco_model`), Pinocchio joint
by joint (`pinocchio_model`). Mass matrices, bias forces and constraint Jacobians are the engines'
own; `closed_loop` only eliminates the dependent joints, and `play` simulates in MuJoCo. From the
model come the design and the joint values at a pose (`poses`), which the closures verify;
nothing of its statics and dynamics is used.

The engines are optional: ``pip install 'paminsa-viz[verify]'``.
"""

from __future__ import annotations

from paminsa_viz.errors import PaminsaError


class EngineMissing(PaminsaError, ImportError):
    """A requested physics engine is not installed, or does not load.

    Attributes:
        engine: Its name.
        extra: The optional extra of this package that brings it.
    """

    def __init__(self, engine: str, cause: ImportError | None = None) -> None:
        self.engine = engine
        self.extra = "verify"
        broken = cause is not None and not isinstance(cause, ModuleNotFoundError)
        super().__init__(
            f"{engine} {f'does not load ({cause})' if broken else 'is not installed'}; "
            f"it comes with the extra '{self.extra}': pip install 'paminsa-viz[{self.extra}]'"
        )
