"""A method, an observable of what is measured already and a direction of laws are rows: each is added here so."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, observe, solve
from solver.methods import AUTOMATIC, METHODS, StartMethod, Verlet, available
from solver.methods.method import Ladder, knob
from solver.numerics.complex_step import size_of
from solver.observe.observables import OBSERVABLES, Observable
from solver.problem.quantities import QUANTITIES, Quantity
from studies.language.loader import loads
from studies.laws import law_words
from studies.laws.line_verdicts import DIRECTIONS, FAILS, HOLDS, Direction, Line, Verdict
from tests.workbench import small
from workbench.figures import canvas, study_figure
from workbench.lab import trade_figure
from workbench.lab.benchmark import available_ladders
from workbench.lab.trade_runs import ladders_of
from workbench.run import in_memory
from workbench.stored import stored_verdicts
from workbench.stored.stored_study import StoredStudy

ROOT = Path(__file__).parents[1]
CASE = Case(Rod(1.07e4, 0.25, 0.25, 5.0), Cylinder(0.75), Start(0.5, 0.5, dgamma=0.5))


@dataclass(frozen=True)
class Toy(StartMethod):
    """Verlet under another name, with a knob of its own."""

    name = "toy"
    summary = "a toy"
    order = 2
    ladders = (Ladder("toy", "fineness", (1, 2), "#123456", "*"),)

    fineness: int = knob(int, least=1, default=1)

    def run(self, problem, t, tol):
        return Verlet(steps=16 * self.fineness).run(problem, t, tol)


def test_a_method_is_one_row_and_is_then_solved_with_listed_compared_and_drawn(monkeypatch) -> None:
    monkeypatch.setitem(METHODS, "toy", Toy)
    by_name, by_value = solve(CASE, 0.1, "toy", fineness=2), solve(CASE, 0.1, Toy(fineness=2))
    assert by_name.solved
    assert by_name.method == by_value.method == "toy"
    np.testing.assert_array_equal(by_name.beta, by_value.beta)
    with pytest.raises(InputError, match=r"no method 'rk5', did you mean 'rk4'; choose from auto, .*, toy"):
        solve(CASE, method="rk5")
    with pytest.raises(InputError, match="no knob 'steps' in method 'toy'; its knobs: fineness"):
        solve(CASE, method="toy", steps=4)
    assert available_ladders()["toy"].values == ladders_of(["toy"])["toy"].values == (1, 2)
    ds = in_memory.run(small.study("[base]\nL = 3.0\n").with_values(tol=0.1, method="toy"))
    assert ds.attrs["method"] == "toy"
    assert trade_figure.look_of("toy").colour == "#123456"


def test_every_method_describes_itself() -> None:
    assert [method.name for method in METHODS.values()] == list(METHODS)
    for method in METHODS.values():
        assert method.ladders, f"{method.name} has no ladder"
        assert all(ladder.method == method.name and ladder.marker for ladder in method.ladders)
        assert bool(method.requires) == bool(method.extra)
    assert set(AUTOMATIC.values()) <= set(METHODS)
    assert set(available()) <= set(METHODS)


@pytest.mark.parametrize("method", available())
def test_the_boolean_of_every_method_says_what_its_sentence_says(method: str) -> None:
    given = CASE.given if "start" in METHODS[method].problems else Ends(0.5, 0.6)
    case = Case(Rod(1.07e4, 0.25, 0.25, [5.0, 1e-300]), Cylinder(0.75), given)
    coarse = METHODS[method].ladders[0]
    for options in ({"tol": 0.5, "method": method}, {**coarse.options(coarse.values[0]), "tol": 1e-16}):
        sol = solve(case, stations=3, **options)
        assert [text.startswith("solved") for text in sol.outcome] == sol.solved.tolist()
        assert [text.startswith("failed: ") for text in sol.outcome] == (~sol.solved).tolist()
        assert sol.solved.tolist() == [options["tol"] == 0.5 or "; fewer digits" in sol.outcome[0], False]


def strings(file: Path) -> Iterator[str]:
    """The string constants of a module, docstrings apart."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_no_other_module_keeps_a_table_of_methods() -> None:
    files = [file for top in ("solver", "studies", "workbench") for file in (ROOT / top).rglob("*.py")]
    named = [file for file in files if sum(f'"{name}"' in file.read_text(encoding="utf-8") for name in METHODS) > 1]
    families = {Path(sys.modules[method.__module__].__file__): method.__module__ for method in METHODS.values()}
    own = {file: {name for name, m in METHODS.items() if m.__module__ == module} for file, module in families.items()}
    lists = {str(file.relative_to(ROOT)): set(strings(file)) & set(METHODS) - own.get(file, set()) for file in named}
    tables = {name for name, others in lists.items() if len(others) > 1}
    assert tables == {"solver/methods/__init__.py"}


