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
from workbench.run import in_memory
from workbench.stored import empty_dataset, stored_verdicts
from workbench.stored.stored_study import StoredStudy

SLOW_EULER = slow("euler")  # three seconds


def test_where_it_came_from_is_kept_as_attributes() -> None:
    study = small.grid()
    ds = in_memory.run(study.under("compression").with_values(tol=1e-7, method="verlet"))
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
    ds = in_memory.run(small.grid().with_values(method="verlet"))
    bad = ds.isel(E=0, R=2)
    assert bad["outcome"].item() == "failed: on purpose"
    assert np.isnan(bad["beta"]).all()
    assert np.isnan(bad["bends"])
    assert StoredStudy(ds).unsolved == 1
    assert not np.isnan(ds["beta"]).where(ds["outcome"] == "solved").sum() > 0
    (row,) = stored_verdicts.verdicts(ds)
    assert row["verdict"] == "not decided"
    assert "1 of 3 cases has no value" in row["reason"]
    assert stored_verdicts.status(1, stored_verdicts.verdicts(ds)) == 1
    assert stored_verdicts.status(1, []) == 1  # an unsolved case is enough


@pytest.mark.parametrize("method", [m if m != "euler" else SLOW_EULER for m in available()])
def test_it_is_told_whether_the_error_covers_the_observables(method: str) -> None:
    kind = "" if "start" in METHODS[method].problems else "[base]\nE = 1e4\nnu = 0.3\na = 0.2\nL = 5.0\nR = 1.0\n"
    text = small.HEAD if not kind else small.HEAD.replace('reading = "force-first/tension/paper"\n', "") + kind
    ends = "beta0 = 0.1\nbetaL = 0.2\n" if kind else ""
    study = loads(f'method = "{method}"\ntol = 0.1\n{text}{ends}')
    sol = solve(study.case(), method=method, tol=0.1)
    resolved = in_memory.run(study).attrs["observed"] == empty_dataset.RESOLVED
    assert resolved == (sol.trajectory.orbit is not None)


def test_the_stored_text_says_with_which_stations_tolerance_and_method_the_study_was_run() -> None:
    written = small.study("[axes.E]\nvalues = [1e4, 2e4]\n")
    ds = in_memory.run(written.at_stations(31).with_values(tol=1e-5, method="dop853"))
    again = loads(ds.attrs["study"])
    assert (again.stations, again.tol, again.method) == (31, 1e-5, "dop853")
    xr.testing.assert_equal(in_memory.run(again), ds)
    assert in_memory.run(written).attrs["study"] == written.text
