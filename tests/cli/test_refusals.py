"""Whatever is wrong with a command line: one line that names the place, exit code 2, no file."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from paminsa_viz import app
from tests.support.commands import check_refused

pytestmark = pytest.mark.slow

WRONG_WORDS = """
start --port x                                      | --port: a whole number is needed, not 'x'
sweep --out a.csv --random a                        | --random: a whole number is needed, not 'a'
stiffness --pose                                    | --pose: 4 numbers are needed; see
report --out                                        | --out: a value is needed; see
start --port 65536                                  | --port: 65536 is not from 0 to 65535
start --prot 1                                      | --prot
start here                                          | flags paminsa-viz takes nothing; see
map --theta 1 2 --z 3                               | '2' is left over: besides flags
evaluate a.csv b.csv --out c.csv                    | evaluate takes IN.csv; see
--port -1                                           | --port: -1 is not from 0 to 65535
evaluat                                             | 'evaluat'; did you mean evaluate?
xyz                                                 | 'xyz'; there are start, evaluate, design
evaluate                                            | Missing from paminsa-viz evaluate
evaluate a.csv                                      | --out
evaluate a.csv --out b.csv --out c.csv              | --out takes one value, but is given twice
export --dxf a.dxf --glb a.glb --dxf=b.dxf          | --dxf takes one value, but is given twice
sweep --out a.csv --vary links.b3=1 --vary joints.j7=1 --max-condition 9 --max_condition 8 | --max-
evaluate a.csv --out b.csv --knee other             | invalid choice 'other'
evaluate a.csv --out b.csv --load 1 2 3             | 6 numbers are needed, not '1', '2', '3'
trajectory --preset Circle                          | 'Circle'; did you mean circle?
trajectory --preset spiral                          | there are arch, circle, line,
map --quantity max_torque                           | did you mean max-torque?
drives --cycle arch x 1                             | a name and 2 numbers are needed
drives --cycle arch 2 nan                           | --cycle arch 2 nan: a count of at least 1
drives --rows 0                                     | --rows: 1 to 1000 are possible, not 0
map --dpi 9 --out a.png                             | 20 to 2400 pixels per inch are possible, not 9
start --pages 0                                     | viz: --pages: 0 is not from 1 to 1000
synthesize cylinder --seed -1                       | seed: a whole number of at least 0
clearance --poses 9 --z -300 -900                   | --z -300 -900: the first number has to be at
clearance --poses 9 --z -3e9 0                      | --z: -100000 to 100000 mm are possible
clearance --poses 9 --z nan 0                       | --z
clearance --poses 100000000                         | --poses: 0 to 1000000 are possible
clearance --poses 9 --radius 0                      | --radius
clearance --poses 9 --theta 400                     | --theta: 0 to 180 degrees
clearance --least nan                               | --least
map --cells 20 --out a.csv --out no/b.csv           | no/b.csv: cannot be written: its folder
excite --out no/a.csv                               | no/a.csv: cannot be written: its folder
synthesize cylinder --out no/a.toml                 | no/a.toml: cannot be written: its folder
evaluate a.csv --out b.csv --desing d               | Perhaps you meant: --design FILE
map --quantitty f-4                                 | Perhaps you meant: --quantity; see
trajectory --presett arch                           | Perhaps you meant: --preset; see
design                                              | Expected one of
design chek                                         | 'paminsa-viz design chek'; did you mean check?
design robot.toml                                   | robot.toml'; there are check, show, default
design check                                        | a file is needed
design diff a b c d                                 | diff takes at most 2, FILE FILE; see
map --cells abc                                     | --cells: a whole number is needed, not 'abc'
map --theta abc                                     | --theta: a number is needed, not 'abc'
map --theta nan                                     | --theta
map --z inf                                         | --z
map --quantity beauty                               | beauty
map --cells 3                                       | --cells
map --range 3 1                                     | below the second, not (3.0, 1.0)
map --at nan 0                                      | --at: finite numbers are needed, not
map --own-ranges --quantity condition               | --own-ranges is for the three torques
accuracy --seed 3                                   | --seed needs --robots
balance --goal peak --criterion moved               | --criterion needs --goal static
calibrate --propose 20 --validate 0.3 --out x.csv   | --validate needs POSES.csv
calibrate --propose 20 --all --out x.csv            | --all needs POSES.csv
calibrate in.csv --seed 5                           | --seed needs --validate or --propose
clearance --theta 5                                 | --theta needs --poses
clearance --seed 9                                  | --seed needs --poses
clearance --radius 20                               | --radius needs --poses
clearance --z -600 -500                             | --z needs --poses
export --dxf d.dxf --motors                         | --motors needs --mjcf, --meshes or --usd
identify example --validate example                 | it has the positions of the first log
identify example --start 0 0 180 -552               | log example_log, row 6: out of reach: leg
identify example --gains 5 5 5 50                   | gains are for currents
map --log                                           | --log needs --out with .png, .svg or .pdf
map --range 1 2 --out a.csv                         | --range needs --out with .png
map --full-range                                    | --full-range needs --out with .png
map --own-ranges                                    | --own-ranges needs --out with .png
map --dpi 90                                        | --dpi needs --out with .png
map --width 5 --out a.png                           | --width: 50 to 1000 mm are possible, not 5
trajectory --width 90 --out a.html                  | --width needs --out with .png
sweep --out a.csv --vary links.b3=1 --spread 0.3    | --spread needs --random
sweep --out a.csv --vary links.b3=1 --seed 3        | --seed needs --random
sweep --out a.csv --vary links.b3 --random 0        | --random: one design at least is needed, not 0
synthesize cylinder --points 4                      | --points needs --front
synthesize cylinder --generations 0                 | --generations: 1 to 100000 is possible, not 0
synthesize cylinder --front footprint --front footprint | --front: at least two different
synthesize cylinder --built 9 --mass-tolerance 100  | and below 100 % is needed, not 100
synthesize cylinder --mass-tolerance 3              | --mass-tolerance needs --built
synthesize cylinder --front mass --front footprint --prove 3 | --front excludes --prove
verify --format svg                                 | --format needs --figures
map --own-ranges --range 0 1                        | --own-ranges is for the three torques
trajectory --bandwidth 5                            | --bandwidth needs --simulate
map --range 0 nan                                   | --range
map --range 0 1 --full-range                        | --full-range
map --out no/a.csv                                  | no/a.csv
map --out a.png --width 20                          | width
balance --change links.x 0 1                        | links.x
balance --change links.b4 2 1                       | low <= high
balance --rail b3 5 0 100 1                         | ends of B3
balance --rail b5 5 0 100 1                         | one of b3, b4, b7, b8 and 4 numbers are needed
balance --rail b3 7 200 0 5                         | --rail b3 7 200 0: the first number has to be
balance --rail b3 7 0 1e20 5                        | --rail 1e+20: at most 100000 mm
balance --rail b3 7 0 100 1e20                      | --rail 1e+20: at most 10000 kg
balance --change links.b3 0 1e308                   | --change 1e+308: at most 10000 kg
balance --goal peak --max-added nan                 | --max-added nan: at most
balance --goal peak --max-imbalance inf             | --max-imbalance inf: at most
balance --goal peak --max-imbalance -1              | --max-imbalance -1: a size is
balance --goal peak --exact --max-imbalance 2       | --exact and --max-imbalance exclude each other
balance --max-added 3                               | belong to a goal on a motion
balance --preset arch                               | belong to a goal on a motion
balance --goal peak --preset arch --file a.csv      | --preset and --file exclude each other
balance --goal heat                                 | --goal
export                                              | nothing to write; give --glb, --mjcf
export --glb r.glb --pose 0 0 0 -2000               | be taken: the pantograph is over-stretched
export --glb r.glb --pose 0 0 0 nan                 | cannot be taken: the pose is not finite
export --glb r.glb --pose 1e308 0 0 -500            | or too large to compute with
export --glb r.glb --pose 0 0 0                     | --pose
export --mjcf no/r.xml                              | cannot be written: its folder does not exist
export --meshes old/deeper                          | old/deeper: cannot be written
export --mjcf r.xml --glb r.glb --meshes old        | old: cannot be written
export --glb r.glb --pose 1e300 0 0 0               | pose x 1e+300 mm, y 0 mm,
export --glb r.glb --pose x 0 0 0                   | 4 numbers are needed, not 'x',
export --glb r.glb --mjcf r.xml --pose 0 0 73.39845 -600 | pose: it is singular
code --out old                                      | old: cannot be written: a file has this name
report                                              | --out
report --out r.html --pose 0 0 0 -3000              | be taken: the pantograph is over-stretched
report --out r.html --cross                          | --cross needs --file and --max-torque
report --out r.html --preset line --file a.csv      | --preset and --file exclude each other
report --out r.html --max-torque 3                  | --max-torque belongs to --cross
report --out r.html --cross --file a.csv --max-torque -3 | --max-torque: a finite
report --out no/r.html                              | cannot be written: its folder does not exist
accuracy --encoders                                 | no drive of the design has encoder_counts
accuracy --encoders --resolution 0.1 1              | exclude each other
accuracy --resolution -1 1                          | --resolution: 0 to 57.2 degrees and 0 to
accuracy --pose 0 0 0 -2000                         | cannot be taken
accuracy --radius -5                                | radius
accuracy --robots 5                                 | --robots is for --manufacture
accuracy --manufacture --robots -1                  | --robots: a whole number of at
accuracy --manufacture --robots 1 --seed -1         | --seed: a whole number of at
accuracy --manufacture --robots 2000000             | with 1 pose, not 2,000,000
clearance --poses -1                                | --poses
clearance --pose 900 0 0 -500                       | x 900 mm
excite --max-torque -1                              | --max-torque
excite --out motion.txt                             | .csv
excite --rate 0                                     | viz: --rate: a finite rate above 0 is
excite --rate 1e9                                   | rate: 2e+10 samples are more than 1,000,000;
identify example --start nan 0 0 0                  | --start: four finite numbers are needed, not
balance --change joints.j7_kg 0 1                   | did you mean joints.j7?
excite --period 0                                   | viz: --period: 0.5 to 1000
loads --pose 900 0 0 -500                           | leg
loads --pose 50 -20 10 -500 --preset arch           | --pose
loads --preset arch --bar b4                        | --bar
loads --bearings                                    | --bearings
loads --bearings --preset arch                      | --bearings needs --out
loads --bar b4                                      | --bar needs --out
loads --preset arch --file a.csv                    | --preset and --file exclude each other
loads --out x.png                                   | --out
stiffness --pose 3000 0 0 -500                      | cannot be taken
stiffness --sections --pose 0 0 0 -500              | --sections excludes --pose
stiffness --payload -1                              | payload.mass
stiffness --design soft.toml                        | soft.toml, line 3, [elastic] b4_inner_m
requirements check --theta 30 -30                   | --theta 30 -30: the first number has to be at
requirements check --cylinder 0 100                 | --cylinder: lengths above 0 mm are needed, not
requirements check --box 1 2 -3                     | --box: lengths above 0 mm are needed, not
sweep --out a.csv                                   | --vary is needed
sweep --out a.csv --vary links.b33=1:2:3            | did you mean links.b3?
sweep --out a.csv --vary links.b3                   | links.b3=LOW:HIGH:COUNT
sweep --out a.csv --vary links.b3=1:2               | links.b3=LOW:HIGH:COUNT
sweep --out a.csv --vary links.b3=1:2:x             | links.b3=LOW:HIGH:COUNT
sweep --out a.csv --vary links.b3=1:2:0             | count
sweep --out a.csv --vary links.b3=1:2:99999999999   | count
sweep --out a.csv --vary links.b3=1,nan             | links.b3
sweep --out a.csv --vary links.b3=1e9               | at most 10000
sweep --out a.csv --vary links.b3=1 --vary links.b3=2 | varies twice
sweep --out a.csv --vary links.b3=1:2:3 --random 5  | links.b3=LOW:HIGH
sweep --out a.csv --vary payload.mass --random 5    | payload.mass
sweep --out a.csv --vary links.b3 --random 5 --seed -1 | seed
sweep --out a.csv --vary links.b3 --random 5 --spread 2 | --spread
sweep --out a.csv --vary links.b3 --random 2000000000 | too many
sweep --out a.csv --vary links.b3=1 --radius -5     | --radius: a length above 0 mm is needed, not -
sweep --out a.csv --vary links.b3=1 --max-condition nan | viz: --max-condition: a
sweep --out a.csv --vary links.b3=1 --workers 0     | viz: --workers: one
sweep --out a.csv --vary links.b3=1 --index a       | viz: --index: there is no quantity 'a'
sweep --out a.csv --vary links.b3=1 --workers 1 --dask a | exclude
sweep --out a.csv --vary links.b3=1 --preset arch --file a.csv | exclude
synthesize none.toml                                | none.toml
trajectory --preset line --file a.csv               | --file
trajectory --waypoints                              | --waypoints
trajectory --shortest                               | --max-speed
trajectory --cross --max-torque 3                   | --waypoints
trajectory --file poses.csv --waypoints --cross     | --max-torque
trajectory --file wp.csv --waypoints --cross --max-torque 50 --max-acceleration 3 | --cross takes
trajectory --max-torque 3                           | --max-torque
trajectory --shortest --stretch --max-speed 1       | --stretch excludes --shortest
trajectory --stretch                                | --max-speed
trajectory --published none.csv                     | none.csv
trajectory --published a.csv --figure pose --out a.png | --published
trajectory --shortest --max-speed -1                | speed
trajectory --shortest --max-speed 1 --duration 2    | --duration
trajectory --shortest --max-torque 1e308            | --max-torque: at most 1e+09
trajectory --shortest --max-turn-speed -1           | --max-turn-speed: a finite limit above 0 is
trajectory --stretch --max-jerk nan                 | --max-jerk: a finite limit above 0 is
trajectory --duration 0                             | duration
trajectory --rate nan                               | rate
trajectory --rate 1e9                               | rate
trajectory --payload-mismatch 1                     | --simulate
trajectory --simulate pd --payload-mismatch -0.5    | --payload-mismatch -0.5 makes
trajectory --simulate pd --payload-mismatch 1e308   | --payload-mismatch 1e+308 makes
trajectory --simulate pd --bandwidth -1             | --bandwidth: 0 to 1000 Hz are possible, not -1
trajectory --simulate pd --bandwidth 1e20           | --bandwidth: 0 to 1000 Hz
trajectory --figure tracking --out a.png            | --simulate
trajectory --figure comparison --out a.png          | --engine
trajectory --figure power                           | --out
trajectory --engine pinocchio --figure power --out a.png | --engine
trajectory --out no/folder/a.csv                    | no/folder/a.csv
trajectory --out a.png --width 10                   | width
trajectory --file huge.csv                          | huge.csv: pose:
verify --tolerance 0                                | tolerance: a number above 0 and at most 0.1 is
verify --tolerance 0.2                              | tolerance
verify --poses 0                                    | poses: at least 1 is needed
verify --seed -1                                    | seed: a whole number
verify --model no.xml                               | no.xml: cannot be read: no such file
verify --model huge.csv                             | huge.csv: is no valid XML
verify --model other.xml                            | its joints are not those of this robot
verify --model broken.xml                           | broken.xml: MuJoCo cannot use it
verify --preset line --file a.csv                   | --preset and --file exclude each other
verify --preset line --poses 1 --figures old        | old: cannot be
verify --file far.csv                               | the trajectory cannot be run: at 0 s
"""
"""Words, and what the line has to contain."""

READERS = {
    "evaluate in.csv --out out.csv": "design",
    "map": "design reference",
    "trajectory": "design reference preset file",
    "balance --goal peak": "design preset file",
    "sweep --vary links.b3=1:2:2 --out out.csv": "design preset file",
    "verify": "design preset file",
    "drives": "design preset file",
    "report --out out.html": "design preset file",
    "page --out out.html": "design",
    "export --glb out.glb": "design",
}
"""Commands with their flags that name something to read."""

BAD = {
    "design": ("none.toml", "none.toml: cannot be read"),
    "reference": ("big.toml", "big.toml, line 3, [links] b3_kg = 1e+308"),
    "preset": ("spiral", "invalid choice 'spiral'"),
    "file": ("none.csv", "none.csv: cannot be read: no such file"),
}

NAMES = (
    "map --quantity @", "map --preset @", "map --palette @", "map --design @", "map --knee @",
    "sweep --out a.csv --vary @=1", "sweep --out a.csv --vary links.b3=@", "balance --change @ 0 1",
    "balance --goal @", "balance --rail @ 7 0 100 5", "requirements --require @",
    "requirements --require @<=3", "trajectory --preset @", "trajectory --law @",
    "trajectory --simulate @", "trajectory --figure @ --out a.png", "drives --cycle @ 1 1",
    "drives --catalog @", "loads --bar @ --out a.csv", "identify @", "synthesize @",
    "code --language @ --out a", "page --code @ --out a.html", "design diff @ @", "start --@",
)  # fmt: skip
"""Commands with a place ``@`` for a name that there is not."""

WRITERS = [
    "map --out", "trajectory --out", "report --out", "page --out", "export --glb", "export --mjcf",
    "balance --out", "design default --out", "evaluate in.csv --out",
    "sweep --vary links.b3=1:2:2 --out", "drives --out",
]  # fmt: skip


@pytest.fixture(autouse=True)
def files(folder) -> None:
    """Some files that commands read, and an application that must not be started."""
    rows = "0,1e308,0,0,-0.5\n1,1e308,1e308,0,-0.5\n2,-1e308,0,0,1e308\n"
    Path("huge.csv").write_text("t_s,x_m,y_m,theta_rad,z_m\n" + rows)
    Path("far.csv").write_text("t_s,x_m,y_m,theta_rad,z_m\n0,0,0,0,-3\n1,0,0,0,-3\n")
    Path("in.csv").write_text("x_m,y_m,theta_rad,z_m\n0,0,0,-0.5\n")
    Path("other.xml").write_text("<mujoco><worldbody/></mujoco>")
    Path("broken.xml").write_text("<mujoco><worldbody><geom/></worldbody></mujoco>")
    Path("big.toml").write_text("schema_version = 1\n[links]\nb3_kg = 1e308\n")
    Path("k.toml").write_text("schema_version = 1\n[geometry]\nmagnification = 1.0\n")
    Path("soft.toml").write_text("schema_version = 1\n[elastic]\nb4_inner_m = 0.04\n")
    Path("old").write_text("a file")


@pytest.mark.parametrize("row", WRONG_WORDS.strip().splitlines())
def test_wrong_words_are_refused(row, capsys, monkeypatch, request) -> None:
    words, place = (part.strip() for part in row.split(" | "))
    if words.startswith("verify"):
        request.getfixturevalue("mujoco")
    monkeypatch.setattr(app, "run", lambda _: pytest.fail("started"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        check_refused(*split(words, capsys), place=place)
    assert not caught


@pytest.mark.parametrize("name", ["zzz", "no\x1b[31m", "long" * 2000])
@pytest.mark.parametrize("command", NAMES)
def test_no_name_that_is_unknown_fills_more_than_a_screen(command, name, capsys) -> None:
    words = command.split()
    check_refused(words[0], capsys, *(word.replace("@", name) for word in words[1:]), place="")


@pytest.mark.parametrize(
    ("command", "flag"), [(c, flag) for c, flags in READERS.items() for flag in flags.split()]
)
def test_what_cannot_be_read_is_refused(command, flag, capsys) -> None:
    value, place = BAD[flag]
    check_refused(*split(f"{command} --{flag} {value}", capsys), place=place)
    if flag == "design":
        for name, place in (("big", "line 3, [links] b3_kg"), ("k", "[geometry] magnification")):
            check_refused(*split(f"{command} --design {name}.toml", capsys), place=place)


@pytest.mark.parametrize("command", WRITERS)
def test_an_ending_that_says_something_else_is_refused(command, capsys) -> None:
    for name in ("x.txt", "x.xlsx", "x", "x.", ".csv", "x.csv.gz", "x.pdf.exe", "x.toml.html.zip"):
        words = f"{command} {name}"
        check_refused(*split(words, capsys), place=f"{name}: its ending has to be")


def split(words: str, capsys) -> tuple[str, object, str]:
    command, *others = words.split()
    return command, capsys, *others
