"""Symbols, units and numbers as text."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.symbols import change_text, edge, html, number, plain, unit_text
from paminsa_viz.model import APPENDIX_4
from tests.explorer.design_rows import ROWS


@pytest.mark.parametrize(
    ("symbol", "label", "markup"),
    [
        ("m_5", "m₅", "<i>m</i><sub>5</sub>"),
        ("m_B10", "m_B10", "<i>m</i><sub>B10</sub>"),
        ("I_XX^(B3)", "I_XX(B3)", "<i>I</i><sub>XX</sub><sup>(B3)</sup>"),
        (
            "l_B4 = k l_B7",
            "l_B4 = k·l_B7",
            "<i>l</i><sub>B4</sub> = <i>k</i>·<i>l</i><sub>B7</sub>",
        ),
        ("|X_4| max", "|X₄| max", "|<i>X</i><sub>4</sub>| max"),
        ("g", "g", "<i>g</i>"),
    ],
)
def test_symbols_read_like_the_paper(symbol: str, label: str, markup: str) -> None:
    assert plain(symbol) == label
    assert html(symbol) == markup


def test_units_read_like_units() -> None:
    assert unit_text("kg m^2") == "kg·m²"
    assert unit_text("N m s/rad") == "N·m·s/rad"
    assert unit_text("m/s^2") == "m/s²"
    assert unit_text("rad/s, m/s") == "rad/s, m/s"


@given(path=st.sampled_from(sorted(ROWS)), value=st.floats(1e-6, 100))
def test_a_value_is_the_same_after_a_visit_to_the_page(path: str, value: float) -> None:
    shown = edge(path)
    assert shown.inside(shown.shown(value)) == pytest.approx(value, abs=1e-9)
    assert shown.inside(round(shown.shown(value), 3)) == pytest.approx(value, abs=1e-3)


def test_appendix_4_is_the_same_to_the_last_digit_after_a_visit_to_the_page() -> None:
    for path in ROWS:
        value = APPENDIX_4.value(path)
        assert edge(path).inside(edge(path).shown(value)) == value


def test_lengths_are_in_millimeters() -> None:
    assert edge("geometry.guide_link_length").text(0.3635) == "363.5 mm"
    assert edge("links.b3").text(0.406) == "0.406 kg"
    assert edge("geometry.magnification").text(3.0) == "3"


@given(value=st.floats(-1e12, 1e12))
def test_a_number_can_be_read_back(value: float) -> None:
    text = number(value)
    plain_text = text.translate(str.maketrans("−⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "-0123456789-")).replace("·10", "e")
    assert float(plain_text) == pytest.approx(value, rel=1e-5, abs=1e-300)
    assert "-" not in text
    assert text != "−0"


def test_changes_are_percentages_of_where_they_started() -> None:
    assert change_text(2.0, 3.0) == "+50.0 %"
    assert change_text(2.0, 1.0) == "−50.0 %"
    assert change_text(-2.0, -1.0) == "−50.0 %"
    assert change_text(1.0, 5.0) == "+400 %"
    assert change_text(1.0, 50.0) == "×50"
    assert change_text(1.0, 1.0 + 1e-9) == "≈ 0 %"
    assert change_text(0.0, 5.0) == "new"
