"""Whatever an upload holds, it is read whole or refused with one line that names the place."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.files.design_document import WrongDocument, checked_content
from paminsa_viz.files.design_file import LARGEST_FILE, load_design, read_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.toml_table import find_line
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.parameters import Counterweight

VERSION = "schema_version = 1\n"
WEIGHT = '[[counterweights]]\nbar = "B8"\njoint = 8\nbeyond_m = 0.1\nmass_kg = 1\n'
COMPLETE = write_design(APPENDIX_4)
UPPER = APPENDIX_4.with_knee(KneeBranch.UPPER)


def attempt(content: str) -> Design | DesignFileError:
    """Read a design; a refusal, checked to be one short line, is returned instead of raised."""
    try:
        return read_design(content, "up.toml")
    except DesignFileError:
        return refusal(content)


def refusal(content: str | bytes, source: str = "up.toml") -> DesignFileError:
    with pytest.raises(DesignFileError) as caught:
        read_design(content, source)
    text = str(caught.value)
    assert text.isprintable()
    assert len(text) < 1000
    assert text.startswith(source)
    return caught.value


@pytest.mark.parametrize(
    ("content", "line", "key", "words"),
    [
        ("", None, "", "schema_version = 1"),
        ("x = 1", None, "", "is not a design file"),
        ("schema_version = 2\nnew = 1", 1, "schema_version", "newer"),
        ("schema_version = 0", 1, "schema_version", "whole number"),
        ("schema_version = '1'", 1, "schema_version", "whole number"),
        (VERSION + "[links]\nb3_kg = 'heavy'", 3, "links.b3_kg", "without quotes or unit"),
        (VERSION + "[links]\nb3_kg = true", 3, "links.b3_kg", "a number is needed"),
        (VERSION + "[links]\nb3_kg = {a=1}", 3, "links.b3_kg", "a table: a number is needed"),
        (VERSION + "[links]\nb3_kg = nan", 3, "links.b3_kg", "nan: a finite number"),
        (VERSION + "[links]\nb3_kg = 1e999", 3, "links.b3_kg", "a finite number"),
        (VERSION + "[links]\nb3_kg = 1" + 400 * "0", 3, "links.b3_kg", "fewer digits is needed"),
        (VERSION + "[links]\n\nb3_kg = -1", 4, "links.b3_kg", "-1.0: a finite number of at least"),
        (VERSION + "links.b3_kg = -1", 2, "links.b3_kg", "of at least 0 and at most 10000"),
        (VERSION + "links = {b3_kg = -1}", 2, "links.b3_kg", "of at least 0 and at most 10000"),
        (VERSION + "[platform]\nmass_kg = 0", 3, "platform.mass_kg", "above 0"),
        (VERSION + "gravity_m_per_s2 = -9.81", 2, "gravity_m_per_s2", "of at least 0"),
        (VERSION + "gravity_m_per_s2 = 1e-300", 2, "gravity_m_per_s2", "below 1e-30"),
        (VERSION + "[geometry]\nbase_radius_m = 1e300", 3, "geometry.base_radius_m", "to 100"),
        (VERSION + 13 * WEIGHT, 2, "counterweights", "at most 12 a leg"),
        (VERSION + "[geometry]\nmagnification = 1", 3, "geometry.magnification", "greater than 1"),
        (VERSION + '[geometry]\nknee = "left"', 3, "geometry.knee", '"lower" or "upper" is needed'),
        (VERSION + "[geometry]\nknee = 1", 3, "geometry.knee", '"lower" or "upper" is needed'),
        (VERSION + '[load]\nframe = "tool"', 3, "load.frame", '"world" or "platform" is needed'),
        (VERSION + "links = 4", 2, "links", "a table [links]"),
        (VERSION + "[[links]]\nb3_kg = 1", 2, "links", "in single brackets"),
        (VERSION + "[link]\nb3_kg = 1", 2, "link", "did you mean [links]?"),
        (VERSION + "[engine]", 2, "engine", "there are [geometry], [joints]"),
        (VERSION + "[links]\nb3_g = 1", 3, "links.b3_g", "did you mean b3_kg (m_B3"),
        (VERSION + "[links]\nB8_kg = 1", 3, "links.B8_kg", "did you mean b8_kg (m_B8"),
        (VERSION + "[joints]\nb3_kg = 1", 3, "joints.b3_kg", "did you mean b3_kg in [links]"),
        (VERSION + "b3_kg = 1", 2, "b3_kg", "did you mean b3_kg in [links]"),
        (VERSION + "[geometry]\nR_b = 1", 3, "geometry.R_b", "did you mean base_radius_m"),
        (VERSION + "[geometry]\nkne = 1", 3, "geometry.kne", "did you mean knee?"),
        (VERSION + "nam = 'x'", 2, "nam", "did you mean name?"),
        (VERSION + "[links]\nb3_xy = 1", 3, "links.b3_xy", "did you mean b3_kg (m_B3"),
        (VERSION + "namxyz = 'x'", 2, "namxyz", "did you mean name?"),  # 3 letters of 4 and 6
        (VERSION + "namwxyz = 'x'", 2, "namwxyz", "there are gravity_m_per_s2"),
        (VERSION + "[joints]\nb3_kxy = 1", 3, "joints.b3_kxy", "did you mean b3_kg in [links]"),
        (VERSION + "[joints]\nb3_wxyz = 1", 3, "joints.b3_wxyz", "there"),
        (VERSION + "zzz = 'x'", 2, "zzz", "there are gravity_m_per_s2"),
        (VERSION + 'name = "a\\u0007"', 2, "name", "a name is one line"),
        (VERSION + "value_count = 2\ngravity_m_per_s2 = 1", 2, "value_count", "cut short"),
        (VERSION + "value_count = -1", 2, "value_count", "whole number"),
        (VERSION + "value_count = 1.5", 2, "value_count", "whole number"),
        (VERSION + "[links]\nb3_kg = 1\nb3_kg = 2", 4, "", "twice"),
        (VERSION + "[links]\nb3_kg = 0,5", 3, "", "decimals are written with a point"),
        (VERSION + "[links]\nb3_kg = .5", 3, "", "digits on both sides"),
        (VERSION + "[links]\nb3_kg = 0.5 kg", 3, "", "without its unit"),
        (VERSION + "[links]\nb3_kg: 0.5", 3, "", "have = between them"),
        (VERSION + "name = my robot", 2, "", "in quotes"),
        (VERSION + "[links]\nb3_kg = \u22120.5", 3, "", "a minus sign is written -"),
        (VERSION + "name = \u201crobot\u201d", 2, "", 'quotes are written "'),
        (VERSION + "[links]\nb3_kg =\u00a00.5", 3, "", "no-break space"),
        (VERSION + "[links\nb3_kg = 1", 2, "", "is not valid TOML"),
        (VERSION + "x = 1" + 5000 * "0", 2, "", "too long"),
        (VERSION + "x = " + 900 * "[", None, "", "is nested too deeply for a design file"),
        (VERSION + "x = " + 50_000 * "[\n", None, "", "nested too deeply"),
        (b"\xff\xfe\x00", None, "", "is not a text file"),
        (b"a = 1\n\x80", 2, "", "is not a text file"),
        (b"\x7fELF\x02\x01\x01\x00", 1, "", "is not valid TOML"),
        ("x" * (LARGEST_FILE + 1), None, "", "too large"),
    ],
)
def test_a_refusal_names_line_key_and_what_is_allowed(content, line, key, words) -> None:
    error = refusal(content)
    assert (error.line, error.key) == (line, key)
    assert words in str(error)
    assert line is None or f"line {line}" in str(error)


@pytest.mark.parametrize(
    ("old", "new", "line", "key", "words"),
    [
        ('"B8"', '"B5"', 8, "counterweights.bar", "one of the bars B3, B4, B7, B8"),
        ('"B8"', "8", 8, "counterweights.bar", "one of the bars"),
        ("= 8", "= 5", 9, "counterweights.joint", "the ends of B8 are joints 8 and 9"),
        ("= 8", "= true", 9, "counterweights.joint", "number"),
        ("0.1", "nan", 10, "counterweights.beyond_m", "finite"),
        ("0.1", '"0.1"', 10, "counterweights.beyond_m", "without quotes"),
        ("= 1\n", "= -1\n", 11, "counterweights.mass_kg", "at least 0"),
        ("mass_kg", "mass", 11, "counterweights.mass", "no such key"),
        ("mass_kg = 1", "", 7, "counterweights", "mass_kg is missing"),
        ("[[counterweights]]", "[counterweights]", 7, "", "twice"),
    ],
)
def test_a_refused_counterweight_is_named_with_its_line(old, new, line, key, words) -> None:
    error = refusal(VERSION + WEIGHT + WEIGHT.replace(old, new))
    assert (error.line, error.key) == (line, key)
    if words == "no such key":  # with its value, which is one of few
        assert error.value == 1
        assert refusal(VERSION + "[links]\nb3_g = 1").value is None
    assert words in str(error)


@pytest.mark.parametrize(
    ("table", "key", "words"),
    [
        ("drives.M1]\nrotor_inertia_kg_m2 = -1.0", "drives.M1.rotor_inertia_kg_m2", "at least 0"),
        ("drives.M1]\nefficiency = 1.2", "drives.M1.efficiency", "at most 1"),
        ("drives.M1]\ngear_rato = 3.0", "drives.M1.gear_rato", "did you mean gear_ratio"),
        ("drives.M5]\ngear_ratio = 3.0", "drives.M5", "[drives.M1]"),
        ("drives.M2]\nenvelope = [[0, 1], [0, 2]]", "drives.M2.envelope", "increase"),
        ("drives.M2]\nenvelope = [[0, 1, 2]]", "drives.M2.envelope.0", "pairs"),
        ("drives.M2]\nenvelope = 3", "drives.M2.envelope", "pairs"),
        ("drives.M2]\nenvelope = [1]", "drives.M2.envelope.0", "pairs"),
        ("drives.M2]\nenvelope = [[0, [1]]]", "drives.M2.envelope.0.1", "pairs"),
        ("drives.M2]\nname = 3", "drives.M2.name", "a text"),
        ("drives]\nM2 = 3", "drives.M2", "a table"),
        ("drives.M4]\ngear_ratio = 3.0", "drives.M4.lead_m", "screw or belt"),
        ('drives.M1]\nbrake = "yes"', "drives.M1.brake", "true or false"),
        ('drives.M1]\ntransmission = "rope"', "drives.M1.transmission", "screw"),
    ],
)
def test_impossible_drives_are_refused_with_their_key(table: str, key: str, words: str) -> None:
    error = refusal(f"{VERSION}[{table}\n")
    assert error.key == key
    assert words in error.problem
    assert error.line is not None


def test_the_knee_stands_in_a_file_only_where_it_is_not_the_printed_one() -> None:
    upper = APPENDIX_4.with_knee(KneeBranch.UPPER)
    assert "\nknee" not in write_design(APPENDIX_4)
    assert '\nknee = "upper"' in write_design(upper)
    for word in ("upper", "mirror"):  # the second one in files of before
        read = read_design(f'{VERSION}[geometry]\nknee = "{word}"', "d")
        assert read.geometry == upper.geometry
    assert read_design(f'{VERSION}[geometry]\nknee = "printed"', "d") == APPENDIX_4


def test_a_name_has_two_hundred_characters_at_most() -> None:
    named = replace(APPENDIX_4, name="n" * 200)
    assert read_design(write_design(named), "a.toml").name == named.name
    with pytest.raises(DesignFileError, match="of at most 200 characters"):
        write_design(replace(named, name="n" * 201))
    problem = refusal(VERSION + "gravity_m_per_s2 = 1" + 30 * "0").problem
    assert problem == "a finite number of fewer digits is needed"


def test_of_a_document_every_number_is_a_float_and_a_wrong_one_has_its_path() -> None:
    document = {"schema_version": 1, "value_count": 0, "links": {"b3_kg": 1}}
    entry = {"quantity": "condition", "max": 10}
    content = checked_content(document | {"requirements": [entry]})
    numbers = content["links"]["b3_kg"], content["requirements"][0]["max"]
    assert (numbers, [type(number) for number in numbers]) == ((1.0, 10.0), [float, float])
    with pytest.raises(WrongDocument) as caught:
        checked_content(document | {"requirements": [entry, entry | {"max": "ten"}]})
    assert (caught.value.path, caught.value.value) == ("requirements.1.max", "ten")


def test_counterweights_are_tables_in_double_brackets() -> None:
    weights = read_design(VERSION + WEIGHT + WEIGHT.replace('"B8"', "'b7'"), "a").counterweights
    assert weights == (Counterweight("b8", 8, 0.1, 1.0), Counterweight("b7", 8, 0.1, 1.0))
    single = WEIGHT.replace("[[counterweights]]", "[counterweights]")
    assert "double brackets" in str(refusal(VERSION + single))


def test_lengths_that_contradict_each_other_are_named_where_the_file_sets_them() -> None:
    error = refusal(VERSION + "[geometry]\ncrank_length_m = 0.01\ncoupler_length_m = 0.02")
    assert (error.line, error.key) == (4, "geometry.coupler_length_m")


NAMES = ("x - at `$.y", "x` - at `$.y", "x` - at `$.geometry", "`", "a.b", "a b", "0", "é")


@pytest.mark.parametrize("table", ["", "[geometry]\n", "[drives.M1]\n", WEIGHT])
@pytest.mark.parametrize("name", NAMES)
def test_a_key_is_named_whatever_it_is_called(table: str, name: str) -> None:
    """Names that look like the end of the checking library's own messages are no exception."""
    error = refusal(f"{VERSION}{table}'{name}' = 3\n")
    assert error.key.endswith(name)
    assert "there is no such key" in error.problem


