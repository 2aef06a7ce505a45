"""`workbench sensitivity` and `workbench.influence`: elasticities of one case, Sobol' indices of a sampled study."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from solver import Case, Cylinder, Ends, InputError, Rod, Start, observe, solve
from solver.observe.observables import OBSERVABLES
from studies import load
from studies.language.loader import loads
from studies.language.samples import METHODS
from tests.workbench import small, stored_figures
from tests.workbench.command import run
from tests.workbench.study_kinds import PIPE
from workbench.branches.ends_study import ends_problem
from workbench.figures import bars
from workbench.figures.sheet import sheet
from workbench.influence import analyse, local, sobol
from workbench.influence.derivatives import REAL
from workbench.influence.sobol_indices import Design, design_of
from workbench.run import in_memory, writing
from workbench.stored import case_of_file, reading
from workbench.stored.stored_study import StoredStudy

TABLE = Case(Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start("30deg", 0.5, F1=5.0, F3=10.0))
SAMPLES = """
[sample]
method = "saltelli"
size = 160
seed = 3
[sample.E]
from = 1e4
to = 1.2e4
[sample.R]
from = 0.7
to = 0.8
[sample.F1]
from = 4.0
to = 6.0
"""
OBSERVED = 'observables = ["kappa_max", "height"]\noutputs = []\n'


def samples(method: str, blocks: int, fields: int = 3, seed: int = 1) -> Any:
    """A design in the unit cube, (samples, fields)."""
    size = blocks * (2 * fields + 2 if method.endswith("order") else fields + 2)
    return METHODS[method][0](size, fields, seed)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: Any) -> Path:
    return writing.write(in_memory.run(small.study(SAMPLES, OBSERVED)), tmp_path_factory.mktemp("stored") / "small.h5")


def test_loads_and_end_moments_that_a_study_names_have_indices_too(tmp_path) -> None:
    held = 'observables = ["kappa_max", "MZ0", "M10"]\noutputs = []\n'
    path = writing.write(in_memory.run(small.study(SAMPLES, held)), tmp_path / "named.h5")
    table = sobol(reading.read(path))
    assert table["observable"].values.tolist() == ["kappa_max", "MZ0", "M10"]
    assert np.isfinite(table["total"].values).all()


# one case


def test_an_elasticity_is_the_change_in_percent_for_one_percent() -> None:
    table = local(solve(TABLE))
    assert list(table["observable"].values) == [
        name for name in REAL if not (OBSERVABLES[name].holds or OBSERVABLES[name].free)
    ]
    wider = solve(Case(TABLE.rod, Cylinder(0.75 * 1.0001), TABLE.given), tol=1e-12)
    narrower = solve(Case(TABLE.rod, Cylinder(0.75 * 0.9999), TABLE.given), tol=1e-12)
    for name in ("height", "kappa_max", "push_min", "energy", "pitch"):
        low, high = (float(observe(sol, [name])[name]) for sol in (narrower, wider))
        seen = float(table["effect"].sel(observable=name, field="R"))
        assert seen == pytest.approx((high - low) / 2e-4 / float(table["value"].sel(observable=name)), rel=1e-4), name


def test_elasticities_of_stiffness_and_loads_add_up_to_the_power_of_a_force() -> None:
    """Every load and E twice as large leave the shape, and double every force, moment and energy."""
    given = Start("30deg", 0.5, F1=5.0, F2=1.0, F3=10.0)
    table = local(solve(Case(TABLE.rod, TABLE.cylinder, given)), ["E", "F1", "F2", "F3"])
    power = {"height": 0, "kappa_max": 0, "attached": 0, "push_max": 1, "energy": 1, "F3_size_max": 1, "pitch": 0}
    for name, wanted in power.items():
        assert float(table["effect"].sel(observable=name).sum()) == pytest.approx(wanted, abs=1e-8), name


def test_a_forecast_that_leaves_the_values_of_an_observable_is_none() -> None:
    """A wire in a tube whose ends are next to saddles: its half period answers MZ by ten million times itself."""
    ends = Ends(0.0, 0.0, FZ=-20.0)
    sol = solve(Case(Rod(E=2.1e5, nu=0.3, a=0.25, L=120.0), Cylinder(2.0, "inside"), ends))
    row = local(sol, ["MZ", "R"], ["bend_number"]).isel(observable=0)
    assert abs(float(row["derivative"].sel(field="MZ"))) > 1e6
    assert np.isnan(row["effect"].sel(field="MZ"))
    assert float(row["effect"].sel(field="R")) == 0
    assert str(row["remark"].values).startswith("no forecast for MZ: ")


def test_an_effect_that_is_rounding_is_none() -> None:
    """The largest curvature of a rod between two ends is that of one of its bends, which does not know its length."""
    table = local(solve(ends_problem(load("fig6"))))
    size = np.abs(table["effect"])
    share = size / size.max("field")
    assert not ((share > 0) & (share < table.attrs["relative_error"])).any()
    assert float(table["effect"].sel(observable="kappa_max", field="L")) == 0
    assert float(table["derivative"].sel(observable="kappa_max", field="L")) == 0
    assert float(share.sel(observable="amplitude", field="L")) == pytest.approx(6.56e-9, rel=1e-2)


def test_a_followed_study_and_a_sweep_have_elasticities_of_one_case() -> None:
    followed = load("fig7_4_end_angle").at_stations(21)
    found = case_of_file.solve_case(
        StoredStudy(in_memory.outline(followed)), {"betaL": -14.37992253 * np.pi / 180}, followed
    )
    assert "betaL" in local(found, observables=["height"])["field"]
    base = {**small.ROD, "beta0": 0.5, "betaL": 0.8, "MZ": 1.3, "M3": 6.1}
    sweep = loads(small.text(base, small.axis("FZ", [-9.0, -5.0])), default_name="ends")
    swept = local(
        case_of_file.solve_case(StoredStudy(in_memory.outline(sweep)), {"FZ": -5.0}, sweep), observables=["height"]
    )
    assert float(swept["at"].sel(field="FZ")) == -5


def test_a_force_at_s_0_that_a_study_gives_holds_in_derivatives_and_fits(tmp_path, call) -> None:
    """FZ of a straight pipe is FZ0 - w L cos(hole) + f w L sin(hole)."""
    pipe = PIPE | {"L": 50.0, "weight": 0.241, "hole": "60deg", "beta0": 0.0, "betaL": 0.0, "FZ0": -20.0}
    text = small.text(pipe | {"friction": 0.25, "sliding": "axial-forward"}, "", "m kN", observables=["FZ0"])
    (tmp_path / "pipe.toml").write_text(text)
    rows = json.loads(call("sensitivity", tmp_path / "pipe.toml", "--show", "FZ", "--json")[1])["rows"]
    found = {row["field"]: row["derivative"] for row in rows}
    assert "FZ" not in found
    weight = 0.241 * 50
    by_hand = {"FZ0": 1.0, "friction": weight * np.sqrt(3) / 2, "weight": 50 * (np.sqrt(3) / 8 - 0.5)}
    assert {name: found[name] for name in by_hand} == pytest.approx(by_hand, rel=1e-6)
    goal = f"FZ={-20 + weight * (0.4 * np.sqrt(3) / 2 - 0.5)}"
    fitted = json.loads(call("fit", tmp_path / "pipe.toml", "--vary", "friction", "--target", goal, "--json")[1])
    assert fitted["values"] == pytest.approx({"friction": 0.4}, rel=1e-6)


# Saltelli's design


@pytest.mark.parametrize("method", ["saltelli", "saltelli-second-order"])
def test_the_design_is_that_of_salib(method: str) -> None:
    from SALib.sample.sobol import sample

    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0, 1]] * 3}
    second = method.endswith("order")
    theirs = sample(problem, 32, calc_second_order=second, seed=np.random.default_rng(5))
    np.testing.assert_array_equal(samples(method, 32, seed=5), theirs)
    assert design_of(theirs) == Design(3, 32, second)


# indices


def ishigami(x: Any) -> Any:
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def exact_ishigami() -> tuple[Any, Any, float]:
    """First-order and total indices, and that of the pair of x1 and x3 (Ishigami and Homma 1990), a = 7, b = 0.1."""
    a, b, pi = 7, 0.1, np.pi
    first, second = 0.5 * (1 + b * pi**4 / 5) ** 2, a**2 / 8
    both = b**2 * pi**8 * (1 / 18 - 1 / 50)
    whole = first + second + both
    return np.array([first, second, 0]) / whole, np.array([first + both, second, both]) / whole, both / whole


def test_the_indices_of_ishigami_are_the_exact_ones() -> None:
    first, total, pair = exact_ishigami()
    unit = samples("saltelli-second-order", 4096)
    found = analyse(design_of(unit), ishigami(np.pi * (2 * unit - 1))[:, None], list("abc"), ["ishigami"])  # type: ignore[arg-type]
    one = found.sel(observable="ishigami")
    for key, exact in (("first", first), ("total", total)):
        half = one[f"{key}_conf"].values
        assert (np.abs(one[key].values - exact) <= 1.5 * half).all(), key  # three standard errors
        assert half.max() < 0.05, key
    for other, exact in (("c", pair), ("b", 0.0)):
        found_pair, half = (float(one[key].sel(field="a", other=other)) for key in ("second", "second_conf"))
        assert abs(found_pair - exact) <= 1.5 * half < 0.15


@pytest.mark.slow
def test_the_intervals_contain_the_exact_indices_as_often_as_stated() -> None:
    first, total, _ = exact_ishigami()
    inside = []
    for seed in range(60):
        unit = np.random.default_rng(seed).random((256, 6))  # independent blocks, which the bootstrap assumes
        a, b = unit[:, None, :3], unit[:, None, 3:]
        points = np.concatenate([a, np.where(np.eye(3, dtype=bool), b, a), b], axis=1).reshape(-1, 3)
        found = analyse(Design(3, 256, False), ishigami(np.pi * (2 * points - 1))[:, None], list("abc"), ["y"])
        for key, exact in (("first", first), ("total", total)):
            off = np.abs(found[key].values[0] - exact)
            inside += (off <= found[f"{key}_conf"].values[0]).tolist()
    assert 0.88 <= np.mean(inside) <= 0.99


# stored studies


def test_failed_cells_of_a_file_are_left_out_with_their_blocks(stored: Path) -> None:
    ds = xr.open_dataset(stored).load()
    words = np.where(np.arange(160) == 7, "failed: for a test", "solved")
    ds = small.with_outcomes(ds, words)
    found = sobol(ds)
    assert found["blocks"].values.tolist() == [31, 31]
    assert found.attrs["unsolved"] == 1


def test_axes_beside_the_samples_are_held() -> None:
    axes = SAMPLES.replace("[sample.R]\nfrom = 0.7\nto = 0.8\n", "").replace("160", "128")
    ds = in_memory.run(small.study(f"{axes}[axes.R]\nvalues = [0.6, 0.75]", OBSERVED))
    here = sobol(ds, at={"R": 0.6})
    assert here.attrs["at R"] == 0.6
    np.testing.assert_array_equal(here["total"], sobol(ds.isel(R=[0]))["total"])
    with pytest.raises(InputError, match="sample is not held"):
        sobol(ds, at={"sample": 1})
    with pytest.raises(InputError, match="no observable 'heigth'"):
        sobol(ds, ["heigth"])


def test_without_salib_one_sentence_names_the_extra(stored: Path, monkeypatch, capsys) -> None:
    for name in [name for name in sys.modules if name.startswith("SALib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SALib", None)
    run(f"sensitivity {stored} --global", 2)
    said = capsys.readouterr().err
    assert "install the extra global" in said
    assert said.count("\n") == 1


def test_bars_of_influence_show_what_is_stored(stored: Path) -> None:
    found = sobol(xr.open_dataset(stored))
    exact = found.assign(first=abs(found["first"]), total=abs(found["first"]) + 0.1)
    tables = {names: local(solve(TABLE), observables=names.split()).assign_attrs(title="t", reading="") for names in
              ("height", "height turns_around")}  # fmt: skip
    pictures = {
        "indices": lambda: bars.indices(StoredStudy(exact)),
        "negative indices": lambda: bars.indices(StoredStudy(exact.assign(first=-exact["first"]))),
        "totals below those of first order": lambda: bars.indices(StoredStudy(exact.assign(total=exact["first"] / 2))),
        "a tornado": lambda: bars.tornado(StoredStudy(tables["height"])),
        "two, in a column": lambda: bars.tornado(StoredStudy(tables["height turns_around"]), sheet=sheet("paper", 89)),
        "two, on a page": lambda: bars.tornado(StoredStudy(tables["height turns_around"]), sheet=sheet("paper", 183)),
    }
    stored_figures.check("pictures_influence", pictures)
