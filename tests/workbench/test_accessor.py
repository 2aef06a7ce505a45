"""`ds.rod`: what was not stored is what would have been, whether it is computed or solved again."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (registers ds.rod)
from solver import InputError, solve
from solver.methods import METHODS, Verlet
from studies.language.loader import loads
from studies.language.study import OUTPUTS
from tests.slow import slow_but
from tests.workbench import small, study_kinds
from tests.workbench.command import output_of
from workbench.commands import options
from workbench.run import in_memory, writing
from workbench.stored import case_solving, quantity_variables, solved_again
from workbench.stored.stored_study import StoredStudy

ALL = f"outputs = {list(OUTPUTS)}"
AXES = "[axes.E]\nvalues = [1e4, 2e4]\n[axes.R]\nvalues = [0.5, 0.75, 1.0]\n"
FRAMES = ("tangent", "normal", "material_frame", "push")


def stored(tmp_path: Path, study, **how) -> xr.Dataset:
    """A study's dataset, through its file."""
    return xr.open_dataset(writing.write(in_memory.run(study), tmp_path / "small.h5", force=True), **how)


@pytest.fixture(scope="module")
def full() -> tuple[xr.Dataset, object]:
    """A grid of which everything is stored, and its solution."""
    study = small.study(AXES, ALL)
    return in_memory.run(study), solve(study.case(), stations=21)


@pytest.fixture(scope="module")
def turning() -> tuple[xr.Dataset, object]:
    """Rods with weight that turn in place against friction, with their places and angles alone, and their solution."""
    fields = {"weight": 0.1, "inclination": "90deg", "side": "inside", "friction": 0.3, "sliding": "rotating"}
    fields |= {**small.ROD, "beta0": 0.0, "betaL": 0.0, "FZ": -1.0, "M3": 0.2, "MZ": 0.2}
    kept = {"observables": ["height"], "outputs": ["alpha", "beta", "dbeta", "z", "gamma"], "stations": 11}
    study = loads(small.text(fields, small.axis("L", [10.0, 20.0]), **kept), "text", "t")
    return in_memory.run(study), solve(study.case(), stations=11)


@pytest.mark.parametrize("name", [*OUTPUTS, *FRAMES])
def test_every_array_is_the_solutions_own_from_what_is_stored(full, name: str) -> None:
    ds, sol = full
    kept = ds[["alpha", "beta", "dbeta", "z", "gamma", "outcome"]]
    found = kept.rod.along(name)
    # the same formulas on the same numbers, but the order of products
    np.testing.assert_allclose(found, getattr(sol, name), rtol=1e-12, atol=1e-12 * np.abs(found).max())
    assert found.dims[:3] == ("E", "R", "u")
    assert found.attrs["units"]
    assert found.attrs["long_name"]
    assert "_solved" not in vars(kept.rod), "it was solved again"


@pytest.mark.parametrize("name", [*OUTPUTS, *FRAMES])
def test_every_array_is_the_solutions_own_where_nothing_along_the_rod_is_stored(full, name: str) -> None:
    ds, sol = full
    kept = ds.drop_vars([*quantity_variables.CURVES, "xyz"])
    np.testing.assert_array_equal(getattr(kept.rod, name), getattr(sol, name))


@pytest.mark.parametrize("name", [*OUTPUTS, *FRAMES])
def test_every_array_of_a_rod_whose_loads_vary_is_the_solutions_own(turning, name: str) -> None:
    ds, sol = turning
    np.testing.assert_allclose(getattr(ds.rod, name), getattr(sol, name), rtol=1e-9, atol=1e-9)


def test_the_torque_of_rods_that_turn_in_place_is_stored_at_both_ends_and_solved_again_along_them(turning) -> None:
    ds, sol = turning
    torque = ds.rod.M3_along
    assert ds["solved"].all()
    np.testing.assert_allclose(torque, sol.M3_along, rtol=1e-9)
    np.testing.assert_allclose([ds["M30"], ds["M3"]], [torque[:, 0], torque[:, -1]], rtol=1e-9)
    assert (np.diff(torque) > 0).all()


def test_what_suffices_is_not_solved_and_what_does_not_is_solved_once(full, monkeypatch) -> None:

    ds, _ = full
    calls = []
    monkeypatch.setattr(solved_again, "solve_one", lambda *args: calls.append(args) or case_solving.solve_one(*args))
    kept = ds[["alpha", "beta", "z", "outcome"]]
    for name in ("position", "tangent", "normal", "FY", "F2", "F3", "M2"):
        kept.rod.along(name)
    assert calls == []
    for name in ("gamma", "F1", "contact"):
        kept.rod.along(name)
    assert len(calls) == 1


