"""The options for the fields of a case: their table says what the solver says, and every command offers all of them."""

import json
import re
import warnings
from dataclasses import fields
from math import cos, pi
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from solver import Cylinder, Ends, InputError, Rod, Start, observe, solve
from solver.problem.case import SIDES, SLIDING, STIFFNESS
from solver.problem.declared_fields import FIELDS, PAIRS, PARTS
from studies import loads
from studies.language.case_input import in_units, read_case, with_unit
from tests.workbench import small
from tests.workbench.command import exit_status, run
from workbench import cli
from workbench.commands.case_options import ENDS_FIELDS, HELD, help_of
from workbench.run import in_memory
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

PARTS_OF = {"rod": {Rod}, "cylinder": {Cylinder}, "start": {Start}, "ends": {Ends}, "start or ends": {Start, Ends}}


def declared() -> dict[str, set[type]]:
    """Every field of a case, and the parts that have it."""
    found: dict[str, set[type]] = {}
    for part in (Rod, Cylinder, Start, Ends):
        for field in fields(part):
            found.setdefault(field.name, set()).add(part)
    return found


def test_the_table_has_every_field_of_a_case_and_no_other() -> None:
    assert {name: PARTS_OF[field.part] for name, field in FIELDS.items()} == declared()


@pytest.mark.parametrize("name", FIELDS)
def test_a_field_that_is_declared_in_two_parts_is_one_quantity(name: str) -> None:
    rows = [PARTS[part.__name__.lower()][name] for part in declared()[name]]
    assert len({(row.symbol, row.dimension, row.long_name, row.range, row.quantity) for row in rows}) == 1


@pytest.mark.parametrize("name", [name for name, field in FIELDS.items() if field.default is not None])
def test_an_omitted_field_has_its_declared_default(name: str) -> None:
    """A default that is not that of the class is a rule: of a partner, or of what the field needs."""
    field = FIELDS[name]
    assert field.omitted == field.default or field.needs or name in {load for load, _ in PAIRS}


def test_words_have_the_choices_of_the_solver() -> None:
    assert FIELDS["stiffness"].choices == tuple(STIFFNESS)
    assert FIELDS["side"].choices == tuple(SIDES)
    assert FIELDS["sliding"].choices == tuple(SLIDING)


@pytest.mark.parametrize(
    "command, names",
    [("solve", FIELDS), ("explore", FIELDS), ("equilibria", (*ENDS_FIELDS, *HELD)), ("folds", (*ENDS_FIELDS, *HELD))],
)
def test_a_command_offers_each_field_with_its_help(command: str, names) -> None:
    options = {param.opts[0]: param for param in get_command(cli.app).commands[command].params}  # type: ignore[attr-defined]
    for name in names:
        assert options[f"--{name}"].help == help_of(FIELDS[name], len(names) == len(FIELDS))
    assert {f"--{name}" for name in FIELDS} & set(options) == {f"--{name}" for name in names}
    assert {"--length-unit", "--force-unit"} <= set(options)


PIPE = "--EI 1.228e6 --GJ 9.45e5 --a 0.0635 --L 60 --R 0.10795 --beta0 0 --betaL 0 --length-unit m".split()  # noqa: SIM905


LYING = ["--FZ", "-2e5", "--side", "inside", "--weight", "242", "--inclination", "90deg"]
STEEL = [*PIPE[4:], *"--E 2.06e11 --nu 0.3 --inner_radius 0.0543 --azimuth 0".split()]  # noqa: SIM905


