"""The options for the fields of a case: their table says what the solver says, and every command offers all of them."""

import re
from dataclasses import MISSING, fields
from math import pi, radians, tan

import pytest
from typer.main import get_command

from solver import Cylinder, Ends, Rod, Start
from solver.problem.case import PAIRS, SIDES, SLIDING, STIFFNESS, TWISTS
from solver.problem.quantities import unit_of
from solver.problem.rod import lacking
from studies.grammar.axes import quantity_of
from tests.workbench.command import exit_status
from workbench import cli
from workbench.commands.case_options import ENDS_FIELDS, FIELDS, HELD, help_of

SECTION = ("E", "nu", "a", "L", "inner_radius", "EI", "GJ")  # of which a rod needs either pair, a and L
PARTS = {"": (Rod, Cylinder), "start": (Start,), "ends": (Ends,)}


def declared() -> dict[str, set[type]]:
    """Every field of a case, and the parts that have it."""
    found: dict[str, set[type]] = {}
    for part in (Rod, Cylinder, Start, Ends):
        for field in fields(part):
            found.setdefault(field.name, set()).add(part)
    return found


def test_the_table_has_every_field_of_a_case_and_no_other() -> None:
    assert set(FIELDS) == set(declared())


@pytest.mark.parametrize("name", FIELDS)
def test_a_field_belongs_to_the_problem_that_the_table_names(name: str) -> None:
    parts, problem = declared()[name], FIELDS[name].problem
    if name in ("alpha", "gamma"):  # of both problems, with one meaning
        assert (problem, parts) == ("", {Start, Ends})
    elif problem == "start or ends":
        assert parts == {Start, Ends}
    else:
        assert parts <= set(PARTS[problem])


@pytest.mark.parametrize("name", FIELDS)
def test_unit_and_words_are_those_of_the_quantity(name: str) -> None:
    field = FIELDS[name]
    if field.choices:
        assert field.unit == ""
        return
    assert field.unit == unit_of(quantity_of(name).name, {"length": "length", "force": "force"})
    assert field.words.startswith(quantity_of(name).long_name)


@pytest.mark.parametrize("name", FIELDS)
def test_the_default_is_that_of_the_solver(name: str) -> None:
    defaults = {field.default for part in declared()[name] for field in fields(part) if field.name == name}
    if name in TWISTS or name in SECTION:  # required in one way or another
        assert FIELDS[name].default is None
    elif name in ("weight", "inclination", "friction", "sliding"):  # without one there is none
        assert defaults == {None}
        assert FIELDS[name].default is None
    elif name in {field for pair in PAIRS for field in pair}:  # a load is 0 unless its displacement is held
        assert defaults == {None}
        assert FIELDS[name].default == (0.0 if name in ("FZ", "MZ") else None)
    else:
        assert defaults == {MISSING if FIELDS[name].default is None else FIELDS[name].default}


def test_a_rod_needs_one_of_two_pairs() -> None:
    assert lacking([]) == lacking(["inner_radius"]) == ["E", "nu", "a", "L"]
    assert lacking(["GJ", "a"]) == ["EI", "L"]
    for name in ("E", "nu", "EI", "GJ"):
        assert FIELDS[name].note == "give E and nu, or EI and GJ"


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


CABLE = ["solve", "--length-unit", "mm", "--E", "2e5", "--nu", "0.3", "--a", "2", "--L", "1500", "--R", "60"]


def printed(capsys, *args: str) -> tuple[int, str]:
    return exit_status(*CABLE, *args), "".join(capsys.readouterr())


@pytest.mark.parametrize(("tension", "words"), [("2000", "which is stable"), ("20", "unstable in 6 ways under dead")])
def test_a_wound_cable_is_the_helix_of_its_tension_and_lay(tension: str, words: str, capsys) -> None:
    """Below A/rho^2, here 654 N, another shape is stable; the helix is shown, and that it is not stable is said."""
    status, shown = printed(capsys, "--all", "--tension", tension, "--lay", "80deg")
    assert status == 0
    assert f"the helix of this tension and lay, {words}" in shown
    values = dict(re.findall(r"^(\w+) +(\S+) ", shown, re.MULTILINE))
    assert float(values["pitch"]) == pytest.approx(2 * pi * 62 / tan(radians(80)), rel=1e-5)
    assert float(values["amplitude"]) == 0


