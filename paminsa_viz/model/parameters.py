"""The list of a design's numbers, made from the dataclasses' own field declarations."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass

from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.units import DisplayUnit, display_unit


@dataclass(frozen=True)
class Parameter:
    """One number of a design.

    Attributes:
        path: Dotted path for `Design.value` and `Design.vary`.
        symbol: Symbol in the paper.
        unit: SI unit, empty for pure numbers.
        label: Plain name.
        default: Appendix 4's value.
        positive: Whether zero is refused.
        signed: Whether it may be negative.
    """

    path: str
    symbol: str
    unit: str
    label: str
    default: float
    positive: bool
    signed: bool = False

    @property
    def display(self) -> DisplayUnit:
        """The unit that people read the number in."""
        return display_unit(self.unit)

    @property
    def group(self) -> str:
        """First part of the path, or ``"design"`` for a number that stands in no group."""
        return self.path.rpartition(".")[0] or "design"


def _parameters() -> tuple[Parameter, ...]:
    found = []
    for group in fields(APPENDIX_4):
        owner = getattr(APPENDIX_4, group.name)
        items = fields(owner) if is_dataclass(owner) else (group,)
        for item in (item for item in items if "unit" in item.metadata):
            path = item.name if item is group else f"{group.name}.{item.name}"
            found.append(
                Parameter(
                    path=path,
                    symbol=item.metadata["symbol"],
                    unit=item.metadata["unit"],
                    label=item.metadata["label"],
                    default=APPENDIX_4.value(path),
                    positive=item.metadata["positive"],
                    signed=item.metadata["signed"],
                )
            )
    return tuple(found)


PARAMETERS: tuple[Parameter, ...] = _parameters()
"""Every number of a design, in the order of the paper's Appendix 4."""

PARAMETER: dict[str, Parameter] = {parameter.path: parameter for parameter in PARAMETERS}
"""The same by path."""
