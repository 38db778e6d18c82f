"""Timing and table printing shared by the benchmarks."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Sequence

import numba
import numpy as np


def best(run: Callable[[], object], *, seconds: float = 0.5, least: int = 3) -> float:
    """Return the shortest time of several runs [s]; what disturbs a run only makes it longer."""
    run()
    times: list[float] = []
    end = time.perf_counter() + seconds
    while len(times) < least or time.perf_counter() < end:
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def processor_time(run: Callable[[], object], times: int = 7) -> float:
    """Return the processor time of the best of several runs [s]: one core's, on any machine."""
    found = []
    for _ in range(times):
        start = time.process_time()
        run()
        found.append(time.process_time() - start)
    return min(found)


def processor() -> str:
    """Name the processor, as far as the system tells."""
    try:
        with open("/proc/cpuinfo") as lines:
            names = {line.split(":", 1)[1].strip() for line in lines if "model name" in line}
        return ", ".join(sorted(names)) or platform.processor()
    except OSError:
        return platform.processor() or platform.machine()


def heading(title: str) -> None:
    """Print what is measured and on what."""
    print(f"\n## {title}\n")
    print(
        f"{processor()}; Python {platform.python_version()}, NumPy {np.__version__}, "
        f"Numba {numba.__version__}\n"
    )


def table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a Markdown table."""
    cells = [list(columns), *[list(row) for row in rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]

    def line(row: Sequence[str]) -> str:
        return "| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |"

    print(line(cells[0]))
    print("|" + "|".join("-" * (w + 2) for w in widths) + "|")
    for row in cells[1:]:
        print(line(row))
    print(flush=True)


def number(value: float) -> str:
    """Write a number with three figures."""
    if value == 0 or not np.isfinite(value):
        return str(value)
    digits = max(0, 2 - int(np.floor(np.log10(abs(value)))))
    return f"{value:,.{digits}f}"
