"""From a study to a labelled dataset."""

import json

import numpy as np
import pytest
import xarray as xr

from solver import solve
from solver.methods import METHODS, Verlet, available
from solver.problem.trajectory import Trajectory
from studies.language.loader import loads
from tests.slow import slow
from tests.workbench import small
from workbench.store import dataset, in_memory, law_verdicts

SLOW_EULER = slow("euler")  # three seconds


def test_every_number_has_a_unit_and_everything_a_long_name() -> None:
    ds = small.six()
    for name, variable in ds.variables.items():
        assert "long_name" in variable.attrs, name
        assert ("units" in variable.attrs) == (variable.dtype.kind in "iuf"), name
    assert ds["E"].attrs["units"] == "N/cm^2"
    assert ds["F1_along"].attrs["units"] == "N"
    assert ds["turns"].attrs["units"] == "1"


def test_only_what_was_asked_for_is_stored() -> None:
    ds = in_memory.run(small.study(head='observables = ["wraps"]\noutputs = ["z"]'))
    always = {"solved", "outcome", "caution", "error", "condition", "R", "a", "L", "rho", "E", "nu", "FZ", "MZ", "M3"}
    assert set(ds.data_vars) == {"wraps", "wraps_error", "z"} | always


def test_what_is_needed_to_draw_is_there_and_varies_with_its_axis_only() -> None:
    ds = small.six()
    assert (ds["a"].item(), ds["L"].item(), ds["nu"].item()) == (0.25, 20.0, 0.25)
    assert ds["rho"].dims == ("R",)
    np.testing.assert_allclose(ds["rho"], ds["R"] + 0.25, rtol=1e-15)  # rounding
    assert (ds.attrs["side"], ds.attrs["stiffness"]) == ("outside", "paper")
    assert (ds.attrs["length_unit"], ds.attrs["force_unit"]) == ("cm", "N")


def test_arc_length_is_shared_unless_the_length_varies() -> None:
    assert small.six()["s"].dims == ("u",)
    varied = in_memory.run(small.study("[axes.L]\nvalues = [10, 20]"))
    assert varied["s"].dims == ("L", "u")
    assert varied["s"][:, -1].values.tolist() == [10.0, 20.0]


START = small.text(
    {"E": 1e4, "nu": 0.25, "a": 0.25, "L": 5.0, "R": 0.75, "beta": 0.5, "dbeta": 0.2, "M3": 1.0},
    small.axis("alpha", [0.1, 0.2]) + small.axis("gamma", [0.3, 0.4]),
    stations=5,
    outputs=["alpha", "gamma"],
)


def test_a_dimension_is_named_like_its_quantity_and_a_curve_keeps_its_name() -> None:
    curves = 'outputs = ["beta", "dbeta", "alpha", "gamma", "F1", "F3"]\n'
    plain = in_memory.run(small.study(head=curves))
    stored = {"beta", "dbeta", "alpha", "gamma", "F1_along", "F3_along"}
    assert stored <= set(plain.data_vars)
    for field, name, values in (("beta", "beta0", [0.25, 0.5]), ("dbeta", "dbeta0", [0.1, 0.5]),
                                ("F1", "F1", [2.0, 5.0]), ("E", "E", [1e4, 2e4])):  # fmt: skip
        ds = in_memory.run(small.study(f"[axes.{field}]\nvalues = {values}", curves))
        assert ds["outcome"].dims == (name,)
        assert ds[name].values.tolist() == values
        assert {str(key): ds[key].dims for key in stored} == dict.fromkeys(stored, (name, "u"))
    fixed = small.study("[axes.beta]\nvalues = [15, 30]\nunit = 'deg'")
    ds = in_memory.run(fixed)
    assert ds["beta0"].attrs["long_name"].startswith("angle from the axis at the start")
    # The shape starts where it is told, but for the rounding of the map to an orbit.
    np.testing.assert_allclose(ds["beta"][:, 0], ds["beta0"], rtol=1e-12)
    turned = in_memory.run(loads(START))
    assert turned["alpha"].dims == ("alpha0", "gamma0", "u")
    np.testing.assert_allclose(turned["alpha"][:, 0, 0], [0.1, 0.2], rtol=1e-12)