def test_of_a_pipe_with_a_section_the_stress_is_stated_and_whether_steel_yields(capsys) -> None:
    """The axial stress is the load over the section; a strain of 0.25 % is 517 MPa, where grade E-75 yields."""
    for load, yields in ((-2e5, False), (-1.5e6, True)):
        exit_status("solve", *STEEL, *LYING, "--FZ", load)
        shown = capsys.readouterr().out
        axial, bending, both = (
            re.search(rf"^{name} +MPa +(.*)", shown, re.MULTILINE)[1].split()
            for name in ("axial stress", "bending stress", "both stresses together")
        )
        assert (axial[3] == "everywhere") is not yields  # as a helix it sways more
        axial, bending, both = ([float(number) for number in row[:3]] for row in (axial, bending, both))
        assert axial[0] == pytest.approx(load / (pi * (0.0635**2 - 0.0543**2)) * 1e-6, rel=1e-3)
        assert both[2] == pytest.approx(bending[2] - axial[2], rel=0.01)  # here the largest are at one place
        assert ("caution: The rod is strained by 0.39 %" in shown) is yields


PIPE = {
    "E": "206 GPa", "nu": 0.3, "a": "2.5in", "inner_radius": "2.138in", "L": "300 m", "R": "4.25in", "side": "inside",
    "weight": "241 N/m", "beta0": 0.0, "betaL": 0.0,
}  # fmt: skip
UNITS = {"length": "m", "force": "kN"}


def force_of(values: dict[str, object]) -> float:
    """The force at s = L of the pipe with other fields."""
    return float(read_case(None, {**PIPE, **values}, UNITS).case.given.FZ)


def test_a_hole_and_the_force_at_either_end_are_the_inclination_and_the_force_at_the_far_end() -> None:
    down = read_case(None, {**PIPE, "hole": pi / 3, "wob": "200 kN"}, UNITS)
    plain = read_case(None, {**PIPE, "inclination": pi - pi / 3, "FZ": -200.0}, UNITS)
    assert repr(down.case) == repr(plain.case)
    along = 0.241 * 300 * cos(pi / 3)
    assert force_of({"hole": pi / 3, "FZ0": -200 + along}) == pytest.approx(-200, rel=1e-12)
    for hole in (0.0, pi / 2, 1.7, pi):  # the bit is at s = L also where s climbs
        assert force_of({"hole": hole, "wob": 200.0}) == force_of({"inclination": pi - hole, "wob": 200.0}) == -200
    with pytest.raises(InputError, match="wob is the push at the bit, s = L, in a hole: give hole"):
        force_of({"wob": 200.0})


def test_with_friction_the_force_at_the_start_is_that_of_the_answer() -> None:
    rubbed = {**PIPE, "hole": pi / 3, "friction": 0.25, "sliding": "axial-forward"}
    case = read_case(None, {**rubbed, "FZ0": -150.0}, UNITS).case
    assert observe(solve(case), ["FZ0"])["FZ0"] == pytest.approx(-150, rel=1e-6)
    assert -150 - 0.241 * 300 * cos(pi / 3) + 25 > case.given.FZ  # friction takes a part of the weight


@pytest.mark.parametrize(
    "given",
    [{"hole": 1.0, "inclination": 1.0}, {"wob": 1.0, "FZ": 1.0}, {"FZ0": 1.0, "wob": 1.0}, {"FZ0": 1.0, "height": 1.0}],
)
def test_each_end_gives_one_of_each_pair(given: dict[str, float]) -> None:
    with pytest.raises(InputError, match="exclude each other"):
        read_case(None, {**PIPE, **given}, UNITS)


def test_the_units_in_which_every_number_is_typed_are_those_of_the_answer() -> None:
    typed = {**PIPE, "L": "1000 ft", "weight": "19.5 lb/ft", "FZ": "-40 klbf", "inclination": 1.0}
    assert read_case(None, typed, {}).units == {"length": "ft", "force": "klbf"}
    assert read_case(None, {**typed, "L": 1000.0}, {}).units == {"length": "cm", "force": "N"}
    case, other = read_case(None, typed, {}).case, read_case(None, typed, {"length": "in", "force": "lbf"}).case
    assert case.rod.L == 1000
    assert pytest.approx(12000) == other.rod.L
    assert pytest.approx(case.rod.E) == other.rod.E * 12**2 / 1000


