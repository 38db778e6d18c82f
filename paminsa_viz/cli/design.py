"""``paminsa-viz design``: check, show and compare design files, write Appendix 4's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import tyro

from paminsa_viz.blocks.kinds import Table
from paminsa_viz.blocks.kinds import rows as plain_rows
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import JsonFlags, check_output
from paminsa_viz.cli.output import print_blocks, print_error, print_json, print_written
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.design_file import load_design, save_design
from paminsa_viz.files.design_schema import CHOICE_MEANINGS, CHOICES, KEYS, choice
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Work with design files: a robot's lengths, masses and inertias as readable TOML.

  paminsa-viz design default --out robot.toml   a file to start from: the paper's Appendix 4
  paminsa-viz design check robot.toml           is it a possible robot?
  paminsa-viz design diff robot.toml            what differs from Appendix 4?
  paminsa-viz design diff a.toml b.toml         what differs between two designs?
  paminsa-viz design show robot.toml            every value with the paper's symbol

A file may leave values out; they are then Appendix 4's."""


@dataclass(frozen=True)
class CheckDesigns:
    """Say whether design files can be used; exit code 2 if one cannot."""

    files: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """Design files."""

    def run(self) -> int:
        """Check every file, also those after a bad one."""
        if not self.files:
            raise UsageError("a file is needed; see paminsa-viz design check --help")
        code = 0
        for file in self.files:
            try:
                design = load_design(file)
            except PaminsaError as error:
                print_error(error)
                code = 2
                continue
            count = sum(a != b for _, _, a, b, _ in _rows(APPENDIX_4, design))
            count += len(design.counterweights)
            count += sum(drive is not None for drive in design.drives)
            changed = f"{count} value{' differs' if count == 1 else 's differ'} from Appendix 4"
            print(f'{file}: fine, "{design.name}", {changed if count else "as Appendix 4"}')
        return code


@dataclass(frozen=True, kw_only=True)
class Show(JsonFlags):
    """Print every value of a design with its symbol and unit."""

    file: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file; Appendix 4 if left out."""

    def run(self) -> int:
        """Print the table."""
        design = _load(self.file)
        if self.json:
            values = {key.path: design.value(key.parameter.path) for key in KEYS}
            facts: dict[str, Any] = {
                "name": design.name,
                "knee": design.geometry.knee.value,
                "load_frame": design.load.frame.value,
                "values": values,
                "counterweights": _weights(design),
            }
            print_json(facts | ({"drives": _drives(design)} if any(design.drives) else {}))
            return 0
        print(design.name)
        rows = [(table, name, _text(v), what) for table, name, v, _, what in _rows(design, design)]
        rows += [
            ("counterweights", "mass_kg", _text(weight.mass), weight.place)
            for weight in design.counterweights
        ]
        rows += [
            ("drives", actuator, "", drive.summary)
            for actuator, drive in zip(ACTUATORS, design.drives, strict=True)
            if drive is not None
        ]
        print_blocks([Table(("",) * 4, plain_rows(*rows), words=4)])
        return 0


@dataclass(frozen=True)
class Default:
    """Write Appendix 4's design file, to the screen or to a file."""

    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """File to write; one that exists is replaced."""

    def run(self) -> int:
        """Write it."""
        check_output("--out", self.out, [".toml"])
        comment = f"Written by {MADE_BY}."
        if self.out is None:
            print(write_design(APPENDIX_4, comment=comment), end="")
        else:
            print_written([save_design(APPENDIX_4, self.out, comment=comment)])
        return 0


@dataclass(frozen=True, kw_only=True)
class Diff(JsonFlags):
    """Print the values in which two designs differ."""

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """Design file."""
    other: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file to compare with it; if left out, the first one is compared with Appendix 4."""

    def run(self) -> int:
        """Print the table."""
        files = (None, self.file) if self.other is None else (self.file, self.other)
        first, second = designs = tuple(map(_load, files))
        changed = [row for row in _rows(first, second) if row[2] != row[3]]
        weighted = first.counterweights != second.counterweights
        driven = first.drives != second.drives
        if self.json:
            facts: dict[str, Any] = {"first": first.name, "second": second.name}
            facts["differences"] = {
                f"{table}.{name}" if table else name: {"first": a, "second": b}
                for table, name, a, b, _ in changed
            }
            if weighted:
                weights = map(_weights, designs)
                facts["counterweights"] = dict(zip(("first", "second"), weights, strict=True))
            if driven:
                facts["drives"] = {"first": _drives(first), "second": _drives(second)}
            print_json(facts)
            return 0
        if not changed and not weighted and not driven:
            print("the designs have the same values")
            return 0
        head = ("", "", *(str(file or APPENDIX_4.name) for file in files), "Change", "")
        rows = []
        for table, name, a, b, what in changed:
            change = ""
            if isinstance(a, float) and isinstance(b, float) and a != 0 and abs(a + b) < math.inf:
                change = f"{100 * (b / a - 1):+.3g} %"
            rows.append((table, name, _text(a), _text(b), change, what))
        if weighted:
            held = [
                "; ".join(f"{w.mass:.6g} kg on {w.place}" for w in design.counterweights) or "-"
                for design in designs
            ]
            rows.append(("counterweights", "", *held, "", ""))
        for actuator, *pair in zip(ACTUATORS, first.drives, second.drives, strict=True):
            if pair[0] != pair[1]:
                texts = ["-" if drive is None else drive.summary for drive in pair]
                rows.append(("drives", actuator, *texts, "", ""))
        print_blocks([Table(head, plain_rows(*rows), words=6)])
        return 0


FLAGS: Any = (
    Annotated[CheckDesigns, tyro.conf.subcommand("check")]
    | Annotated[Show, tyro.conf.subcommand("show")]
    | Annotated[Default, tyro.conf.subcommand("default")]
    | Annotated[Diff, tyro.conf.subcommand("diff")]
)

Row: TypeAlias = tuple[str, str, float | str, float | str, str]


def _rows(first: Design, second: Design) -> list[Row]:
    """Return table, key, both values and the meaning of everything that a design file holds."""
    rows: list[Row] = []
    for key in KEYS:
        parameter = key.parameter
        values = (first.value(parameter.path), second.value(parameter.path))
        rows.append((key.table, key.name, *values, f"{parameter.symbol}, {parameter.label}"))
    for table, name in CHOICES:
        last = max(place for place, row in enumerate(rows) if row[0] == table)
        words = [choice(design, table, name).value for design in (first, second)]
        rows.insert(last + 1, (table, name, *words, CHOICE_MEANINGS[name]))
    return rows


def _text(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return f"{value:.10g}" if math.isfinite(value) else "rigid"


def _load(file: Path | None) -> Design:
    return APPENDIX_4 if file is None else load_design(file)


def _weights(design: Design) -> list[Any]:
    return list(design.counterweights)


def _drives(design: Design) -> dict[str, Any]:
    """Return the drives by actuator, for JSON."""
    pairs = zip(ACTUATORS, design.drives, strict=True)
    return {name: drive for name, drive in pairs if drive is not None}