def test_messages_show_hostile_text_printable_and_short() -> None:
    key = '"\\u001b[31m\\n' + "k" * 300 + '"'
    assert "\x1b" not in str(refusal(f"{VERSION}[links]\n{key} = 1"))
    refusal(f"{VERSION}[links]\nb3_kg = '{'v' * 800}'")
    refusal("", "a\nb\x1b.toml".replace("\n", "?").replace("\x1b", "?"))
    with pytest.raises(DesignFileError) as caught:
        read_design("", "a\nb.toml")
    assert str(caught.value).startswith("a?b.toml: ")


@given(st.binary(max_size=300))
def test_any_bytes_are_refused_in_one_line(content: bytes) -> None:
    refusal(content)


@given(st.text(max_size=200))
def test_any_text_after_a_valid_version_is_read_or_refused(text: str) -> None:
    result = attempt(VERSION + text)
    assert isinstance(result, DesignFileError) or result == APPENDIX_4 or "=" in text


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=2),
    max_leaves=4,
)


@given(
    st.integers(0, COMPLETE.count("\n")),
    st.sampled_from(["double", "cut", "junk"]),
    st.text(max_size=8),
)
def test_a_damaged_file_never_gives_another_robot(number: int, how: str, junk: str) -> None:
    lines = COMPLETE.split("\n")
    if how == "double":
        lines.insert(number, lines[number])
    elif how == "cut":
        del lines[number:]
    else:
        lines.insert(number, junk)
    result = attempt("\n".join(lines))
    assert isinstance(result, DesignFileError) or result == APPENDIX_4