def test_what_all_rods_have_in_common_is_told_and_not_what_an_axis_changes(full) -> None:
    grid = full[0]
    told = StoredStudy(grid).common_values.split(", ")
    assert {"ν = 0.25", "L = 20 cm", "side = outside"} <= {*told}
    assert not [text for text in told if text.startswith(("E =", "R ="))]
    assert "R = 0.75 cm" in StoredStudy(grid.sel(R=0.75)).common_values.split(", ")
    assert StoredStudy(grid.assign_attrs(study="no study")).common_values == ""
    string = StoredStudy(study_kinds.well(friction=None, sizes=(1.0, 2.0)))
    assert "FZ" not in string.common_values  # the axis changes it, under another name
    assert "w = 0.241 kN/m" in string.common_values


def test_a_selection_is_rebuilt_by_itself(full) -> None:
    ds, sol = full
    one = ds[["alpha", "z", "outcome"]].rod.sel(E=2e4, R=0.75)
    assert one.rod.case.shape == ()
    assert (one.rod.case.rod.E, one.rod.case.cylinder.R) == (2e4, 0.75)
    np.testing.assert_allclose(one.rod.position, sol.position[1, 1], rtol=1e-14)
    np.testing.assert_allclose(
        one.rod.F1, sol.F1[1, 1], rtol=1e-6
    )  # solved alone, to the tolerance 1e-8 times condition
    half = ds[["alpha", "z", "outcome"]].rod.sel(R=slice(0.7, None))
    assert half.rod.case.shape == (2, 2)
    np.testing.assert_allclose(half.rod.position, sol.position[:, 1:], rtol=1e-14)
    tail = one.isel(u=slice(10, None))
    np.testing.assert_allclose(tail.rod.gamma, sol.gamma[1, 1, 10:], rtol=1e-6)
    end = one.isel(u=-1)
    np.testing.assert_allclose(end.rod.gamma, sol.gamma[1, 1, -1], rtol=1e-6)


def test_a_reading_that_replaced_the_studys_own_is_kept() -> None:
    study = small.study(AXES).under("compression")
    ds = in_memory.run(study)
    assert ds.rod.study.reading == "force-first/compression/paper"
    np.testing.assert_array_equal(ds.rod.case.given.F3, study.case().given.F3)


def test_a_neighbour_is_solved_as_the_study_was_on_its_axis_or_off_it(full) -> None:
    ds, sol = full
    there = ds.rod.at(E=2e4, R=1.0)
    assert (there.tol, there.method) == (sol.tol, sol.method)
    np.testing.assert_allclose(there.position, sol.position[1, 2], rtol=1e-6, atol=1e-6)  # alone, not among six
    between = ds.rod.at(E=1.5e4)
    assert between.position.shape == (3, 21, 3)
    np.testing.assert_array_equal(between.case.rod.E, 1.5e4)
    np.testing.assert_array_equal(between.case.cylinder.R, [0.5, 0.75, 1.0])
    other = ds.rod.at(E=2e4, R=1.0, L=10.0)  # a field that no axis varies
    np.testing.assert_array_equal(other.s[[0, -1]], [0.0, 10.0])


def test_values_are_found_to_nine_digits_and_refused_with_the_axis(full) -> None:
    ds, _ = full
    assert ds.rod.sel(E=2e4 * (1 + 1e-10))["E"] == 2e4
    assert ds.rod.sel(E=[2e4, 1e4])["E"].values.tolist() == [2e4, 1e4]


def test_an_axis_that_has_an_outputs_name_is_not_taken_for_it() -> None:
    ds = in_memory.run(small.study("[axes.beta]\nvalues = [0.4, 0.5]\n", 'outputs = ["beta", "dbeta"]'))
    sol = solve(small.study("[axes.beta]\nvalues = [0.4, 0.5]\n").case(), stations=21)
    np.testing.assert_array_equal(ds.rod.beta, sol.beta)
    np.testing.assert_allclose(ds.rod.kappa, sol.kappa, rtol=1e-14)
    assert "_solution" not in vars(ds.rod), "it was solved again"
    for name in ("beta", "beta0"):  # the study's field, and the dataset's dimension
        np.testing.assert_allclose(ds.rod.at(**{name: 0.4}).beta[0], 0.4, rtol=1e-15)  # rounding
        chosen = ds.rod.sel(**{name: 0.5})
        np.testing.assert_array_equal(chosen.rod.beta, sol.beta[1])
        assert ds.rod.place({name: "0.5"}) == {"beta0": 1}


def test_a_followed_equilibrium_is_followed_between_its_values_and_not_past_its_fold() -> None:
    axis = '[axes.betaL]\nfollow = true\nto = 60\ncount = 5\nunit = "deg"\n'
    ds = in_memory.run(small.study(axis, 'outputs = ["beta", "dbeta"]'))
    values = ds["betaL"].values
    middle = ds.rod.at(betaL=(values[1] + values[2]) / 2)
    assert middle.solved
    slopes = ds["dbeta0"].values
    assert slopes[1] < middle.dbeta[0] < slopes[2]
    np.testing.assert_allclose(
        ds.drop_vars("dbeta").rod.dbeta[2], ds["dbeta"][2], rtol=1e-5
    )  # the seed is the stored slope
    with pytest.raises(InputError, match="lies beyond the fold at"):
        ds.rod.at(betaL=values[-1] + 0.01)


