"""Published or measured torques as tables, over time or positions, to draw beside computed ones."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import TableFileError
from paminsa_viz.files.columns import PUBLISHED, PUBLISHED_MAP, TIME, TORQUES
from paminsa_viz.files.table_reader import TableReader, open_table
from paminsa_viz.model.arrays import Array

MOST_ROWS = 100_000
"""Most rows of a table."""


@dataclass(frozen=True, eq=False)
class PublishedTorques:
    """Torques over time from elsewhere.

    Attributes:
        name: The file's name without its ending.
        t: (n,) times since the start of the motion, increasing [s].
        torque: (n, 4) of M1..M3 and force of M4 [N m, N]; NaN for those that the table lacks.
    """

    name: str
    t: Array
    torque: Array

    def at(self, t: Array) -> Array:
        """Return the torques at times (k,), linear in between; NaN outside of the table, (k, 4)."""
        columns = [np.interp(t, self.t, column) for column in self.torque.T]
        outside = (t < self.t[0]) | (t > self.t[-1])
        return np.where(outside[:, None], np.nan, np.stack(columns, axis=1))

    def differences(self, t: Array, torque: Array) -> Array:
        """Return computed minus published torques at the table's times, (n, 4).

        Args:
            t: (k,) times of the computed torques, increasing [s].
            torque: (k, 4) those.
        """
        computed = np.stack([np.interp(self.t, t, column) for column in torque.T], axis=1)
        outside = (self.t < t[0]) | (self.t > t[-1])
        return np.where(outside[:, None], np.nan, computed - self.torque)


def parse_published(lines: TextIO, source: str) -> PublishedTorques:
    """Read published torques from an open table.

    Columns are ``t_s`` and at least one of ``tau1_Nm, tau2_Nm, tau3_Nm, f4_N``, in any order.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.

    Raises:
        TableFileError: If the table is refused; row and column say where.
    """
    table = TableReader(lines, PUBLISHED, source)
    first_row, columns = table.read_all(MOST_ROWS)
    torque = _torques(columns, source)
    t = columns[TIME]
    if t.size < 2:
        raise TableFileError(source, "at least two rows are needed")
    table.require_increasing(TIME, t, first_row)
    return PublishedTorques(Path(source).stem, t, torque)


def _torques(columns: dict[str, Array], source: str) -> Array:
    """Return the torques of a table's columns (n, 4); NaN for those that it lacks."""
    given = [columns[name] for name in TORQUES if name in columns]
    if not given:
        raise TableFileError(source, f"at least one of {', '.join(TORQUES)} is needed")
    missing = np.full(given[0].size, np.nan)
    return np.stack([columns.get(name, missing) for name in TORQUES], axis=1)


@kinds_checked
def read_published(path: str | os.PathLike[str]) -> PublishedTorques:
    """Read published torques from a CSV file; see `parse_published`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_table(path) as lines:
        return parse_published(lines, os.fspath(path))


@dataclass(frozen=True, eq=False)
class PublishedMap:
    """Torques at rest over positions from elsewhere, at one angle and one height.

    Attributes:
        name: The file's name without its ending.
        position: (n, 2) = (x, y) of the platform [m].
        torque: (n, 4) of M1..M3 and force of M4 [N m, N]; NaN for those that the table lacks.
    """

    name: str
    position: Array
    torque: Array


def parse_published_map(lines: TextIO, source: str) -> PublishedMap:
    """Read published torques over positions from an open table.

    Columns are ``x_m, y_m`` and at least one of ``tau1_Nm, tau2_Nm, tau3_Nm, f4_N``.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.

    Raises:
        TableFileError: If the table is refused; row and column say where.
    """
    _, columns = TableReader(lines, PUBLISHED_MAP, source).read_all(MOST_ROWS)
    torque = _torques(columns, source)
    if not len(torque):
        raise TableFileError(source, "at least one row is needed")
    position = np.stack([columns["x_m"], columns["y_m"]], axis=1)
    return PublishedMap(Path(source).stem, position, torque)


@kinds_checked
def read_published_map(path: str | os.PathLike[str]) -> PublishedMap:
    """Read published torques over positions from a CSV file; see `parse_published_map`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_table(path) as lines:
        return parse_published_map(lines, os.fspath(path))
