"""What a new user types first: wrong names, numbers with units, degrees; each is answered by one clear sentence."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from solver import Ends, InputError
from solver.problem.case import from_fields
from solver.problem.errors import near
from studies.grammar.axes import Base, Units
from studies.language.loader import loads
from studies.language.model import Study
from tests.slow import slow
from tests.workbench.command import exit_status
from workbench.commands.case_options import FIELDS

ROOT = Path(__file__).parents[2]
HEAD = 'title = "One rod"\nunits = { length = "cm", force = "N" }\n[base]\nE = 1e4\nnu = 0.25\na = 0.25\nL = 20.0\n'
ENDS = "R = 0.75\nbeta0 = 0.5\nbetaL = 0.5\n"


@pytest.fixture
def told(capsys):
    """The exit status, stdout and stderr of a command."""

    def run(*args: object) -> tuple[int, str, str]:
        return exit_status(*args), *capsys.readouterr()

    return run


MEANT = {
    "FX": "FZ", "Radius": "R' or 'a", "radius": "R' or 'a", "youngs_modulus": "E", "modulus": "E", "poisson": "nu",
    "length": "L", "r": "R", "fz": "FZ", "MX": "MZ", "inner": "inner_radius", "heigth": "height", "beta_0": "beta0",
}  # fmt: skip


@pytest.mark.parametrize("typed", MEANT)
def test_a_wrong_key_or_option_names_what_may_be_meant(typed, told) -> None:
    with pytest.raises(InputError, match=f"no key '{typed}' in base, did you mean '{MEANT[typed]}"):
        loads(HEAD + ENDS + f"{typed} = 1.0\n")
    status, _, said = told("solve", f"--{typed}", "1")
    assert status == 2
    meant = MEANT[typed].replace(" or '", " or '--")
    assert f"No such option: --{typed}, did you mean '--{meant}" in said


@pytest.mark.parametrize("known", [[*Base.model_fields], [*Units.model_fields], [*Study.model_fields], [*FIELDS]])
def test_every_key_is_found_from_a_slip(known) -> None:
    for name in known:
        for slip in {name.swapcase(), *({name + "s", name[1:], name[0] + name[2:]} if len(name) > 4 else ())} - {
            *known
        }:
            assert f"'{name}'" in near(slip, known), slip


def test_what_resembles_nothing_gets_no_guess() -> None:
    assert near("Q", FIELDS) == ""
    assert near("colour", FIELDS) == ""


def test_a_field_of_the_other_problem_names_its_partner() -> None:
    with pytest.raises(InputError, match="no field 'beta', did you mean 'beta0' or 'betaL'"):
        loads(HEAD + ENDS.replace("beta0", "beta"))
    with pytest.raises(InputError, match="no field 'FX' in Ends, did you mean 'FZ'"):
        from_fields(Ends, {"beta0": 0.1, "betaL": 0.2, "FX": 1.0})


def test_two_spellings_of_an_option_are_listed_once(told) -> None:
    status, _, said = told("solve", "--Q", 3)
    assert (status, said.count("inner"), "--length-unit" in said) == (2, 1, True)


def test_a_number_with_a_unit_is_refused_with_the_place_of_units(told) -> None:
    wanted = "line 8: base.R must be a number without a unit, got '63.5 mm': write the number alone; the table units"
    with pytest.raises(InputError, match=re.escape(wanted)):
        loads(HEAD + ENDS.replace("0.75", '"63.5 mm"'))
    status, _, said = told("solve", "--R", "5mm")
    assert (status, "'5mm' is not a number; write the number without a unit" in said) == (2, True)


def test_a_notice_on_degrees_is_one_line_and_said_once(told, tmp_path) -> None:
    study, stored = tmp_path / "deg.toml", tmp_path / "deg.h5"
    study.write_text(HEAD.replace("[base]", "observables = []\noutputs = []\n[base]") + ENDS.replace("0.5", "5", 1))
    notice = 'beta0 = 5 is read as 5 rad = 286.48 degrees; write "5 deg" if degrees are meant, or "5 rad"'
    for words in (("solve", study), ("run", study, "--out", stored), ("check", stored), ("check", stored, "--json")):
        status, out, said = told(*words)
        assert (status, said.count(notice), said.count("\n")) == (0, 1, 1), (words, said)
        assert said.startswith("workbench: notice: deg.")
        assert notice not in out
    assert "(286.479 deg)" in told("solve", study)[1]
    status, out, said = told("solve", "--table1", "--beta", "45")
    assert (status, said.startswith("workbench: notice: --beta = 45 is read as 45 rad")) == (0, True)
    assert told("solve", "--table1", "--beta", "45 deg")[2] == ""


@pytest.mark.parametrize("missing", ["xarray", slow("matplotlib")])
def test_an_installation_of_the_solver_alone_says_what_a_picture_needs(missing) -> None:
    """A process in which the package cannot be imported, as after pip install --no-deps."""
    code = (
        f"import sys; sys.modules[{missing!r}] = None\n"
        "from solver import Case, Cylinder, Rod, Start, solve\n"
        "sol = solve(Case(Rod(E=1e4, nu=.25, a=.25, L=5.), Cylinder(R=.75), Start(beta=.5, dbeta=.5, M3=0.)))\n"
        "assert sol._repr_html_() is None or sol.solved\n"
        "try:\n    sol.plot()\nexcept ImportError as error:\n    print(error)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert f"a solution need the package {missing}, which is not installed" in run.stdout
    assert "pip install rod-workbench, without --no-deps" in run.stdout


def test_the_help_of_each_number_names_its_unit(told) -> None:
    for command in ("solve", "equilibria", "loops", "fit"):
        said = " ".join(told(command, "--help")[1].split())
        options = dict(re.findall(r"--(\w+) (?:NUMBER|ANGLE) (.{0,200})", said))
        for name in FIELDS.keys() & options.keys():
            assert FIELDS[name].unit == "1" or f"[{FIELDS[name].unit}]" in options[name], (command, name)
        assert "default: cm" in said
        assert "default: N" in said