@pytest.mark.parametrize(
    ("typed", "noticed"),
    [({"weight": 19.5}, "weight"), ({"a": 2.5}, "a"), ({"inner_radius": 2.1}, "inner_radius"), ({"E": 30e6}, "E"),
     ({"weight": 0.0195, "a": 0.208, "E": 4.32e6}, ""), ({"weight": "19.5 klbf/ft", "a": "2.5 ft"}, "")],
)  # fmt: skip
def test_a_plain_number_beside_feet_that_is_usual_in_smaller_units_alone_has_a_notice(
    typed: dict[str, object], noticed: str
) -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        in_units(typed, {"length": "ft", "force": "klbf"})
    assert [str(each.message).split(" = ")[0] for each in found] == [noticed] * bool(noticed)


def test_a_branch_that_ends_before_the_loads_says_at_which_load_in_units() -> None:
    case = read_case(None, {**PIPE, "hole": pi / 2, "wob": 2e5}, UNITS).case
    said = with_unit("failed: the branch ends at 0.00393 of the way to these loads; that from", case, UNITS)
    assert "of the way to these loads (FZ = -786 kN; give a smaller load); that from" in said


def test_the_title_of_a_rod_in_feet_has_its_radii_in_inches() -> None:
    title = read_case(None, {**PIPE, "hole": pi / 2, "L": "1000 ft"}, {"length": "ft", "force": "klbf"}).title
    assert title == "A rod 1000 ft long, of diameter 5 in, inside a cylinder of diameter 8.5 in"


STUDY_OF_A_PIPE = """
title = "A pipe in holes"
observables = ["FZ0", "push_mean"]
units = {{ length = "m", force = "kN" }}
axes.hole.values = ["30deg", "90deg", "120deg"]
axes.{name}.values = {values}
[base]
E = 2.06e8
nu = 0.3
a = 0.0635
L = 50.0
weight = 0.241
R = 0.10795
side = "inside"
beta0 = 0.0
betaL = 0.0
"""
STUDY_OF_A_CABLE = """
title = "A wire on a drum"
units = { length = "mm", force = "N" }
base = { E = 2e5, nu = 0.3, a = 1.0, L = 300.0, R = 60.0, twist = 0.0 }
axes.tension.values = [500.0, "0.8 kN"]
axes.lay.values = ["60deg", "80deg"]
"""


def test_a_study_takes_the_words_of_drillers_in_fields_and_axes() -> None:
    """The far end's force is the weight on bit, at s = 0 less the weight along the hole, also where that climbs."""
    cosine = np.cos(np.deg2rad([[30], [90], [120]]))
    along = 0.241 * 50 * cosine
    by_bit = loads(STUDY_OF_A_PIPE.format(name="wob", values='[20.0, "40 kN"]'))
    ds = in_memory.run(by_bit).squeeze()
    assert np.asarray(ds["FZ"]) == pytest.approx(np.array([[-20.0, -40.0]] * 3))
    assert np.asarray(ds["FZ0"]) == pytest.approx(along - [[20.0, 40.0]], rel=1e-9)
    assert np.asarray(ds["inclination"]).reshape(-1) == pytest.approx(np.deg2rad([150, 90, 60]))
    by_start = loads(STUDY_OF_A_PIPE.format(name="FZ0", values="[-20.0, 10.0]")).case()
    assert np.asarray(by_start.given.FZ) == pytest.approx([-20.0, 10.0] - along)


def test_a_hole_of_a_rod_without_weight_is_refused() -> None:
    with pytest.raises(InputError, match="hole matters only for a rod with weight"):
        loads(STUDY_OF_A_PIPE.format(name="wob", values="[20.0]").replace("weight = 0.241\n", ""))


