"""Units of an FMU's variables, in the description of its model."""

from __future__ import annotations

from paminsa_viz.model import APPENDIX_4
from tests.codegen.test_fmu import KINDS, described


def test_units_are_products_of_the_base_units() -> None:
    bases = {"m": {"m": 1}, "rad": {"rad": 1}, "s": {"s": 1}, "kg": {"kg": 1}}
    bases["N"] = {"kg": 1, "m": 1, "s": -2}
    for kind in KINDS:
        units = list(described(APPENDIX_4, kind).iter("Unit"))
        names = [unit.attrib["name"] for unit in units]
        assert names == sorted(set(names))  # the same file whenever it is written
        for unit in units:
            over, _, under = unit.attrib["name"].partition("/")
            expected: dict[str, int] = {}
            for sign, factors in ((1, over.split(".")), (-1, under.split("."))):
                for factor in filter(None, factors):
                    name = factor.rstrip("2")
                    for base, power in bases[name].items():
                        times = 2 if factor.endswith("2") else 1
                        expected[base] = expected.get(base, 0) + sign * power * times
            (base_unit,) = unit
            assert {key: int(power) for key, power in base_unit.attrib.items()} == expected
