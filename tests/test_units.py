"""Symbols, units and numbers as text."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, PARAMETER
from paminsa_viz.units import (
    NONE,
    TIE,
    as_sentence,
    counted,
    display_unit,
    fixed,
    format_ascii,
    format_value,
    interval_text,
    number,
    percent,
    percent_change,
    power_of_ten,
    rounded_to_side,
    symbol_html,
    symbol_text,
    symbols_html,
    symbols_math,
    tied,
    tied_html,
    unit_text,
)


def test_counts_have_commas_and_measured_numbers_have_none() -> None:
    assert counted(47889, "pose") == "47,889 poses"
    assert (counted(999, "row"), counted(1000, "row")) == ("999 rows", "1,000 rows")
    assert number(47889.0, 5) == "47889"


def test_an_error_becomes_a_sentence_and_symbols_stay_as_they_are() -> None:
    for text, sentence in (
        ("motion: there is none yet", "Motion: there is none yet."),
        ("a workspace is needed", "A workspace is needed."),
        ("it failed; see “Path”", "It failed; see “Path”."),
        ("Stopped.", "Stopped."),
        ("l_B3 = 5 mm: above 0 is needed", "l_B3 = 5 mm: above 0 is needed."),
        ("z = 5 mm is too high", "z = 5 mm is too high."),
        ("log.csv, row 3: no number", "log.csv, row 3: no number."),
        ("geometry.crank_length = 0", "geometry.crank_length = 0."),
        ("", ""),
    ):
        assert as_sentence(text) == sentence


@given(st.floats(-1e9, 1e9, allow_subnormal=False), st.integers(2, 8), st.booleans())
def test_what_is_rounded_to_a_side_is_not_on_the_other_and_has_few_digits(
    value: float, digits: int, up: bool
) -> None:
    rounded = rounded_to_side(value, digits, up=up)
    assert float(f"{rounded:.{digits}g}") == rounded
    away = (rounded - value) * (1 if up else -1)
    assert -1e-9 * abs(value) <= away <= 1.001 * 10.0 ** (1 - digits) * abs(value)
    assert rounded_to_side(3.0630000000000002, 4, up=True) == 3.063  # rounding alone


def test_one_is_no_plural() -> None:
    assert [counted(n, "row") for n in (0, 1, 2)] == ["0 rows", "1 row", "2 rows"]
    assert [counted(n, "body", "bodies") for n in (1, 2)] == ["1 body", "2 bodies"]


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
def test_symbols_as_text_and_html(symbol: str, label: str, markup: str) -> None:
    assert symbol_text(symbol) == label
    assert symbol_html(symbol) == markup


@pytest.mark.parametrize(
    ("text", "markup"),
    [
        ("a leg with M_p2 = 0 & more", "a leg with <i>M</i><sub>p2</sub> = 0 &amp; more"),
        ("I_XX^(B3) grows", "<i>I</i><sub>XX</sub><sup>(B3)</sup> grows"),
        ("max_imbalance", "max_imbalance"),
        ("g", "<i>g</i>"),
        ("τ_1, δ_tilt", "<i>τ</i><sub>1</sub>, <i>δ</i><sub>tilt</sub>"),
        ("K_θ", "<i>K</i><sub>θ</sub>"),
        ("m_pl R_pl²", "<i>m</i><sub>pl</sub> <i>R</i><sub>pl</sub>²"),
        ("l_B4 = k l_B7", "<i>l</i><sub>B4</sub> = k·<i>l</i><sub>B7</sub>"),
        ("link l_B7", "link <i>l</i><sub>B7</sub>"),
        ("ΔK_x", "Δ<i>K</i><sub>x</sub>"),
    ],
)
def test_symbols_in_a_sentence_are_typeset(text: str, markup: str) -> None:
    assert symbols_html(text) == markup


def test_large_percentages_have_the_power_of_ten_of_other_numbers() -> None:
    for share, text in (
        (0.125, "12.5 %"), (-999.994, "−99999.4 %"), (-3008.9, "−3.01·10⁵ %"), (math.nan, NONE),
        (math.inf, "∞ %"), (0.0, "0.0 %"),
    ):  # fmt: skip
        assert percent(share, 1) == text
    assert percent(3008.9, digits=3) == f"{number(300890.0, 3)} %" == "3.01·10⁵ %"
    assert percent(0.012345, digits=2, sign=True) == "+1.2 %"
    assert percent(0.125, digits=2) == "12 %"


def test_no_line_ends_between_a_number_and_its_unit_sign_or_symbol() -> None:
    for text, kept in (
        ("On 9 nodes 7.49 mm apart", "On 9 nodes 7.49~mm apart"),
        ("⌀ 3 × 4 mm, z −562 mm, θ 0°", "⌀~3~×~4~mm, z~−562~mm, θ~0°"),
        ("κ ≤ 10, z = −0.02 ± 0.5 N", "κ~≤~10, z~=~−0.02~±~0.5~N"),
        ("below 14 %; M1 to M3 2 springs", "below 14~%; M1 to M3 2 springs"),
    ):
        assert tied(text).replace(TIE, "~") == kept
    html = '<b title="at 5 mm">0.5</b> mrad, by up to 2 µm'
    assert tied_html(html).replace(TIE, "~") == '<b title="at 5 mm">0.5</b>~mrad, by up to 2~µm'


def test_indices_of_symbols_are_drawn_lower() -> None:
    assert symbols_math("σ/R_p") == r"σ/R$_\mathregular{p}$"
    assert symbols_math("ΔI_XX^(B3)") == r"ΔI$_\mathregular{XX}^\mathregular{(B3)}$"
    assert symbols_math("max |τ₁| in $") == r"max |τ₁| in \$"


@pytest.mark.parametrize(
    ("unit", "text"),
    [
        ("kg m^2", "kg·m²"), ("N m s/rad", "N·m·s/rad"), ("m/s^2", "m/s²"),
        ("rad/s, m/s", "rad/s, m/s"), ("1", ""), ("", ""),
    ],
)  # fmt: skip
def test_units_are_typeset(unit: str, text: str) -> None:
    assert unit_text(unit) == text


@given(path=st.sampled_from(sorted(PARAMETER)), value=st.floats(1e-6, 100))
def test_a_value_survives_the_display_unit(path: str, value: float) -> None:
    unit, own = PARAMETER[path].display, APPENDIX_4.stored(path)
    size = max(1.0, 1 / unit.factor)
    assert unit.to_si(unit.from_si(value)) == pytest.approx(value, abs=1e-9 * size)
    assert unit.to_si(round(unit.from_si(value), 3)) == pytest.approx(value, abs=1e-3 * size)
    assert own is None or unit.to_si(unit.from_si(own)) == own  # to the last digit


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.3635, "m", "363.5 mm"), (0.406, "kg", "0.406 kg"), (3.0, "", "3"), (2.5, "1", "2.5"),
        (np.pi / 6, "rad", "30°"), (-np.pi / 2, "rad/s", "−90°/s"), (np.pi, "rad/s²", "180°/s²"),
        (1.5, "m/s²", "1.5 m/s²"), (1.5, "m/s^2", "1.5 m/s²"), (0.0321, "kg m^2", "0.0321 kg·m²"),
        (-1.234e-13, "N m", "−1.234·10⁻¹³ N·m"), (np.nan, "m", "–"),
        (4.5e-5, "m:um", "45 µm"), (np.pi / 180, "rad:arcsec", "3600″"),
    ],
)  # fmt: skip
def test_values_are_formatted_in_display_units(value: float, unit: str, text: str) -> None:
    assert format_value(value, unit) == text


def test_ascii_values_have_plain_numbers() -> None:
    assert format_ascii(-1.234e-13, "m", 3) == "-1.23e-10 mm"
    assert format_ascii(float("nan"), "m") == "–"
    assert display_unit("rad").text == "°"


@given(value=st.floats(-1e12, 1e12))
def test_a_number_can_be_read_back(value: float) -> None:
    text = number(value, 6)
    plain_text = text.translate(str.maketrans("−⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "-0123456789-")).replace("·10", "e")
    assert float(plain_text) == pytest.approx(value, rel=1e-5, abs=1e-300)
    assert "-" not in text
    assert text != "−0"


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        (2.0, 3.0, "+50.0 %"), (2.0, 1.0, "−50.0 %"), (-2.0, -1.0, "−50.0 %"),
        (1.0, 5.0, "+400 %"), (1.0, 50.0, "×50"), (1.0, 1.0 + 1e-9, "≈ 0 %"), (0.0, 5.0, "new"),
        (np.nan, 5.0, "–"),
    ],
)  # fmt: skip
def test_changes_are_percentages_of_the_value_before(
    before: float, after: float, text: str
) -> None:
    assert percent_change(before, after) == text


def test_shares_in_percent_have_their_decimals_and_none_of_nothing() -> None:
    shown = [
        percent(0.1249, 1),
        percent(0.1249),
        percent(-0.0004),
        percent(np.inf),
        percent(np.nan),
    ]
    assert shown == ["12.5 %", "12 %", "0 %", "∞ %", "–"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"), (-0.0, "0"), (-12.5, "−12.5"), (1000.0, "1000"), (1e-7, "1·10⁻⁷"),
        (0.1 + 0.2, "0.3"), (123456.0, "1.235·10⁵"), (np.nan, "–"),
        (np.inf, "∞"), (-np.inf, "−∞"),
    ],
)  # fmt: skip
def test_numbers_are_short_with_a_true_minus_sign(value: float, text: str) -> None:
    assert number(value) == text


@given(value=st.floats(-1e9, 1e9).filter(bool), digits=st.integers(1, 6))
def test_padded_numbers_have_all_their_digits(value: float, digits: int) -> None:
    text, plain = number(value, digits, padded=True), number(value, digits)
    figures = text.partition("·")[0].lstrip("−0.").replace(".", "")
    assert len(figures) >= digits
    assert ".·" not in text
    assert not text.endswith(".")
    assert text.partition("·")[0].startswith(plain.partition("·")[0])
    assert text.partition("·")[2] == plain.partition("·")[2]


def test_numbers_below_a_hundred_thousand_have_no_exponent() -> None:
    assert [number(value, 3) for value in (999.6, 6912.9, -98765.0)] == ["1000", "6910", "−98800"]
    assert number(99996.0, 3) == "1·10⁵"
    assert number(1040.4, 2, sign=True) == "+1000"
    assert format_ascii(1.0404e-3, "m:um", 3) == "1040 µm"


def test_numbers_with_a_sign() -> None:
    assert [number(value, 3, sign=True) for value in (1.5, -1.5, 0.0)] == ["+1.5", "−1.5", "0"]
    assert number(np.inf, sign=True) == "+∞"
    shown = [fixed(value, 2, sign=True) for value in (1.5, -1.5, 0.001, -0.001, np.inf)]
    assert shown == ["+1.50", "−1.50", "0.00", "0.00", "+∞"]


def test_fixed_decimals_have_no_negative_zero() -> None:
    assert [fixed(value, 2) for value in (-0.001, -1.005, np.nan)] == ["0.00", "−1.00", "–"]
    assert [fixed(value, 2) for value in (np.inf, -np.inf)] == ["∞", "−∞"]
    assert power_of_ten(-3) == "10⁻³"


@pytest.mark.parametrize(
    ("value", "half_width", "text"),
    [
        (25.8347, 0.0499, "25.835 ± 0.050"),
        (-0.00871, 0.00153, "−0.0087 ± 0.0015"),
        (29.94, 7.92, "29.9 ± 7.9"),
        (1234.0, 56.0, "1234 ± 56"),
        (0.0, 0.012, "0.000 ± 0.012"),
        (1.5, float("inf"), NONE),
        (float("nan"), 0.1, NONE),
        (2.0, 0.0, "2"),
        (3e12, 1.0, "3·10¹² ± 1"),
        (-1.5321e-13, 4.9e-14, "−1.53·10⁻¹³ ± 4.9·10⁻¹⁴"),
        (8.2e-15, 5.2e-14, "8·10⁻¹⁵ ± 5.2·10⁻¹⁴"),
        (0.0, 5.2e-14, "0 ± 5.2·10⁻¹⁴"),
    ],
)
def test_intervals_have_two_digits_and_the_value_as_many_decimals(value, half_width, text) -> None:
    assert interval_text(value, half_width) == text
    ascii_only = interval_text(value, half_width, ascii_only=True)
    assert ascii_only.isascii()
    if "·" not in text:
        assert ascii_only == text.replace("±", "+-").replace("−", "-").replace(NONE, "-")


def test_numbers_without_a_factor_are_shown_whole_and_as_floats() -> None:
    """viser casts what is typed to the kind of the number that an input had before."""
    unit = display_unit("kg m^2")
    assert unit.from_si(8.5e-12) == 8.5e-12
    assert isinstance(unit.from_si(3), float)
