"""Regular grids of poses."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors

COORDINATES = ("x", "y", "theta", "z")


@dataclass(frozen=True)
class Grid:
    """Poses on a regular grid.

    Attributes:
        axes: Coordinates that vary, in the order of the result's axes, with their values, each
            (n,) [m or rad].
        fixed: (4,) pose that the other coordinates are taken from [m, m, rad, m].
    """

    axes: tuple[tuple[str, Array], ...]
    fixed: Array

    @classmethod
    def over(cls, fixed: ArrayLike, **axes: ArrayLike) -> Grid:
        """Make a grid over named coordinates; the first one named is the result's first axis.

        Raises:
            InvalidInput: If a coordinate is unknown, has no values, or is not one-dimensional.
        """
        made = []
        for name, values in axes.items():
            if name not in COORDINATES:
                raise InvalidInput(name, f"a grid varies {', '.join(COORDINATES)}")
            array = as_numbers(values, name)
            if array.ndim != 1 or array.size == 0:
                raise InvalidInput(name, f"one axis of values is needed; got {array.shape}")
            made.append((name, array))
        pose = as_vectors(fixed, "fixed")
        if pose.shape != (4,):
            raise InvalidInput("fixed", f"one pose (4,) is needed; got {pose.shape}")
        return cls(tuple(made), pose)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the result."""
        return tuple(values.size for _, values in self.axes)

    @property
    def size(self) -> int:
        """Number of poses."""
        return int(np.prod(self.shape, dtype=np.int64))

    def poses(self) -> Array:
        """Return every pose, (*shape, 4) [m, m, rad, m]."""
        pose = np.broadcast_to(self.fixed, (*self.shape, 4)).copy()
        mesh = np.meshgrid(*(values for _, values in self.axes), indexing="ij")
        for (name, _), values in zip(self.axes, mesh, strict=True):
            pose[..., COORDINATES.index(name)] = values
        return pose

    def split(self, poses: int) -> Iterator[tuple[tuple[slice, ...], Grid]]:
        """Cut the grid into pieces of at most ``poses`` poses, each with its index in the whole."""
        cuts = []
        for size in reversed(self.shape):
            step = max(1, min(size, poses))
            poses //= step
            cuts.append([slice(i, min(i + step, size)) for i in range(0, size, step)])
        for index in itertools.product(*reversed(cuts)):
            axes = zip(self.axes, index, strict=True)
            yield index, Grid(tuple((name, v[part]) for (name, v), part in axes), self.fixed)


def xy_grid(x: ArrayLike, y: ArrayLike, theta: float, z: float) -> Grid:
    """Return the grid of Fig. 3: rows along y, columns along x, at one theta [rad] and z [m]."""
    return Grid.over((0.0, 0.0, theta, z), y=y, x=x)