@pytest.mark.parametrize("design", [APPENDIX_4, UPPER], ids=["lower", "upper"])
def test_a_file_that_lost_a_line_never_gives_another_robot(design: Design) -> None:
    lines = write_design(design).split("\n")
    for number in range(len(lines)):
        result = attempt("\n".join(lines[:number] + lines[number + 1 :]))
        assert isinstance(result, DesignFileError) or result == design, lines[number]


@given(st.sampled_from(["links.b3_kg", "geometry.base_radius_m", "name", "links"]), VALUES)
def test_values_of_any_type(key: str, value: object) -> None:
    text = f"{VERSION}{key} = {_toml(value)}"
    try:
        tomllib.loads(text)
    except ValueError:
        return
    result = attempt(text)
    if isinstance(result, DesignFileError):
        assert result.line == 2
    else:
        assert isinstance(value, str if key == "name" else (int, float))


def _toml(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if value is None or isinstance(value, bool):
        return "true" if value else "false"
    return repr(value)


def test_a_huge_file_is_read_only_up_to_the_limit(tmp_path) -> None:
    path = tmp_path / "huge.toml"
    with open(path, "wb") as file:
        file.truncate(1 << 40)  # a sparse terabyte
    with pytest.raises(DesignFileError, match="too large"):
        load_design(path)


def test_lines_are_found_through_headings_quotes_and_dots() -> None:
    text = 'a = 1\n[t]\n"b" = 2\n[ u . v ]\nc.d = 3\n'
    assert find_line(text, "a") == 1
    assert find_line(text, "t") == 2
    assert find_line(text, "t.b") == 3
    assert find_line(text, "u.v.c.d") == 5
    assert find_line(text, "u.v.c") == 5
    assert find_line(text, "b") is None
    assert find_line('c = 2\n"a=b" = 1\n\'d"=\' = 3', "a=b") == 2
    assert find_line('c = 2\n"a=b" = 1\n\'d"=\' = 3', 'd"=') == 3
