"""rod.wasm, the core for browsers, against the core of this machine."""

import json
import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from solver.core import build, tuning
from solver.core.library import numbers_of
from solver.core.measures import NUMBERS, measure
from solver.core.tuning import SAFETY
from solver.core.weight_friction import ORDER, TRUNCATION
from solver.nodes.banded_newton import DEEP
from solver.nodes.shape_error import ROUNDING, SHORTER
from solver.observe.solution_pieces import pieces_of
from solver.orbits.marched_orbit import LOST, march
from solver.problem.dimensionless import StartProblem

HERE = build.HERE
CASES, STATIONS, TOL = 200, 41, 1e-10
SCRIPT = """
const fs = require("fs"), [folder, cases] = process.argv.slice(1);
const RodCore = require(folder + "/rod.js");
RodCore.load(fs.readFileSync(folder + "/rod.wasm")).then(core => {
  const told = JSON.parse(fs.readFileSync(cases)).map(([problem, times, tol]) => {
    const orbit = core.solve(problem, tol, times);
    for (const name of ["beta", "rate", "alpha", "z", "swirl"]) if (orbit[name]) orbit[name] = Array.from(orbit[name]);
    return orbit;
  });
  console.log(JSON.stringify(told));
});
"""


def problems() -> StartProblem:
    rng = np.random.default_rng(12)
    loads = rng.normal(0, 1, (3, CASES)) * 10 ** rng.uniform(-2, 1, CASES)
    span, beta = 10 ** rng.uniform(0, 2.5, CASES), rng.uniform(-np.pi, np.pi, CASES)
    problem = StartProblem(*loads, span, beta, rng.normal(0, 1, CASES))
    problem.dbeta0[:3], problem.beta0[:3], problem.phi[:3] = [1e-9, 0, 0], [np.pi, 0.3, 0], [-1, 2, 1]
    problem.lam[:3] = problem.mu[:3] = 0  # next to a saddle, released at rest, and a straight rod
    return problem


def in_node(folder: Path, problem: StartProblem, t: np.ndarray) -> list[dict]:
    """What rod.js answers in Node."""
    names = ("lam", "mu", "phi", "span", "beta0", "dbeta0")
    rows = [({name: getattr(problem, name)[i] for name in names}, t[i].tolist(), TOL) for i in range(problem.size)]
    (folder / "cases.json").write_text(json.dumps(rows))
    command = ["node", "-e", SCRIPT, str(HERE), str(folder / "cases.json")]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return json.loads(run.stdout)


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
def test_the_core_for_browsers_gives_the_numbers_of_this_machine(tmp_path: Path) -> None:
    problem = problems()
    t = problem.span[:, None] * np.linspace(0, 1, STATIONS)
    out, swirl = np.empty((4, *t.shape)), np.empty(t.shape)
    known = march(numbers_of(problem), TOL, t, out, swirl)
    told = in_node(tmp_path, problem, t)
    ends = [("marched", "turns", "goes round")[status] for status in known["status"][:, 0]]
    ends[2] = "lost"  # a change of this straight rod grows to 1e97
    assert [one["end"] for one in told] == ends
    assert set(ends) == {"lost", "marched", "turns", "goes round"}
    for i in np.flatnonzero(known["status"][:, 0] != LOST):
        size = np.maximum(1, problem.span[i])
        for name, values in zip(("beta", "rate", "alpha", "z", "swirl"), (*out[:, i], swirl[i]), strict=True):
            off = np.abs(np.array(told[i][name]) - values).max() / size
            assert off <= 1e-12, (i, name)
        assert told[i]["sound"] == (known["sound"][i] == 1)
        for name in ("error", "condition"):
            assert told[i][name] == pytest.approx(known[name][i], rel=1e-9)


MEASURES = """
const fs = require("fs"), [folder, given] = process.argv.slice(1), [problem, sign, error, rod] = JSON.parse(given);
const RodCore = require(folder + "/rod.js");
RodCore.load(fs.readFileSync(folder + "/rod.wasm")).then(core => {
  console.log(JSON.stringify(core.measure(problem, sign, error, rod)));
});
"""


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
def test_a_browser_measures_the_numbers_of_this_machine_between_the_same_stations() -> None:
    case = Case(Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start("30deg", 0.5, F1=5.0, F3=10.0))
    sol = solve(case, method="dop853", tol=1e-9, stations=401)
    p, error = sol.problem, float(sol.error)
    known = measure(pieces_of(sol, np.arange(1)), {"sign": np.ones(1), "error": np.array([error])}, NUMBERS, 1e-11)
    problem = {name: float(getattr(p, name)[0]) for name in ("lam", "mu", "phi")}
    rows = {"t": sol.t[0], "beta": sol.trajectory.beta[0], "rate": sol.trajectory.dbeta[0]}
    rod = {name: row.tolist() for name, row in rows.items()}
    given = json.dumps([problem, 1, error, rod])
    run = subprocess.run(["node", "-e", MEASURES, str(HERE), given], capture_output=True, text=True, check=True)
    told = json.loads(run.stdout)
    assert tuple(told) == NUMBERS
    for name, value in told.items():
        assert value == pytest.approx(float(known[name][0][0]), rel=1e-9, abs=1e-12), name


def test_the_file_was_compiled_from_the_sources_that_are_here() -> None:
    assert build.digest_for_browsers().encode() in (HERE / build.WASM).read_bytes()


def test_the_numbers_of_the_script_are_those_of_python() -> None:
    script = (HERE / build.WASM).with_name("rod.js").read_text(encoding="utf-8")
    same = {"ORDER": ORDER, "SAFETY": SAFETY, "ROUNDING": ROUNDING, "SHORTER": SHORTER, "LEFT_OUT": TRUNCATION}
    for name, value in same.items():
        assert [float(text) for text in re.findall(rf"\b{name} = ([\d.e-]+)", script)] == [value]
    assert re.findall(r"NEWTON = \{columns: BY_ANGLE, deep: (\d+)\}", script) == [str(DEEP)]


TUNED = """
const [folder, counts] = process.argv.slice(1), [doubles, integers] = JSON.parse(counts);
const bytes = require("fs").readFileSync(folder + "/rod.wasm");
WebAssembly.instantiate(bytes, {}).then(({instance: {exports: own}}) => {
  own._initialize();
  const at = own.rod_tuned(), whole = new BigInt64Array(own.memory.buffer, at + 8 * doubles, integers);
  console.log(JSON.stringify([...new Float64Array(own.memory.buffer, at, doubles), ...Array.from(whole, Number)]));
});
"""


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
def test_the_core_for_browsers_decides_by_the_numbers_of_python() -> None:
    counts = [sum(len(names.split(",")) for kind, names in tuning.ROWS if kind == of) for of in ("double", "int64_t")]
    command = ["node", "-e", TUNED, str(HERE), json.dumps(counts)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(run.stdout) == list(tuning.values().values())


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="the package ziglang is not installed")
def test_compiling_it_again_gives_the_same_file(tmp_path: Path) -> None:
    build.build_for_browsers(tmp_path / "again.wasm")
    assert (tmp_path / "again.wasm").read_bytes() == (HERE / build.WASM).read_bytes()
