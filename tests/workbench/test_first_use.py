"""What a new user types first is understood from a slip, and the help names each unit; sentences: first_use.txt."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from solver.problem.declared_fields import FIELDS
from solver.problem.errors import near
from solver.problem.quantities import unit_of
from studies.grammar.axes import Base, Units
from studies.language.study import Study
from tests.slow import slow

ROOT = Path(__file__).parents[2]


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


def test_the_help_of_each_number_names_its_unit(call) -> None:
    for command in ("solve", "equilibria", "loops", "fit"):
        said = " ".join(call(command, "--help")[1].split())
        options = dict(re.findall(r"--(\w+) (?:NUMBER|ANGLE) (.{0,200})", said))
        for name in FIELDS.keys() & options.keys():
            unit = unit_of(FIELDS[name].quantity, {"length": "length", "force": "force"})
            assert unit == "1" or f"[{unit}]" in options[name], (command, name)
        assert "default: cm" in said
        assert "default: N" in said
