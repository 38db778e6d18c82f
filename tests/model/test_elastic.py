"""Elastic data of a design: documented defaults, tubes, what is refused, and its file."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_file import read_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, TILT_INERTIA, Design
from paminsa_viz.model.elastic import BARS, Elastic, tube_section

LENGTHS = {
    "b1": APPENDIX_4.geometry.arm_length,
    "b2": APPENDIX_4.geometry.shaft_length,
    "b3": APPENDIX_4.geometry.crank_length,
    "b4": APPENDIX_4.geometry.coupler_length,
    "b7": APPENDIX_4.geometry.short_coupler_length,
    "b8": APPENDIX_4.geometry.crank_length,
    "b10": APPENDIX_4.geometry.guide_link_length,
}

ELASTIC = [p for p in PARAMETER.values() if p.group == "elastic"]


@pytest.mark.parametrize("bar", BARS)
def test_default_tubes_weigh_what_appendix_4_gives(bar: str) -> None:
    elastic = APPENDIX_4.elastic
    mass = elastic.density * elastic.section(bar).area * LENGTHS[bar]
    assert mass == pytest.approx(APPENDIX_4.value(f"links.{bar}"), rel=0.005)


@given(outer=st.floats(1e-3, 1.0), share=st.floats(0.0, 0.99))
def test_tube_is_a_disc_less_a_disc(outer: float, share: float) -> None:
    tube, disc = tube_section(outer, share * outer), tube_section(outer, 0.0)
    inner = share * outer  # which may be rounded to zero
    hole = tube_section(inner, 0.0) if inner else disc._replace(area=0.0, inertia_in=0.0)
    assert tube.area == pytest.approx(disc.area - hole.area, rel=1e-9)
    assert tube.inertia_in == pytest.approx(disc.inertia_in - hole.inertia_in, rel=1e-9)
    assert tube.torsion == 2 * tube.inertia_in == 2 * tube.inertia_out
    assert disc.area == pytest.approx(math.pi * outer**2 / 4)
    assert disc.inertia_in == pytest.approx(math.pi * outer**4 / 64)
    assert disc.shear == pytest.approx(6 * 1.3 / (7 + 6 * 0.3))
    assert 0.5 < tube.shear <= disc.shear


@given(nu=st.floats(0.0, 0.5), share=st.floats(0.0, 0.99))
def test_shear_area_is_that_of_the_flexure_of_a_ring(nu: float, share: float) -> None:
    """Cowper's definition, of the harmonic function that leaves both surfaces free of shear."""
    area, second = math.pi * (1 - share**2), math.pi / 4 * (1 - share**4)
    along = -(0.75 + nu / 2) * (1 + share**2), -(0.75 + nu / 2) * share**2  # of r and of 1/r

    def integral(r: float) -> float:
        return math.pi * (along[0] * r**4 / 4 + along[1] * r**2 / 2 + r**6 / 24)

    expected = 2 * (1 + nu) * second**2 / (area * (integral(share) - integral(1.0)))
    assert tube_section(2.0, 2 * share, nu).shear == pytest.approx(expected, rel=1e-9)
    elastic = Elastic(young_modulus=2 * 26e9 * (1 + nu), shear_modulus=26e9)
    assert elastic.poisson == pytest.approx(nu, abs=1e-12)
    tube = tube_section(elastic.b4_outer, elastic.b4_inner, nu)
    assert elastic.section("b4").shear == pytest.approx(tube.shear)


@pytest.mark.parametrize("bar", BARS)
@pytest.mark.parametrize("inner", [0.02, 0.021, 1.0])
def test_tube_without_a_wall_is_refused(bar: str, inner: float) -> None:
    with pytest.raises(InvalidDesign, match="below its outer one, here") as caught:
        APPENDIX_4.vary({f"elastic.{bar}_outer": 0.02, f"elastic.{bar}_inner": inner})
    assert (caught.value.field, caught.value.value) == (f"elastic.{bar}_inner", inner)


def test_zero_is_refused_with_its_reason() -> None:
    for path in (p.path for p in ELASTIC if p.positive):
        with pytest.raises(InvalidDesign, match="above 0") as caught:
            APPENDIX_4.vary({path: 0.0})
        assert caught.value.field == path


def test_numbers_left_open_count_as_the_tube_and_as_rigid() -> None:
    assert APPENDIX_4.stored("elastic.b4_area") is None
    assert APPENDIX_4.value("elastic.b4_area") == APPENDIX_4.elastic.section("b4").area
    assert APPENDIX_4.value("elastic.guide") == math.inf
    assert APPENDIX_4.value("elastic.platform_tilt_inertia") == 0.5 * APPENDIX_4.platform.inertia
    with pytest.raises(InvalidDesign, match="I_pl/2"):
        APPENDIX_4.vary({"elastic.platform_tilt_inertia": 0.007})
    flat = 0.5 * APPENDIX_4.platform.inertia  # of a plate without height
    assert APPENDIX_4.vary({"elastic.platform_tilt_inertia": flat}).stored(TILT_INERTIA) == flat
    given_area = APPENDIX_4.vary({"elastic.b4_area": 1e-4, "elastic.guide": 1e7})
    section, tube = given_area.elastic.section("b4"), APPENDIX_4.elastic.section("b4")
    assert section == tube._replace(area=1e-4)
    assert given_area.value("elastic.guide") == 1e7
    assert APPENDIX_4.vary({"elastic.b4_area": None}) == APPENDIX_4


@given(data=st.data())
def test_only_what_is_not_the_default_is_written_and_read_back(data: st.DataObject) -> None:
    assert "elastic" not in write_design(APPENDIX_4)
    paths = [p.path for p in ELASTIC if not p.path.endswith("inner")]
    chosen = data.draw(st.lists(st.sampled_from(paths), unique=True, max_size=5))
    design = APPENDIX_4.vary(dict.fromkeys(chosen, 0.07))
    text = write_design(design)
    assert read_design(text, "a.toml") == design
    table = text.partition("[elastic]")[2]
    assert sum("=" in line for line in table.splitlines()) == len(chosen)


def test_error_in_a_file_names_its_line() -> None:
    text = "schema_version = 1\n[elastic]\nb4_outer_m = 0.03\nb4_inner_m = 0.04\n"
    with pytest.raises(DesignFileError, match=r"line 4.*b4_inner_m.*below its outer"):
        read_design(text, "a.toml")


def test_the_rigid_robot_does_not_depend_on_it() -> None:
    soft = replace(APPENDIX_4, elastic=Elastic(young_modulus=1e9))
    assert soft != APPENDIX_4
    assert soft.geometry is APPENDIX_4.geometry
    assert len({soft, APPENDIX_4, Design(elastic=Elastic(young_modulus=1e9))}) == 2