def test_an_observable_is_two_rows_and_is_then_observed_studied_stored_and_labelled(monkeypatch) -> None:
    def stations(read):
        return np.full(read.sol.problem.size, read.sol.t.shape[1])

    monkeypatch.setitem(OBSERVABLES, "stations", Observable(stations))
    monkeypatch.setitem(QUANTITIES, "stations", Quantity("stations", "n", (0, 0), "number of stations"))
    assert observe(solve(CASE, stations=11), ["stations"]) == {"stations": 11}
    axis = "[axes.E]\nvalues = [1e4, 2e4, 3e4]\n"
    law = "[[laws]]\nclaim = 'a'\nobservable = 'stations'\naxis = 'E'\ndirection = 'not-falling'\nsource = 's'\n"
    ds = in_memory.run(small.study(axis + law, 'observables = ["stations"]\n'))
    assert ds["stations"].values.tolist() == [21, 21, 21]
    assert (ds["stations"].attrs["units"], ds["stations"].attrs["long_name"]) == ("1", "number of stations")
    assert stored_verdicts.verdicts(ds)[0]["verdict"] == HOLDS


def test_an_observable_that_is_two_rows_has_its_derivatives_too(monkeypatch) -> None:
    """A formula with cases and a size, against differences of fourth order."""

    def steepness(read):
        turned, risen = read.gain
        return np.where(np.real(risen) < 1e3, size_of(turned / risen) / read.rho, np.nan), 0.0

    monkeypatch.setitem(OBSERVABLES, "steepness", Observable(steepness))
    row = Quantity("steepness", "k", (-1, 0), "turning by height", estimated=True)
    monkeypatch.setitem(QUANTITIES, "steepness", row)

    def values(R: float) -> float:
        case = replace(CASE, cylinder=replace(CASE.cylinder, R=R))
        return float(observe(solve(case, tol=1e-13), ["steepness"])["steepness"])

    found, R, step = solve(CASE).sensitivity("R", ["steepness"]), float(CASE.cylinder.R), 1e-3
    near, far = (values(R + k * step) - values(R - k * step) for k in (1, 2))
    assert found.observables["steepness"] != 0
    assert found.observables["steepness"] == pytest.approx([(8 * near - far) / (12 * step)], rel=1e-7)


def test_a_kind_of_law_is_one_row_and_is_then_read_judged_worded_and_drawn(monkeypatch) -> None:
    def level(line: Line) -> Verdict:
        wrong = np.flatnonzero(np.abs(np.diff(line.values)) > line.noise)
        return Verdict(FAILS if wrong.size else HOLDS, None, [(int(i), int(i) + 1) for i in wrong])

    law = "[[laws]]\nclaim = 'a'\nobservable = 'height'\naxis = 'E'\ndirection = 'stays-level'\nsource = 's'\n"
    axis = "[axes.E]\nvalues = [1e4, 2e4, 3e4]\n"
    with pytest.raises(InputError, match="no direction 'stays-level'; choose from rises, falls"):
        loads(small.HEAD + axis + law)
    monkeypatch.setitem(DIRECTIONS, "stays-level", Direction(level, "stays level", "changes"))
    ds = in_memory.run(small.study(axis + law))
    (row,) = stored_verdicts.verdicts(ds)
    assert (row["verdict"], len(row["exceptions"])) == (FAILS, 2)
    assert law_words.law_in_words(row) == "height stays level along E"
    fig = study_figure.figure(StoredStudy(ds))
    assert any(ax.get_title(loc="left").endswith("a:\N{NO-BREAK SPACE}false") for ax in fig.axes)
    assert "stays level with" in " ".join(canvas.caption(fig))


def test_a_field_of_the_cylinder_is_one_row_and_is_then_read_checked_offered_stored_and_described(tmp_path) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "tests.one_more_field", tmp_path], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.stdout == "as told\n", run.stderr[-2000:]