def test_an_axis_says_what_the_reading_makes_of_it() -> None:
    forces = small.study("[axes.F1]\nvalues = [2.5, 10]\n[axes.F3]\nvalues = [5, 20]")
    shear = in_memory.run(forces.under("shear/compression"))
    assert "in-surface shear" in shear["F1"].attrs["long_name"]
    assert "compression" in shear["F3"].attrs["long_name"]
    dropped = in_memory.run(forces.under("twist-first"))
    assert "no effect" in dropped["F1"].attrs["long_name"]
    assert bool((dropped["alpha"][0] == dropped["alpha"][1]).all())


def test_where_it_came_from_is_kept_as_attributes() -> None:
    study = small.grid()
    ds = in_memory.run(study.under("compression"), tol=1e-7, method="verlet")
    assert ds.attrs["study_name"] == "small"
    assert ds.attrs["reading"] == "force-first/compression/paper"
    assert (ds.attrs["tolerance"], ds.attrs["method"]) == (1e-7, "verlet")
    assert {"python", "numpy", "h5netcdf"} <= set(json.loads(ds.attrs["versions"]))
    assert not any(isinstance(value, bool | dict | None) for value in ds.attrs.values())


def test_a_case_that_fails_keeps_its_outcome_and_leaves_its_neighbours_alone(monkeypatch) -> None:
    class Failing(Verlet):
        def run(self, problem, t, tol) -> Trajectory:
            path = super().run(problem, t, tol)
            path.solved[2], path.outcome[2] = False, "failed: on purpose"
            return path

    monkeypatch.setitem(METHODS, "verlet", Failing)
    ds = in_memory.run(small.grid(), method="verlet")
    bad = ds.isel(E=0, R=2)
    assert bad["outcome"].item() == "failed: on purpose"
    assert np.isnan(bad["beta"]).all()
    assert np.isnan(bad["turns"])
    assert law_verdicts.unsolved(ds) == 1
    assert not np.isnan(ds["beta"]).where(ds["outcome"] == "solved").sum() > 0
    (row,) = law_verdicts.verdicts(ds)
    assert row["verdict"] == "not decided"
    assert "1 of 3 cases unsolved" in row["reason"]
    assert law_verdicts.status(1, law_verdicts.verdicts(ds)) == 1
    assert law_verdicts.status(1, []) == 1  # an unsolved case is enough


@pytest.mark.parametrize("method", [m if m != "euler" else SLOW_EULER for m in available()])
def test_it_is_told_whether_the_error_covers_the_observables(method: str) -> None:
    kind = "" if "start" in METHODS[method].problems else "[base]\nE = 1e4\nnu = 0.3\na = 0.2\nL = 5.0\nR = 1.0\n"
    text = small.HEAD if not kind else small.HEAD.replace('reading = "force-first/tension/paper"\n', "") + kind
    ends = "beta0 = 0.1\nbetaL = 0.2\n" if kind else ""
    study = loads(f'method = "{method}"\ntol = 0.1\n{text}{ends}')
    sol = solve(study.case(), method=method, tol=0.1)
    resolved = in_memory.run(study).attrs["observed"] == dataset.RESOLVED
    assert resolved == (sol.trajectory.orbit is not None)


def test_the_stored_text_says_with_which_stations_tolerance_and_method_the_study_was_run() -> None:
    written = small.study("[axes.E]\nvalues = [1e4, 2e4]\n")
    ds = in_memory.run(written.at_stations(31), tol=1e-5, method="dop853")
    again = loads(ds.attrs["study"])
    assert (again.stations, again.tol, again.method) == (31, 1e-5, "dop853")
    xr.testing.assert_equal(in_memory.run(again), ds)
    assert in_memory.run(written).attrs["study"] == written.text
