"""``paminsa-viz design``: check, show and compare design files, write Appendix 4's."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz import __version__
from paminsa_viz.cli.arguments import UsageError, parse, print_error
from paminsa_viz.cli.output import print_json, print_table
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.design_file import load_design, save_design
from paminsa_viz.files.design_schema import CHOICE_MEANINGS, CHOICES, KEYS, DesignKey, choice
from paminsa_viz.files.design_writer import differences, write_design
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.drive import ACTUATORS

DESCRIPTION = """\
Work with design files: a robot's lengths, masses and inertias as readable TOML.

  paminsa-viz design default --out robot.toml   a file to start from: the paper's Appendix 4
  paminsa-viz design check robot.toml           is it a possible robot?
  paminsa-viz design diff robot.toml            what differs from Appendix 4?
  paminsa-viz design diff a.toml b.toml         what differs between two designs?
  paminsa-viz design show robot.toml            every value with the paper's symbol

A file may leave values out; they are then Appendix 4's."""


@dataclass(frozen=True)
class Check:
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
            count = len(differences(APPENDIX_4, design)) + len(design.counterweights)
            count += len(_different_choices(APPENDIX_4, design))
            count += sum(drive is not None for drive in design.drives)
            changed = f"{count} value{' differs' if count == 1 else 's differ'} from Appendix 4"
            print(f'{file}: fine, "{design.name}", {changed if count else "as Appendix 4"}')
        return code


@dataclass(frozen=True)
class Show:
    """Print every value of a design with its symbol and unit."""

    file: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file; Appendix 4 if left out."""
    json: bool = False
    """Print JSON for other programs."""

    def run(self) -> int:
        """Print the table."""
        design = _load(self.file)
        if self.json:
            weights = [vars(weight) for weight in design.counterweights]
            values: dict[str, Any] = {
                "name": design.name,
                "knee": design.geometry.knee.value,
                "load_frame": design.load.frame.value,
                "values": _values(design),
                "counterweights": weights,
            }
            print_json(values | ({"drives": _drives(design)} if any(design.drives) else {}))
            return 0
        print(design.name)
        rows = [
            (key.table, key.name, f"{design.value(key.parameter.path):.10g}", _meaning(key))
            for key in KEYS
        ]
        for table, name in CHOICES:
            last = max(place for place, row in enumerate(rows) if row[0] == table)
            word = choice(design, table, name).value
            rows.insert(last + 1, (table, name, word, CHOICE_MEANINGS[name]))
        rows += [
            ("counterweights", "mass_kg", f"{weight.mass:.10g}", weight.place)
            for weight in design.counterweights
        ]
        rows += [
            ("drives", actuator, "", drive.summary)
            for actuator, drive in zip(ACTUATORS, design.drives, strict=True)
            if drive is not None
        ]
        print_table(rows)
        return 0


@dataclass(frozen=True)
class Default:
    """Write Appendix 4's design file, to the screen or to a file."""

    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """File to write; one that exists is replaced."""

    def run(self) -> int:
        """Write it."""
        comment = f"Written by paminsa_viz {__version__}."
        if self.out is None:
            print(write_design(APPENDIX_4, comment=comment), end="")
        else:
            print(f"{save_design(APPENDIX_4, self.out, comment=comment)}: written")
        return 0


@dataclass(frozen=True)
class Diff:
    """Print the values in which two designs differ."""

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """Design file."""
    other: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file to compare with it; if left out, the first one is compared with Appendix 4."""
    json: bool = False
    """Print JSON for other programs."""

    def run(self) -> int:
        """Print the table."""
        files = (None, self.file) if self.other is None else (self.file, self.other)
        first, second = map(_load, files)
        found = differences(first, second)
        chosen = _different_choices(first, second)
        weighted = first.counterweights != second.counterweights
        driven = first.drives != second.drives
        if self.json:
            changes: dict[str, Any] = {key.path: {"first": a, "second": b} for key, a, b in found}
            for table, name, a, b in chosen:
                changes[f"{table}.{name}"] = {"first": a, "second": b}
            weights = {
                name: [vars(weight) for weight in design.counterweights]
                for name, design in (("first", first), ("second", second))
            }
            facts = {"first": first.name, "second": second.name, "differences": changes}
            facts |= {"counterweights": weights} if weighted else {}
            drives = {"first": _drives(first), "second": _drives(second)}
            facts |= {"drives": drives} if driven else {}
            print_json(facts)
        elif not (found or weighted or driven or chosen):
            print("the designs have the same values")
        else:
            rows: list[tuple[str, ...]] = [
                (
                    key.table,
                    key.name,
                    f"{a:.10g}",
                    f"{b:.10g}",
                    f"{100 * (b / a - 1):+.3g} %" if a else "",
                    _meaning(key),
                )
                for key, a, b in found
            ]
            rows += [(table, name, a, b, "", CHOICE_MEANINGS[name]) for table, name, a, b in chosen]
            if weighted:
                held = [
                    "; ".join(f"{w.mass:.6g} kg on {w.place}" for w in design.counterweights) or "-"
                    for design in (first, second)
                ]
                rows.append(("counterweights", "", *held, "", ""))
            for actuator, *pair in zip(ACTUATORS, first.drives, second.drives, strict=True):
                if pair[0] != pair[1]:
                    texts = ["-" if drive is None else drive.summary for drive in pair]
                    rows.append(("drives", actuator, *texts, "", ""))
            names = [str(file or APPENDIX_4.name) for file in files]
            print_table([("", "", *names, "change", ""), *rows])
        return 0


def main(words: list[str]) -> int:
    """Run one of the command's parts."""
    kinds: Any = (
        Annotated[Check, tyro.conf.subcommand("check")]
        | Annotated[Show, tyro.conf.subcommand("show")]
        | Annotated[Default, tyro.conf.subcommand("default")]
        | Annotated[Diff, tyro.conf.subcommand("diff")]
    )
    return parse(kinds, words, "design", DESCRIPTION).run()


def _load(file: Path | None) -> Design:
    return APPENDIX_4 if file is None else load_design(file)


def _different_choices(first: Design, second: Design) -> list[tuple[str, str, str, str]]:
    """Return table, key and both words of the choices in which two designs differ."""
    found = [
        (table, name, *(choice(design, table, name).value for design in (first, second)))
        for table, name in CHOICES
    ]
    return [row for row in found if row[2] != row[3]]


def _drives(design: Design) -> dict[str, Any]:
    """Return the drives by actuator, for JSON."""
    pairs = zip(ACTUATORS, design.drives, strict=True)
    return {name: asdict(drive) for name, drive in pairs if drive is not None}


def _values(design: Design) -> dict[str, float]:
    return {key.path: design.value(key.parameter.path) for key in KEYS}


def _meaning(key: DesignKey) -> str:
    return f"{key.parameter.symbol}, {key.parameter.label}"
