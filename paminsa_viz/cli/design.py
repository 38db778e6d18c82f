"""``paminsa-viz design``: check, show and compare design files, write Appendix 4's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.design import (
    changes_text,
    difference_blocks,
    difference_data,
    values_data,
    values_table,
)
from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import JsonFlags, check_output
from paminsa_viz.cli.output import (
    print_blocks,
    print_error,
    print_heading,
    print_json,
    print_written,
)
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.design_file import DesignContent, load_content, load_design, save_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model.design import APPENDIX_4, Design
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
            print(f'{file}: fine, "{design.name}", {changes_text(design)}')
        return code


@dataclass(frozen=True, kw_only=True)
class Show(JsonFlags):
    """Print every value of a design with its symbol and unit."""

    file: Annotated[OrNone[Path], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file; Appendix 4 if left out."""

    def run(self) -> int:
        """Print the table."""
        design = _load(self.file)
        if self.json:
            print_json(values_data(design))
        else:
            print_heading(design)
            print_blocks([values_table(design)])
        return 0


@dataclass(frozen=True)
class Default:
    """Write Appendix 4's design file, to the screen or to a file."""

    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
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
    """Print the values in which two designs differ, and what one file requires alone."""

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """Design file."""
    other: Annotated[OrNone[Path], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file to compare with it; if left out, the first one is compared with Appendix 4."""

    def run(self) -> int:
        """Print the table."""
        files = (None, self.file) if self.other is None else (self.file, self.other)
        first, second = map(_content, files)
        facts = difference_data(first.design, second.design)
        left, right = (str(file or APPENDIX_4.name) for file in files)
        blocks = difference_blocks(first.design, second.design, (left, right))
        if first.requirements != second.requirements:
            # Late: it brings volumes and proofs.
            from paminsa_viz.blocks.requirements import required_texts, requirements_difference

            blocks += requirements_difference(
                first.requirements, second.requirements, (left, right)
            )
            facts["requirements"] = {
                "first": required_texts(first.requirements),
                "second": required_texts(second.requirements),
            }
        if self.json:
            print_json(facts)
        else:
            print_blocks(blocks)
        return 0


FLAGS: Any = (
    Annotated[CheckDesigns, tyro.conf.subcommand("check")]
    | Annotated[Show, tyro.conf.subcommand("show")]
    | Annotated[Default, tyro.conf.subcommand("default")]
    | Annotated[Diff, tyro.conf.subcommand("diff")]
)


def _load(file: Path | None) -> Design:
    return _content(file).design


def _content(file: Path | None) -> DesignContent:
    return DesignContent(APPENDIX_4, None) if file is None else load_content(file)
