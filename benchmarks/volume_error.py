"""Whether the stated error of volumes holds: random robots, bounds and headings, point by point.

Run: ``python -m benchmarks.volume_error --cases 200``.
"""

from __future__ import annotations

import argparse

import numpy as np

from benchmarks.measure import heading, number, table
from tests.synthesis.volumes import counted_volume


def main() -> None:
    """Compare volumes with counted ones."""
    parser = argparse.ArgumentParser(prog="volume_error", description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--first", type=int, default=1000, help="seed of the first case")
    parser.add_argument("--nodes", type=int, default=20_000)
    parser.add_argument("--points", type=int, default=2**16, help="counted; a power of two")
    given = parser.parse_args()
    rows: list[tuple[float, float, float]] = []
    empty = 0
    for seed in range(given.first, given.first + given.cases):
        volume, counted = counted_volume(seed, given.nodes, given.points)
        if volume.volume == 0.0 or counted.volume == 0.0:
            empty += 1
            continue
        off = volume.volume - counted.volume
        rows.append((off / volume.error, off / counted.volume, volume.error / counted.volume))
        if abs(off) > volume.error + counted.deviation:
            print(f"seed {seed}: {off:+.3g} m^3, stated {volume.error:.3g}, "
                  f"counted to {counted.deviation:.3g}")  # fmt: skip
    of_error, share, stated = np.array(rows).T
    heading(f"{len(rows)} random robots at {given.nodes} nodes, {empty} others with no volume")
    table(
        ["", "mean", "median of size", "largest size"],
        [
            ["off, over the stated error", number(of_error.mean()),
             number(float(np.median(np.abs(of_error)))), number(np.abs(of_error).max())],
            ["off [%]", number(100 * share.mean()),
             number(100 * float(np.median(np.abs(share)))), number(100 * np.abs(share).max())],
            ["stated error [%]", number(100 * stated.mean()),
             number(100 * float(np.median(stated))), number(100 * stated.max())],
        ],
    )  # fmt: skip
    print(f"held by {int((np.abs(of_error) <= 1.0).sum())} of {len(rows)}")


if __name__ == "__main__":
    main()