@pytest.mark.parametrize(("sliding", "sign"), [("axial-forward", 1), ("axial-backward", -1)])
def test_the_force_at_s_0_of_a_study_with_friction_gives_that_at_s_L(sliding: str, sign: int) -> None:
    """Of a straight pipe by hand: friction adds f w L sin(hole) as it slides off, and takes it as it is picked up."""
    text = STUDY_OF_A_PIPE.format(name="FZ0", values="[-20.0, 10.0]")
    ds = in_memory.run(loads(f'{text}friction = 0.25\nsliding = "{sliding}"\n')).squeeze()
    hole = np.deg2rad([[30], [90], [120]])
    by_hand = np.array([-20.0, 10.0]) + 0.241 * 50 * (sign * 0.25 * np.sin(hole) - np.cos(hole))
    assert np.asarray(ds["FZ"]) == pytest.approx(by_hand, rel=1e-9)
    assert np.asarray(StoredStudy(ds).case.given.FZ) == pytest.approx(by_hand, rel=1e-9)


def test_a_force_at_s_0_that_locks_up_says_so_and_leaves_its_neighbours_alone() -> None:
    """A helix that is pulled: 1/F falls by f rho/(4 EI) in a unit of length, whatever push it begins with."""
    text = STUDY_OF_A_PIPE.format(name="FZ0", values="[-400.0, -4000.0]").replace("L = 50.0", "L = 300.0")
    text = text.replace('"30deg", "90deg", "120deg"', '"90deg"') + 'friction = 0.25\nsliding = "axial-backward"\n'
    ds = in_memory.run(loads(text)).squeeze()
    works, locked = np.asarray(ds["outcome"])
    assert str(works).startswith("solved")
    assert str(locked).startswith("failed: locked up. No push at s = L gives FZ0 = -4000 kN: beyond FZ0 = ")
    assert np.isnan(ds["FZ"][1])
    stiffness, rho = float(StoredStudy(ds).case.rod.bending_stiffness), 0.10795 - 0.0635
    change = 1 / 400 + 1 / float(ds["FZ"][0])
    assert change == pytest.approx(0.25 * rho * 300 / (4 * stiffness), rel=0.05)  # the ends and the weight are no helix


@pytest.fixture
def pipe_file(tmp_path: Path) -> Path:
    """The file of a pipe with friction that slides off under a force at s = 0."""
    text = STUDY_OF_A_PIPE.format(name="FZ0", values="[-20.0]")
    base = text.replace('axes.hole.values = ["30deg", "90deg", "120deg"]\naxes.FZ0.values = [-20.0]\n', "")
    file = tmp_path / "pipe.toml"
    file.write_text(f'{base}hole = "60deg"\nFZ0 = -200.0\nfriction = 0.25\nsliding = "axial-forward"\n')
    return file


def force_at_start(file: Path, **changes: object) -> float:
    return float(observe(solve(read_case(file, changes, {}).case), ["FZ0"])["FZ0"])


def test_one_rod_of_a_file_takes_the_force_at_s_0_with_friction(pipe_file: Path) -> None:
    assert force_at_start(pipe_file) == pytest.approx(-200, rel=1e-6)


@pytest.mark.parametrize("changes", [{"friction": 0.3}, {"friction": 0.0}, {"L": 40.0}, {"hole": "80deg"}])
def test_the_force_at_s_0_of_a_file_holds_when_other_fields_of_it_are_replaced(
    pipe_file: Path, changes: dict[str, object]
) -> None:
    assert force_at_start(pipe_file, **changes) == pytest.approx(-200, rel=1e-6)
    assert force_at_start(pipe_file, **changes, FZ0=-150.0) == pytest.approx(-150, rel=1e-6)
    assert read_case(pipe_file, {**changes, "FZ": -90.0}, {}).case.given.FZ == -90


@pytest.mark.parametrize(("sliding", "sign"), [("axial-forward", 1), ("axial-backward", -1)])
def test_a_horizontal_pipe_that_is_free_at_s_0_bears_its_friction_at_s_L(
    pipe_file: Path, sliding: str, sign: int
) -> None:
    """No force at s = 0, and none of the weight along the pipe: the force that friction alone makes is found."""
    case = read_case(pipe_file, {"hole": "90deg", "FZ0": 0.0, "sliding": sliding}, {}).case
    assert pytest.approx(sign * 0.25 * 0.241 * 50, rel=1e-6) == case.given.FZ