@pytest.mark.parametrize(
    ("args", "sentence"),
    [
        (["--tension", "20"], "needs tension and lay, got no lay"),
        (["--tension", "20", "--lay", "1", "--FZ", "3"], "determine the angles and loads of both ends: omit FZ"),
        (["--lay", "1", "--tension", "20", "--beta", "1"], "omit beta"),
    ],
)
def test_a_wound_cable_refuses_what_it_does_not_determine(args: list[str], sentence: str, capsys) -> None:
    status, shown = printed(capsys, *args)
    assert status == 2
    assert sentence in shown


PIPE = "--EI 1.228e6 --GJ 9.45e5 --a 0.0635 --L 60 --R 0.10795 --beta0 0 --betaL 0 --length-unit m".split()  # noqa: SIM905


LYING = ["--FZ", "-2e5", "--side", "inside", "--weight", "242", "--inclination", "90deg"]


@pytest.mark.parametrize(
    ("args", "status", "sentence"),
    [
        (["--FZ", "-2e5", "--side", "inside"], 0, "leaves out weight, friction, joints, clearance at the ends, the "),
        (LYING, 0, "stable (index 0) ... straight below 1.635e+05 N; from 2.244e+05 a helix can stay ... leaves out "
         "friction, joints, clearance at the ends, the curvature of the hole, fluid flow, temperature, and yielding."),
        (["--FZ", "-2e5", "--side", "inside", "--weight", "242", "--friction", "0.1"], 0,
         "leaves out the moment of friction about the rod's own axis, joints, clearance at the ends, the curvature"),
        (["--MZ", "2e4", *LYING], 0,
         "no real rod could hold: see the caution ... caution: the wall would have to pull on "),
        ([*LYING, "--FZ", "-1e5"], 0, "state: straight all along"),
        ([*LYING, "--azimuth", "0"], 0,
         "neither end is lower ... is that next to a clamp; a wave away from the ends it is at most "),
        ([*LYING, "--inclination", "120deg"], 0,
         "a compression above 1.575e+05 N at s = L (a compression above 1.502e+05 N ... s = L is the lower "
         "end, s = 0 the upper one"),
        ([*LYING, "--inclination", "60deg", "--L", "1400", "--FZ", "2e5", "--azimuth", "0"], 0,
         "a tension below 7734 N at s = L (a compression above 1.617e+05 N at s = 0) ... s = 0 is the lower end"),
        (["--FZ", "-1e5", "--side", "inside", "--weight", "-1"], 2, "Rod.weight must be at least 0, got -1.0"),
        (["--FZ", "-1e5", "--sliding", "backward"], 2,
         "sliding matters only with friction, got sliding='backward' and no friction"),
        (["--FZ", "-1e5", "--inclination", "90deg"], 2,
         "inclination matters only for a rod with weight, got inclination=1.57"),
    ],
)  # fmt: skip
def test_a_rod_in_a_hole_is_told_what_the_model_leaves_out(args, status, sentence: str, capsys) -> None:
    """2 sqrt(EI w/rho) of a 5 in pipe in an 8.5 in hole is 163.5 kN (Dawson and Paslay)."""
    assert exit_status("solve", *PIPE, *args) == status
    streams = capsys.readouterr()
    assert all(part in streams.out + streams.err for part in sentence.split(" ... "))


STEEL = [*PIPE[4:], *"--E 2.06e11 --nu 0.3 --inner_radius 0.0543 --azimuth 0".split()]  # noqa: SIM905


def test_of_a_pipe_with_a_section_the_stress_is_stated_and_whether_steel_yields(capsys) -> None:
    """The axial stress is the load over the section; a strain of 0.25 % is 517 MPa, where grade E-75 yields."""
    for load, yields in ((-2e5, False), (-1.5e6, True)):
        exit_status("solve", *STEEL, *LYING, "--FZ", load)
        shown = capsys.readouterr().out
        axial, bending, both = (
            [float(number) for number in re.search(rf"^{name} +MPa +(.*)", shown, re.MULTILINE)[1].split()]
            for name in ("axial stress", "bending stress", "both stresses together")
        )
        assert axial[0] == pytest.approx(load / (pi * (0.0635**2 - 0.0543**2)) * 1e-6, rel=1e-3)
        assert both[2] == pytest.approx(bending[2] - axial[2], rel=0.01)  # here the largest are at one place
        assert ("caution: the strain reaches 0.39 %" in shown) is yields


def test_the_help_of_a_field_says_problem_unit_rule_and_default() -> None:
    assert help_of(FIELDS["dgamma"], whole=True) == (
        "Rate of rotation of the section at the start [rad/length]; give one of F1, dgamma, M3."
    )
    assert help_of(FIELDS["F2"], whole=True).endswith("across the rod [force]; default: 0.")
    assert help_of(FIELDS["FZ"], whole=False) == "Axial force, tension positive [force]."
