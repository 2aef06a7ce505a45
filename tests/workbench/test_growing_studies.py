"""A study that grows solves what is new, and keeps every bit of what is stored; another study is solved anew."""

from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr

from studies import Study
from tests.slow import slow_but
from tests.workbench import runs, small
from tests.workbench.study_kinds import pipe_study, refinement_study, sample_study, snapping, table_1
from workbench.run import dataset_assembly
from workbench.run.run_and_resume import RunOptions, run_to_file

FORCES = np.linspace(1, 9, 60)
small_blocks = runs.small_blocks(64)


class Row(NamedTuple):
    """A stored study and the one that is run then; whether it grows; whether its file has the bits of a run alone."""

    before: Study
    after: Study
    grows: bool = True
    same_bits: bool = True


def grid(E: Any, F1: Any = FORCES, more: str = "") -> Study:
    return table_1(small.axis("E", list(E)) + small.axis("F1", np.asarray(F1).tolist()) + more)


def wider(E: Any, F1: Any = FORCES) -> Row:
    """Two moduli and 60 forces that become more: among other neighbours the last bits are others."""
    return Row(grid([1e4, 3e4]), grid(E, F1), same_bits=False)


def formula(factor: int) -> Study:
    return table_1(f'[expressions]\nx = "{factor}*bends"\n' + small.axis("R", [0.5, 0.75]))


ROWS = {
    "at the end of the last axis": wider([1e4, 3e4], [*FORCES, 9.5, 10.0]),
    "before the first axis": wider([5e3, 1e4, 3e4]),
    "between, on both axes": wider([1e4, 2e4, 3e4], np.sort([*FORCES, 1.01, 5.005])),
    "in another order": wider([3e4, 4e4, 1e4], FORCES[::-1]),
    "its last digit off": wider([1e4 * (1 + 2e-16), 3e4, 4e4]),
    "a longer sequence of samples": Row(sample_study(40), sample_study(64)),
    "samples of another seed": Row(sample_study(8), sample_study(8, seed=4), grows=False),
    "a finer tolerance": Row(refinement_study(15), refinement_study(30)),
    "a larger budget": Row(refinement_study(budget=90), refinement_study(), same_bits=False),
    "a smaller budget": Row(refinement_study(), refinement_study(budget=90), grows=False),
    "another watched number": Row(refinement_study(), refinement_study(30, "loops"), grows=False),
    "a sweep": Row(*(pipe_study(small.axis("FZ", (-60.0, -40.0, count))) for count in (3, 5)), grows=False),
    "no longer followed": Row(snapping(3), snapping(3, follow=None), grows=False),
    "another formula of the same name": Row(formula(2), formula(3), grows=False),
}
QUICK = ("between, on both axes", "a longer sequence of samples", "another watched number", "a sweep",
         "no longer followed", "another formula of the same name")  # fmt: skip


def cases(ds: xr.Dataset) -> dict[tuple[float, ...], list[bytes]]:
    """The bits of all numbers of each case, by the values of its axes."""
    flat = ds.stack(case=ds["outcome"].dims)
    axes = [name for name in flat.coords if name not in ("case", "sample", "level") and flat[name].dims == ("case",)]
    numbers = [of.transpose("case", ...).values for of in flat.data_vars.values() if "case" in of.dims]
    places = zip(*(flat[name].values.tolist() for name in axes), strict=True)
    return {place: [row[i].tobytes() for row in numbers if row.dtype.kind in "iuf"] for i, place in enumerate(places)}


@pytest.mark.parametrize("name", slow_but(ROWS, *QUICK))
def test_what_is_new_is_solved_and_what_is_stored_is_kept_unless_the_study_is_another(
    name, tmp_path, monkeypatch
) -> None:
    row, path, alone = ROWS[name], tmp_path / "one.h5", tmp_path / "alone.h5"
    monkeypatch.setattr(dataset_assembly, "WINDOW", 20_000)  # bytes: many boxes, which begin inside blocks
    run_to_file(row.before, path, RunOptions(workers=1))
    with xr.open_dataset(path) as ds:
        old = cases(ds.load())
    solved = run_to_file(row.after, path, RunOptions(workers=1)).solved
    run_to_file(row.after, alone, RunOptions(workers=1))
    with xr.open_dataset(path) as ds, xr.open_dataset(alone) as fresh:
        new = cases(ds.load())
        assert len(new) == fresh["outcome"].size
        assert solved == len(new) - (len(old.keys() & new.keys()) if row.grows else 0)
        if row.grows:
            assert old.items() <= new.items()
        # other neighbours in a block, other rounding, and no more
        xr.testing.assert_allclose(ds.drop_vars("error"), fresh.drop_vars("error"), rtol=1e-6, atol=1e-9)
    assert not row.same_bits or runs.contents(path) == runs.contents(alone)
    assert run_to_file(row.after, path).finished_before