def test_what_is_said_of_a_force_at_s_0_that_is_not_found_counts_in_units(pipe_file: Path) -> None:
    with pytest.raises(InputError, match=r"FZ0 = -1e\+06 kN: .* at s = L \(FZ = -[\d.]+ kN\)"):
        read_case(pipe_file, {"L": 300.0, "FZ0": -1e6}, {})


def test_a_study_takes_tension_lay_and_twist_of_a_cable_in_fields_and_axes() -> None:
    case = loads(STUDY_OF_A_CABLE).case()
    wire, drum = case.rod, case.cylinder
    for i, tension in enumerate((500.0, 800.0)):
        for j, lay in enumerate(("60deg", "80deg")):
            ends = Ends.helix(wire, drum, tension=tension, lay=lay, twist=0.0)
            for name in ("beta0", "FZ", "MZ", "M3"):
                assert np.broadcast_to(getattr(case.given, name), (2, 2))[i, j] == pytest.approx(getattr(ends, name))


def test_the_first_numbers_of_a_cable_are_its_pitch_and_stress(capsys: pytest.CaptureFixture[str]) -> None:
    words = "solve --length-unit mm --E 2e5 --nu 0.3 --a 1 --L 1500 --R 60 --tension 500 --lay 80deg"
    assert exit_status(*words.split()) == 0
    found = capsys.readouterr().out
    numbers = dict(re.findall(r"^(pitch|bending_stress_max) +([\d.]+)", found, re.MULTILINE))
    pitch, stress = float(numbers["pitch"]), float(numbers["bending_stress_max"])
    assert pitch == pytest.approx(2 * pi * 61 / np.tan(np.deg2rad(80)), rel=1e-5)  # as printed
    assert stress == pytest.approx(2e5 * np.sin(np.deg2rad(80)) ** 2 / 61, rel=1e-5)


def test_of_a_helix_with_friction_nothing_is_said_of_clamps_or_of_another_shape(capsys) -> None:
    """The push at its ends is that of the helix, T sin(beta)^2/rho; another cable under weight has clamps."""
    words = "solve --length-unit mm --E 2e5 --nu 0.3 --a 1 --L 1500 --R 60 --tension 500 --lay 80deg"
    assert exit_status(*words.split(), "--friction", "0.2") == 0
    said = capsys.readouterr().out
    assert "shown: the helix of this lay" in said
    assert "clamp" not in said
    assert "stable shape" not in said
    assert "at 0 times" not in said
    assert exit_status(*words.split(), "--weight", "2e-4", "--inclination", "90deg") == 0
    assert "next to a clamp" in capsys.readouterr().out


def test_bends_of_less_than_a_degree_are_told_with_how_little_the_angle_varies(capsys) -> None:
    assert exit_status("solve", str(Path(__file__).parents[2] / "examples" / "dna.toml")) == 0
    assert re.search(
        r"^bends +2 +number of bends .*; beta varies by 0\.0\d+ deg", capsys.readouterr().out, re.MULTILINE
    )


@pytest.mark.parametrize("angle", ["-10deg", "200deg"])
def test_a_hole_whose_inclination_is_none_is_refused_by_its_own_name(angle: str, capsys) -> None:
    rod = "--EI 1e5 --GJ 8e4 --a 0.05 --L 30 --R 0.08 --side inside --weight 300 --beta0 0 --betaL 0 --MZ 0 --wob 1e4"
    assert exit_status("solve", *rod.split(), f"--hole={angle}") == 2
    assert "hole must be from 0 to pi rad" in capsys.readouterr().err


def test_a_pipe_beyond_all_limits_fails_in_one_sentence_and_warns_of_nothing(capsys) -> None:
    rod = "--EI 1e5 --GJ 8e4 --a 0.05 --L 30 --R 1e300 --side inside --weight 300 --hole 90deg --beta0 0 --betaL 0"
    assert exit_status("solve", *rod.split(), "--wob=1e4") == 1
    output = capsys.readouterr()
    assert "failed: loads, ends or L/rho" in output.out
    assert output.err == ""


