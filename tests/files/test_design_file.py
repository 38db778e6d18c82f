"""Design files give back the design that was written, and every value has its place in them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz import old_names
from paminsa_viz.errors import FileError, InvalidInput
from paminsa_viz.files.design_file import load_design, read_design, save_design
from paminsa_viz.files.design_schema import KEY_OF, KEYS, unit_suffix
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.plain_data import UnusableData, parse_plain_toml
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, PARAMETERS, Design, KneeBranch
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight
from tests.support.documentation import missing
from tests.support.samples import possible_designs, possible_values

VERSION = "schema_version = 1\n"
NAMES = st.text(max_size=60).filter(str.isprintable)
PLACES = [(bar, joint) for bar, joints in BAR_ENDS.items() for joint in joints]
WEIGHTS = st.lists(
    st.builds(
        lambda place, beyond, mass: Counterweight(*place, beyond, mass),
        st.sampled_from(PLACES), st.floats(-10, 10), possible_values(PARAMETER["links.b3"]),
    ),
    max_size=3,
)  # fmt: skip


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """Any possible design: a few of its numbers are drawn from all that are allowed."""
    design = draw(possible_designs()).with_knee(draw(st.sampled_from(KneeBranch)))
    design = replace(design, load=replace(design.load, frame=draw(st.sampled_from(LoadFrame))))
    return replace(design, name=draw(NAMES), counterweights=tuple(draw(WEIGHTS)))


@given(designs(), st.text(max_size=200))
def test_a_written_design_reads_back_exactly_under_any_comment(design: Design, comment) -> None:
    again = read_design(write_design(design, comment=comment), "a.toml")
    assert again == design
    assert again.name == design.name


@pytest.mark.slow
@given(designs(), st.sampled_from(["\n", "\r\n", "\r"]))
def test_bytes_read_like_text(design: Design, end: str) -> None:
    text = write_design(design)
    data = text.replace("\n", end).encode()
    data = b"\xef\xbb\xbf" + data if end == "\r\n" else data  # as of Windows programs
    assert read_design(data, "a.toml") == design
    assert read_design(text.encode("utf-16"), "a.toml") == design


def test_every_number_can_be_set_alone() -> None:
    for key in KEYS:
        value = min(key.parameter.default * 1.0625 + 0.001, key.parameter.largest)
        heading = f"[{key.table}]\n" if key.table else ""
        design = read_design(f"{VERSION}{heading}{key.name} = {value!r}", "robot.toml")
        assert design == APPENDIX_4.vary({key.parameter.path: value}), key.path
        assert design.name == "robot"


def test_the_name_of_a_key_leads_to_the_value_in_python() -> None:
    for key in KEYS:
        if key.name != key.parameter.path:  # as gravity has no group
            with pytest.raises(InvalidInput, match=rf"did you mean .*{key.parameter.path}\b.*\?$"):
                APPENDIX_4.value(key.name)


def test_every_number_is_written_with_its_symbol() -> None:
    lines = write_design(APPENDIX_4).splitlines()
    for parameter in PARAMETERS:
        key = KEY_OF[parameter.path]
        found = [line for line in lines if line.removeprefix("# ").startswith(f"{key.name} = ")]
        assert found, key.path
        label = parameter.label.replace("’", "'")
        assert any(parameter.symbol in line and label in line for line in found)


def test_changed_values_carry_the_default_as_comment() -> None:
    text = write_design(APPENDIX_4.vary({"links.b3": 0.5}))
    line = next(line for line in text.splitlines() if line.startswith("b3_kg"))
    assert line.endswith("(Appendix 4: 0.406)")


def test_a_guide_stroke_that_follows_its_link_stays_so() -> None:
    text = write_design(APPENDIX_4).replace(
        "guide_link_length_m = 0.3635", "guide_link_length_m = 0.5"
    )
    assert read_design(text, "a.toml").geometry.stroke == 0.5
    fixed = APPENDIX_4.vary({"geometry.guide_stroke": 0.3635})
    assert read_design(write_design(fixed), "a.toml").geometry.guide_stroke == 0.3635


@pytest.mark.parametrize(
    ("unit", "suffix"),
    [
        ("", ""),
        ("m", "_m"),
        ("kg m^2", "_kg_m2"),
        ("m/s^2", "_m_per_s2"),
        ("N m s/rad", "_Nm_s_per_rad"),
        ("rad/s, m/s", "_rad_per_s_or_m_per_s"),
    ],
)
def test_units_end_the_keys(unit: str, suffix: str) -> None:
    assert unit_suffix(unit) == suffix


DRIVES = (
    None,
    Drive('a "quoted" motor', 1e-6, gear_ratio=50.0, efficiency=0.8, rated_torque=0.1),
    Drive(),
    Drive(
        "axis", transmission="screw", lead=0.01, brake=True,
        envelope=((0.0, 1.5), (300.0, 1.5), (600.0, 0.1)),
    ),
)  # fmt: skip


def test_drives_are_read_back_exactly() -> None:
    design = replace(APPENDIX_4, drives=DRIVES)
    text = write_design(design)
    assert read_design(text, "a.toml") == design
    assert read_design(text, "a.toml").drives[1].name == DRIVES[1].name
    assert "drives" not in write_design(APPENDIX_4)


def test_the_loads_frame_stands_in_a_file_only_where_it_is_not_the_world() -> None:
    turning = replace(APPENDIX_4, load=LoadCase(force_x=-3.0, frame=LoadFrame.PLATFORM))
    assert "\nframe" not in write_design(APPENDIX_4)
    assert '\nframe = "platform"' in write_design(turning)
    text = f'{VERSION}[load]\nforce_x_N = -3.0\nframe = "platform"'
    assert read_design(text, "d") == turning


def test_no_two_numbers_share_a_key() -> None:
    assert len({key.path for key in KEYS}) == len(KEYS) == len(PARAMETER)


@pytest.mark.parametrize(
    "weights", [(), (Counterweight("b8", 8, 0.1, 1.0), Counterweight("b3", 7, 0.05, 2.0))]
)
def test_a_file_that_was_cut_short_is_refused_wherever_it_was_cut(weights) -> None:
    design = replace(APPENDIX_4, counterweights=weights)
    lines = write_design(design).splitlines(keepends=True)
    last = max(number for number, line in enumerate(lines) if line[:1].isalpha())
    for count in range(last):
        with pytest.raises(DesignFileError):
            read_design("".join(lines[:count]), "a.toml")


def test_values_may_be_left_out_of_a_file_that_does_not_count_them() -> None:
    design = read_design(VERSION + 'name = "light"\n[links]\nb3_kg = 0.1', "a.toml")
    assert design == APPENDIX_4.vary({"links.b3": 0.1})
    assert design.name == "light"
    assert read_design(f"{VERSION}value_count = 0", "a.toml") == APPENDIX_4
    assert read_design(VERSION, f"{'n' * 200}.toml").name == "n" * 100  # not all of a long one


def test_save_and_load(tmp_path) -> None:
    path = tmp_path / "robot.toml"
    design = APPENDIX_4.vary({"payload.mass": 1 / 3})
    assert save_design(design, path, comment="made\nin a test") == path
    assert load_design(path) == design
    assert "# made\n# in a test\n" in path.read_text()
    save_design(APPENDIX_4, path)
    assert load_design(path) == APPENDIX_4


@pytest.mark.parametrize("name", ["two\nlines", "\ud800", "a" * 201, "\u202e", 5, None])
def test_an_unprintable_or_long_name_is_refused_before_writing(tmp_path, name) -> None:
    path = tmp_path / "robot.toml"
    with pytest.raises(DesignFileError, match="a name is one line"):
        save_design(replace(APPENDIX_4, name=name), path)
    assert not list(tmp_path.iterdir())


def test_a_heading_says_of_its_table_what_the_documentation_does() -> None:
    design = APPENDIX_4.vary({"elastic.b4_outer": 0.05, "tolerances.bar": 1e-5})
    headings = [line.split("  # ") for line in write_design(design).splitlines() if line[:1] == "["]
    assert {"[geometry]", "[elastic]", "[tolerances]"} <= {table for table, _ in headings}
    stated = [f"## {table} {comment}".replace("``", "`") for table, comment in headings]
    assert missing("design-file", stated) == []


def test_inaccessible_files_are_one_line_errors(tmp_path) -> None:
    with pytest.raises(DesignFileError, match=r"none\.toml: cannot be read: no such file"):
        load_design(tmp_path / "none.toml")
    with pytest.raises(DesignFileError, match="cannot be read: is a directory"):
        load_design(tmp_path)
    with pytest.raises(DesignFileError, match="cannot be read"):
        load_design("nul\0byte")
    with pytest.raises(FileError, match="its folder does not exist"):
        save_design(APPENDIX_4, tmp_path / "no" / "robot.toml")


@pytest.mark.parametrize(("old", "knee"), list(old_names.KNEES.items()))
def test_old_words_of_the_knee_are_read_and_those_of_nothing_else(old: str, knee: str) -> None:
    read = read_design(f'{VERSION}[geometry]\nknee = "{old}"\n', "a.toml")
    assert read.geometry.knee is KneeBranch(knee)
    with pytest.raises(DesignFileError, match=old):
        read_design(f'{VERSION}[load]\nframe = "{old}"\n', "a.toml")


def test_comments_of_a_table_stand_below_each_other() -> None:
    tables = write_design(APPENDIX_4).split("\n[")[1:]
    several = 0
    for table in tables:
        lines = [line for line in table.splitlines()[1:] if " = " in line and "  # " in line]
        places = {line.index("  # ") for line in lines if not line.startswith("#")}
        several += len(lines) > 2
        longest = max((len(line[: line.index("  # ")].rstrip()) for line in lines), default=0)
        assert places <= {longest}
    assert several > 3


def test_whole_numbers_are_read_up_to_the_largest_of_toml() -> None:
    assert parse_plain_toml(f"a = {2**63 - 1}") == {"a": 2**63 - 1}
    assert parse_plain_toml(f"a = -{2**63 - 1}") == {"a": 1 - 2**63}
    with pytest.raises(UnusableData):
        parse_plain_toml(f"a = {2**63}")
