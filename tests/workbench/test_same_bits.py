"""Every kind of study has the same bits in any chunks, by any workers, in memory, and where its run was stopped; and
each of its cases is the same however it is reached."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import solve
from tests.slow import slow_but
from tests.workbench import runs, small
from tests.workbench.study_kinds import QUICK, STUDIES, pipe_study
from workbench.run import block, in_memory, plan, shards, worker_processes
from workbench.run.run_and_resume import Meter, RunOptions, run_to_file
from workbench.stored import case_of_file, case_solving, quantity_variables
from workbench.stored.stored_study import StoredStudy

WAYS = {"cut": RunOptions(workers=1, chunk=1), "pool": RunOptions(workers=2, chunk=16)}

small_blocks = runs.small_blocks(16)


@pytest.fixture(scope="module")
def whole(small_blocks, tmp_path_factory) -> dict[str, Path]:
    """The file of each study, by one process in one go; made where it is first needed."""
    folder = tmp_path_factory.mktemp("whole")

    class Files(dict[str, Path]):
        def __missing__(self, name: str) -> Path:
            self[name] = folder / f"{name}.h5"
            run_to_file(STUDIES[name], self[name], RunOptions(workers=1, chunk=10_000))
            return self[name]

    return Files()


@pytest.mark.parametrize("way", slow_but(WAYS, "cut"))
@pytest.mark.parametrize("name", slow_but(STUDIES, *QUICK))
def test_every_bit_is_the_same_whatever_the_chunks_and_the_workers(whole, tmp_path, name: str, way: str) -> None:
    run_to_file(STUDIES[name], tmp_path / "one.h5", WAYS[way])
    assert runs.contents(tmp_path / "one.h5") == runs.contents(whole[name])
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


@pytest.mark.parametrize("name", slow_but(STUDIES, *QUICK))
def test_a_study_in_memory_has_the_bits_of_the_stored_one(whole, name: str) -> None:
    ds = in_memory.run(STUDIES[name])
    with xr.open_dataset(whole[name]) as stored:
        assert list(stored.dims) == list(ds.dims)
        xr.testing.assert_identical(stored.load().drop_attrs(deep=False), ds.drop_attrs(deep=False))
        assert {**ds.attrs, "created": ""}.items() <= {**stored.attrs, "created": ""}.items()


IN_ONE_BLOCK = ("sweep of a grid", "sweep by a rule", "samples between ends", "refined between ends")
STOPPED = [*((name, 1) for name in STUDIES if name not in IN_ONE_BLOCK), ("refined", 40), ("refined", 120)]


@pytest.mark.parametrize("stopped", slow_but(STOPPED, *((name, 1) for name in QUICK)))
def test_a_run_that_is_stopped_goes_on_to_the_same_bits(whole, tmp_path, stopped: tuple[str, int]) -> None:
    name, after = stopped
    path, expected = tmp_path / "one.h5", runs.contents(whole[name])
    with pytest.raises(KeyboardInterrupt, match="cases are kept in"):
        run_to_file(STUDIES[name], path, RunOptions(workers=1, chunk=8), progress=runs.stop_after(after))
    assert not path.exists()
    done = run_to_file(STUDIES[name], path, RunOptions(workers=1))
    assert 0 < done.solved < sum(done.statistics["outcomes"].values())
    assert runs.contents(path) == expected
    assert run_to_file(STUDIES[name], path).finished_before
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


@pytest.mark.parametrize(
    "name", slow_but(STUDIES, *QUICK, *(name for name in STUDIES if "ends" in name or "rule" in name))
)
def test_a_case_is_the_same_in_its_study_solved_again_and_alone(whole, name: str) -> None:
    study = STUDIES[name]
    with xr.open_dataset(whole[name]) as ds:
        bare, solved = ds.drop_vars(["beta", "z"], errors="ignore"), np.argwhere(ds["solved"].values)
        for place in solved[[0, len(solved) // 2, -1]]:
            here = dict(zip(ds["outcome"].dims, map(int, place), strict=True))
            one, at = ds.isel(here), {dim: float(ds[dim][i]) for dim, i in here.items()}
            fields = {field: float(one[quantity_variables.dimension(field)]) for field in study.variation.fields}
            rule, case = case_solving.rule_of(study.equilibrium), study.case_of(fields)
            file_or_study = ds if study.refine else in_memory.outline(study)
            for way in (
                bare.rod.beta.isel(here),
                bare.rod.sel(**at).rod.beta,
                ds.rod.at(**fields).beta,
                case_of_file.solve_case(StoredStudy(file_or_study), at, study).beta,
                solve(case, stations=study.stations, choose=rule).beta,
            ):
                np.testing.assert_allclose(way, one["beta"], atol=1e-12)


@pytest.mark.parametrize("name", slow_but(("grid", "samples between ends", "sweep"), "sweep"))
def test_parts_of_a_study_solved_in_two_places_have_the_bits_of_the_whole(tmp_path, monkeypatch, name: str) -> None:
    study, is_sweep = STUDIES[name], name == "sweep"
    monkeypatch.setattr(plan, "BLOCK_ALONE", 2)
    run_to_file(study, tmp_path / "whole.h5", RunOptions(workers=1))
    paths, meters = [tmp_path / place / "one.h5" for place in ("here", "there", *["elsewhere"] * is_sweep)], []
    if is_sweep:  # it has as many parts as cases
        assert len(paths) > -(-plan.plan(study).size // plan.plan(study).block)

    @contextmanager
    def watch(total: int, done: int) -> Iterator[Meter]:
        meters.append(Meter(total, done))
        yield meters[-1]

    for k, path in enumerate(paths, 1):
        path.parent.mkdir()
        ran = run_to_file(study, path, RunOptions(workers=1, part=(k, len(paths))), progress=watch)
        assert meters[-1].total == ran.solved, "the time that is left is that of the part"
        assert 0 < ran.solved < plan.plan(study).size
        assert ran.kept.startswith(f"{ran.solved} of ")
        assert not path.exists()
    here, *others = map(shards.folder_of, paths)
    for folder in others:
        shutil.copytree(folder, here, dirs_exist_ok=True)
    assert run_to_file(study, paths[0], RunOptions(workers=1)).solved == 0
    assert runs.contents(paths[0]) == runs.contents(tmp_path / "whole.h5")
    assert [path.name for path in paths[0].parent.iterdir()] == ["one.h5"]


IN_BLOCKS = ("grid", "samples", "samples between ends", "sweep")


@pytest.mark.parametrize("name", slow_but(IN_BLOCKS, "grid"))
def test_a_run_of_slow_cases_keeps_every_block_and_goes_on(whole, tmp_path, monkeypatch, name: str) -> None:
    study, path, options = STUDIES[name], tmp_path / "one.h5", RunOptions(workers=1, chunk=10_000)
    monkeypatch.setattr(plan, "BLOCK_ALONE", 2)
    run_to_file(study, tmp_path / "whole.h5", options)
    monkeypatch.setattr(block, "SECONDS", 0.0)  # as where each block takes longer
    size, cases = plan.plan(study).block, plan.plan(study).size
    assert size < cases, "a single block shows nothing"
    with pytest.raises(KeyboardInterrupt, match=f"{size} of {cases} cases are kept in"):
        run_to_file(study, path, options, progress=runs.stop_after(1))
    assert run_to_file(study, path, options).solved == cases - size
    assert runs.contents(path) == runs.contents(tmp_path / "whole.h5")


def test_what_a_worker_leaves_of_a_chunk_is_given_out_again(monkeypatch) -> None:
    monkeypatch.setattr(block, "SECONDS", 0.0)
    work = plan.plan(STUDIES["grid"])  # 39 cases in blocks of 16
    given: list[block.Chunk] = []

    def take() -> tuple[block.Chunk, tuple[int, bytes]]:
        chunk = given.pop(0)
        return chunk, block.solve_chunk(work.light, chunk, work.block)

    parts = worker_processes.hand_out(work, [work.chunk(0, 39)], lambda: 2 - len(given), given.append, take)
    assert [(part.start, part.stop) for part, _ in parts] == [(0, 16), (16, 32), (32, 39)]


FINER = {"sweep": pipe_study(small.axis("FZ", (-60.0, -40.0, 21))), "followed": STUDIES["followed in blocks"]}


@pytest.mark.parametrize("name", FINER)
def test_a_case_between_two_values_is_that_of_a_study_that_has_its_value(whole, name: str) -> None:
    finer = in_memory.run(FINER[name])
    with xr.open_dataset(whole[name]) as ds:
        for one in (finer.isel(FZ=k) for k in (3, 13, -2)):
            sol = ds.rod.at(FZ=float(one["FZ"]))
            assert bool(sol.solved) == bool(one["solved"])  # none beyond a fold
            np.testing.assert_allclose(sol.beta, one["beta"], atol=1e-12)
