"""Running servers for the tests of what gets through to them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from paminsa_viz.explorer.server.listening import Limits

from .house import House


@pytest.fixture(scope="module")
def shared_house() -> Iterator[House]:
    # The page limit of this one house is wide: the tests come faster than people.
    house = House(Limits(sessions=200))
    yield house
    house.close()


@pytest.fixture
def house(shared_house: House) -> Iterator[House]:
    yield shared_house
    shared_house.leave()


@pytest.fixture
def strict_house() -> Iterator[Callable[[Limits], House]]:
    houses: list[House] = []

    def build(limits: Limits) -> House:
        houses.append(House(limits))
        return houses[-1]

    yield build
    for each in houses:
        each.close()
