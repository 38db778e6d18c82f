"""Maps as tables: CSV and NPZ, in SI units, with where they come from.

Numbers keep every bit: the CSV writes each in the shortest form that reads back as the same number.
What a map is, is said here by its shape alone, so that this module needs nothing of the figures.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from io import BytesIO
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.files.errors import printable
from paminsa_viz.model.design import KneeBranch
from paminsa_viz.model.reach import Limit, status_words

FORMAT = "paminsa_viz map 1"
"""Name and version of the layout of both files."""

_LETTERS = {"τ": "tau", "κ": "kappa", "Δ": "delta_", "θ": "theta", " ": "_", "_": "_"}
_UNITS = {"N·m": "Nm", "N m": "Nm", "1": ""}


class Source(Protocol):
    """Where a map comes from; `paminsa_viz.plots.maps.Provenance` is one."""

    @property
    def design(self) -> str: ...
    @property
    def knee(self) -> KneeBranch: ...
    @property
    def version(self) -> str: ...
    @property
    def numbers(self) -> tuple[tuple[str, float, str], ...]: ...
    @property
    def parameters(self) -> tuple[tuple[str, float], ...]: ...
    @property
    def reference(self) -> str: ...
    @property
    def reference_parameters(self) -> tuple[tuple[str, float], ...]: ...


class Map(Protocol):
    """A map, or several on one grid; `paminsa_viz.plots.maps.MapData` is one."""

    @property
    def x(self) -> NDArray[np.float64]: ...
    @property
    def y(self) -> NDArray[np.float64]: ...
    @property
    def values(self) -> NDArray[np.float64]: ...
    @property
    def status(self) -> NDArray[np.uint8]: ...
    @property
    def leg(self) -> NDArray[np.int8] | None: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def unit(self) -> str: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def singular_radius(self) -> float | None: ...
    @property
    def provenance(self) -> Source: ...
    @property
    def title(self) -> str: ...


def map_columns(data: Map) -> tuple[str, ...]:
    """Return the column names of the values, in plain letters, with their unit: ``tau1_Nm``."""
    unit = _UNITS.get(data.unit, data.unit)
    names = [_plain(name) + (f"_{unit}" if unit else "") for name in data.names]
    return tuple(
        name if names.count(name) == 1 else f"{name}_{i + 1}" for i, name in enumerate(names)
    )


def map_csv(data: Map) -> bytes:
    """Return a map as CSV (UTF-8): ``#`` lines of provenance, one header row, one row a cell.

    Rows run along x first. The columns are the pose of the cell, the values (empty where there is
    none) and the status in words, such as ``ok`` or ``stretched:leg2``.
    """
    lines = [f"# {key}: {value}" for key, value in _provenance(data).items()]
    lines.append(",".join(["x_m", "y_m", "theta_rad", "z_m", *map_columns(data), "status"]))
    rest = f"{float(data.pose[2])!r},{float(data.pose[3])!r}"
    x_words = [repr(value) for value in data.x.tolist()]
    words = status_words(data.status, -1 if data.leg is None else data.leg).tolist()
    for row, y in enumerate(data.y.tolist()):
        columns = [
            ["" if value != value else repr(value) for value in panel.tolist()]
            for panel in data.values[:, row]
        ]
        for x_word, *values, word in zip(x_words, *columns, words[row], strict=True):
            lines.append(f"{x_word},{y!r},{rest},{','.join(values)},{word}")
    return ("\n".join(lines) + "\n").encode()


def map_npz(data: Map) -> bytes:
    """Return a map as compressed NPZ; ``numpy.load`` reads it without ``allow_pickle``.

    Arrays: ``x_m`` (nx,), ``y_m`` (ny,), one (ny, nx) array for each of `map_columns`, ``status``
    (ny, nx) codes, ``status_words`` their names by code, ``leg`` (ny, nx) if known (index of the
    leg in the way, -1 for none), ``pose`` (4,) [m, m, rad, m], and ``provenance``, a JSON text.
    """
    arrays: dict[str, Any] = {"x_m": data.x, "y_m": data.y}
    arrays.update(zip(map_columns(data), data.values, strict=True))
    arrays["status"] = data.status
    arrays["status_words"] = np.array([limit.word for limit in Limit])
    if data.leg is not None:
        arrays["leg"] = data.leg
    arrays["pose"] = data.pose
    arrays["provenance"] = np.array(json.dumps(dict(_provenance(data)), ensure_ascii=False))
    stream = BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def _provenance(data: Map) -> Mapping[str, str]:
    """Return what a file says about a map: key and value, both on one line."""
    source = data.provenance
    x, y, theta, z = data.pose.tolist()
    said: dict[str, str] = {
        "format": FORMAT,
        "made by": f"paminsa_viz {source.version}",
        "title": data.title,
        "unit": data.unit,
        "design": source.design,
        "assembly": source.knee.value,
        "pose x [m]": repr(x),
        "pose y [m]": repr(y),
        "pose theta [rad]": repr(theta),
        "pose z [m]": repr(z),
    }
    if data.singular_radius is not None:
        said["singular radius [m]"] = repr(float(data.singular_radius))
    for symbol, value, unit in source.numbers:
        said[f"{symbol} [{unit}]" if unit else symbol] = repr(float(value))
    said.update((f"design {path}", repr(float(value))) for path, value in source.parameters)
    if source.reference:
        said["reference"] = source.reference
        said.update(
            (f"reference {path}", repr(float(value))) for path, value in source.reference_parameters
        )
    return {printable(key): printable(value) for key, value in said.items()}


def _plain(name: str) -> str:
    """Return a name in small ASCII letters and digits."""
    digits = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
    text = "".join(_LETTERS.get(c, c) for c in name.translate(digits)).lower()
    kept = "".join(c for c in text if c == "_" or (c.isascii() and c.isalnum()))
    return kept.strip("_") or "value"