def test_an_axis_value_of_no_file_is_refused(capsys) -> None:
    assert exit_status("solve", "--table1", "--at", "E=3") == 2
    assert "give also its FILE" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("load", "sentence"),
    [
        ("40 klbf", "klbf stands apart from its number: write both as one word, 5klbf, or in quotes"),
        ("40,5", "wob is a force, and there is no product of units, such as MPa, lb/ft or deg/(30 m), in ',5': choose"),
    ],
)
def test_a_load_that_is_typed_in_two_pieces_is_refused_by_what_is_wrong_with_it(load: str, sentence: str, capsys):
    assert exit_status("solve", "--EI", "1e5", "--length-unit", "m", "--wob", *load.split()) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize("text", ["20ksi", "5furlong"])
def test_a_unit_that_does_not_fit_is_refused_by_the_name_of_the_option(text: str, capsys) -> None:
    assert exit_status("solve", "--table1", "--least-bend-radius", text) == 2
    assert "--least-bend-radius is a length, and " in capsys.readouterr().err


@pytest.mark.parametrize(("share", "status"), [(0.9, 0), (1.1, 1)])
def test_a_rod_that_is_bent_tighter_than_its_least_radius_has_status_1(share: float, status: int, capsys) -> None:
    assert exit_status("solve", "--table1", "--json") == 0
    radius = 1 / json.loads(capsys.readouterr().out)["observables"]["kappa_max"]
    assert exit_status("solve", "--table1", "--least-bend-radius", f"{share * radius}cm") == status
    assert f"% {'less' if status else 'more'} than the least" in " ".join(capsys.readouterr().out.split())


def test_what_stands_in_place_of_a_field_is_given_of_options_and_of_a_file_that_none_changes(tmp_path) -> None:
    words = {"hole": pi / 3, "wob": 200.0}
    options = read_case(None, {**PIPE, "hole": "60deg", "wob": "200 kN"}, UNITS)
    assert options.stand_ins == pytest.approx(words)
    base = "\n".join(f"{name} = {json.dumps(value)}" for name, value in {**PIPE, **words}.items())
    units = 'length = "m"\nforce = "kN"'
    (tmp_path / "pipe.toml").write_text(f'title = "A pipe"\n[units]\n{units}\n[base]\n{base}\n')
    assert read_case(tmp_path / "pipe.toml", {}, {}).stand_ins == pytest.approx(words)
    changed = read_case(tmp_path / "pipe.toml", {"inclination": "90deg"}, {})
    assert changed.case.cylinder.inclination == pytest.approx(pi / 2)
    assert changed.stand_ins == {"wob": 200.0}


@pytest.mark.parametrize(
    "axis, options, title",
    [("", "", "A short rod"), ("", "--E 2e4", "A short rod, except E"),
     ("F3", "--at F3=2", "A short rod, F3 = 2")],
)  # fmt: skip
def test_a_rod_of_a_study_is_stored_under_the_title_of_the_study_with_what_differs(
    tmp_path, monkeypatch, axis: str, options: str, title: str
) -> None:
    monkeypatch.chdir(tmp_path)
    base = small.SHORT | {"beta": 0.5, "dbeta": 0.5, "M3": 0.0} | ({} if axis else {"F3": 1.0})
    Path("short.toml").write_text(small.text(base, axis and small.axis(axis, [1.0, 2.0]), title="A short rod"))
    run(f"workbench solve short.toml {options} -o one.h5")
    assert reading.read("one.h5").attrs["title"] == title


def test_the_title_of_a_long_rod_has_no_exponent() -> None:
    given = {"E": 2e5, "nu": 0.3, "a": 6.0, "L": 10355.46, "R": 200.0, "beta0": 1.5, "betaL": 1.5, "FZ": 1.0}
    title = read_case(None, {**given, "MZ": 0.0, "M3": 0.0}, {"length": "mm", "force": "N"}).title
    assert title == "A rod 10355 mm long, of diameter 12 mm, on a cylinder of diameter 400 mm"