@pytest.mark.filterwarnings("ignore:The specified chunks separate")  # on purpose: a block for each E
def test_arrays_stay_lazy_and_a_selection_reads_no_more_than_it_needs(tmp_path) -> None:
    dask = pytest.importorskip("dask.array")
    with stored(tmp_path, small.study(AXES, 'outputs = ["beta", "dbeta", "alpha", "z"]'), chunks={"E": 1}) as ds:
        for name in ("position", "tangent", "F1", "contact", "h"):
            lazy = getattr(ds.rod, name)
            assert isinstance(lazy.data, dask.Array), name
            assert lazy.data.numblocks[0] == 2, name
        sol = solve(ds.rod.case, stations=21)
        np.testing.assert_allclose(ds.rod.position, sol.position, rtol=1e-12, atol=1e-12)  # the order of products
        one = ds.rod.sel(E=2e4).rod.contact
        np.testing.assert_allclose(one, sol.contact[1], rtol=1e-9)
        assert not any(variable._in_memory for name, variable in ds.variables.items() if variable.ndim > 1)


@pytest.mark.slow
def test_unsolved_cases_stay_nan_when_they_are_solved_again(monkeypatch) -> None:
    class Failing(Verlet):
        def run(self, problem, t, tol):
            path = super().run(problem, t, tol)
            path.solved[1], path.outcome[1] = False, "failed: on purpose"
            return path

    monkeypatch.setitem(METHODS, "verlet", Failing)
    ds = in_memory.run(small.study("[axes.E]\nvalues = [1e4, 2e4]\n", 'method = "verlet"\noutputs = ["beta"]'))
    assert np.isnan(ds.rod.z[1]).all()
    assert np.isfinite(ds.rod.z[0]).all()


def test_the_curve_of_several_cases_is_refused_in_a_sentence(full) -> None:
    with pytest.raises(InputError, match="the dataset has 6: choose one"):
        _ = full[0].rod.centreline
    assert full[0].rod.sel(E=2e4, R=0.75).rod.centreline.rho == full[0].rod.sel(R=0.75)["rho"]


def test_what_would_take_too_long_is_refused(full, monkeypatch) -> None:

    monkeypatch.setattr(solved_again, "MOST_SOLVED", 5)
    kept = full[0][["alpha", "outcome"]]
    with pytest.raises(
        InputError, match=r"6 cases would have to be solved again, more than 5; select some first, as ds.rod.sel\(E="
    ):
        _ = kept.rod.F1
    assert kept.rod.sel(E=1e4).rod.F1.shape == (3, 21)


def test_an_accessor_of_no_study_lists_its_names_and_has_no_others() -> None:
    ds = xr.Dataset({"x": ("u", [1.0])})
    assert "position" in dir(ds.rod)
    with pytest.raises(AttributeError, match=r"ds.rod has no 'shape'"):
        _ = ds.rod.shape


IMPORTS = {"accessor first": "import workbench.accessor, xarray", "xarray first": "import xarray, workbench.accessor"}


@pytest.mark.parametrize("order", slow_but(IMPORTS, "accessor first"))
def test_importing_the_accessor_registers_it_and_loads_no_solver(order: str) -> None:
    assert output_of(f"{IMPORTS[order]}; print(xarray.Dataset.rod.__name__, 'solver' in sys.modules)") == [
        "rod",
        "False",
    ]


def test_importing_the_workbench_alone_loads_nothing_heavy_and_changes_no_import() -> None:
    code = "before = list(sys.meta_path); import workbench; print(sys.meta_path == before, 'numpy' in sys.modules)"
    assert output_of(code) == ["True", "False"]


@pytest.mark.parametrize(
    "said, index",
    [(2e4, 1), (2e4 * (1 + 1e-10), 1), ("2e4", 1), ("19999", 1), ("20010", None), (20001.0, None), (1.5e4, None)],
)
def test_every_part_of_the_workbench_means_the_same_value_of_an_axis(full, said, index) -> None:
    ds = full[0].assign_coords(E=("E", [1e4, 19999.0 if said == "19999" else 2e4], full[0]["E"].attrs))
    stored = None if index is None else float(ds["E"][index])

    def found(choose) -> float | None:
        if index is not None:
            return choose()
        with pytest.raises(InputError, match="is not on the axis; its values are 10000, "):
            choose()
        return None

    assert found(lambda: float(ds.rod.sel(E=said)["E"])) == stored
    assert found(lambda: float(ds["E"][ds.rod.place({"E": said})["E"]])) == stored
    assert found(lambda: float(ds["E"][ds.rod.places("R", {"E": said})[0]["E"]])) == stored
    if isinstance(said, str):
        assert found(lambda: options.axis_values(StoredStudy(ds), [f"E={said}"])["E"]) == stored
