"""The same study on a Dask cluster that is started as the docs say."""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import xarray as xr

from solver import InputError
from studies import load
from tests.workbench import runs, small
from tests.workbench.test_faults import DEADLY, GRID, SMALL, TELLING, whole  # noqa: F401  (a fixture)
from tests.workbench.waiting import until
from workbench.run import cluster, plan, recipe, worker_processes
from workbench.run.run_and_resume import RunOptions, run_to_file

distributed = pytest.importorskip("distributed")

REFINED = '[axes.E]\nvalues = [5e3, 1e4, 4e4]\n[refine]\nwatch = ["bends"]\ntolerance = 1e-3\n'
AXES = "".join(small.axis(name, values) for name, values in GRID.items())
SAMPLES = "[sample]\nsize = 150\n[sample.E]\nfrom = 5e3\nto = 4e4\n[sample.F1]\nfrom = 1.0\nto = 9.0\n"


def test_a_scheduler_that_is_not_there_is_told_in_one_sentence(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", 0.3)
    with pytest.raises(InputError, match=r"^no Dask scheduler answers at tcp://127\.0\.0\.1:9: [^\n]*$"):
        run_to_file(load(runs.study(tmp_path, GRID)), tmp_path / "many.h5", RunOptions(scheduler="tcp://127.0.0.1:9"))


class Cluster:
    """A scheduler and one `dask worker` of two processes, on loopback; both end with the test."""

    def __init__(self, folder: Path, before: str = SMALL) -> None:
        self.file = folder / "scheduler.json"
        (folder / "before.py").write_text(before)
        self._env = {**os.environ, "PYTHONPATH": str(runs.ROOT), "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
        self._folder = folder
        at = ("--host", "127.0.0.1", "--scheduler-file", self.file, "--no-dashboard")
        self._started = [self._start("scheduler", *at, "--port", "0")]
        self._started += [self._start("worker", *at, "--nworkers", 2, "--nthreads", 1, "--preload", "before.py")]
        until(self.file.exists)
        with distributed.Client(scheduler_file=str(self.file), set_as_default=False) as client:
            client.wait_for_workers(2, timeout=600)
            self.address = client.scheduler.address

    def _start(self, *words: object) -> subprocess.Popen[bytes]:
        log = (self._folder / f"{words[0]}.log").open("wb")
        command = [sys.executable, "-m", "dask", *map(str, words)]
        return subprocess.Popen(command, cwd=self._folder, env=self._env, stdout=log, stderr=log)

    def stop(self) -> None:
        for process in reversed(self._started):
            process.terminate()
        for process in self._started:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


@pytest.fixture
def clusters(tmp_path) -> Iterator[list[Cluster]]:
    """Those that a test started."""
    started: list[Cluster] = []
    yield started
    for one in started:
        one.stop()


def folder(tmp_path: Path) -> Path:
    """One for the cluster, which leaves what it likes."""
    made = tmp_path / "cluster"
    made.mkdir()
    return made


def test_what_goes_wrong_in_a_worker_can_be_sent(monkeypatch, tmp_path) -> None:
    work = plan.plan(load(runs.study(tmp_path, runs.grid(2, 2))))

    class Unsendable(Exception):
        def __init__(self) -> None:
            super().__init__(lambda: None)

    def broken(*args: object) -> bytes:
        raise Unsendable

    monkeypatch.setattr(cluster, "solve_chunk", broken)
    with pytest.raises(RuntimeError, match="Unsendable") as caught:
        cluster._solve(work.light, work.chunk(0, 4), work.block, recipe.code_version())
    assert "Unsendable" in str(pickle.loads(pickle.dumps(caught.value)))


@pytest.mark.slow
@pytest.mark.parametrize("more", (AXES, SAMPLES, REFINED), ids=("grid", "samples", "refined"))
def test_a_study_on_a_cluster_has_the_bits_of_this_machine_alone(tmp_path, clusters, more: str) -> None:
    clusters.append(Cluster(folder(tmp_path)))
    (tmp_path / "many.toml").write_text(runs.HEAD.format(method="orbit") + more)
    for name, options in (("alone.h5", ()), ("many.h5", ("--scheduler", clusters[0].address, "--chunk", 32))):
        done = runs.run(tmp_path, "many.toml", "--out", name, *options, before=SMALL)
        assert done.returncode == 0, done.stderr
    assert runs.contents(tmp_path / "many.h5") == runs.contents(tmp_path / "alone.h5")


@pytest.mark.slow
def test_a_worker_of_the_cluster_that_is_killed_costs_a_chunk(whole, tmp_path, clusters) -> None:  # noqa: F811
    clusters.append(Cluster(folder(tmp_path), TELLING))
    runs.study(tmp_path, GRID)
    args = ("many.toml", "--scheduler", clusters[0].address, "--chunk", 48)
    with runs.start(tmp_path, *args, before=SMALL) as process:
        told = tmp_path / "cluster" / "worker"
        until(told.exists)
        os.kill(int(told.read_text()), signal.SIGKILL)
        out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    assert "150 cases, 0 unsolved" in out
    assert runs.contents(tmp_path / "many.h5") == whole


@pytest.mark.slow
def test_a_chunk_that_kills_the_clusters_workers_is_recorded_as_failed(tmp_path, clusters) -> None:
    clusters.append(Cluster(folder(tmp_path), DEADLY))
    runs.study(tmp_path, GRID)
    args = ("many.toml", "--scheduler", clusters[0].address, "--chunk", 48)
    done = runs.run(tmp_path, *args, before=SMALL)
    assert done.returncode == 1, done.stderr
    with xr.open_dataset(tmp_path / "many.h5") as ds:
        failed = (ds["outcome"] == worker_processes.KILLED).values.ravel()
        assert failed.nonzero()[0].tolist() == list(range(48, 64))


@pytest.mark.slow
def test_a_scheduler_that_goes_away_leaves_what_is_finished(whole, tmp_path, clusters) -> None:  # noqa: F811
    clusters.append(Cluster(folder(tmp_path), TELLING))
    runs.study(tmp_path, GRID)
    args = ("many.toml", "--scheduler", clusters[0].address, "--chunk", 16)
    with runs.start(tmp_path, *args, before=SMALL) as process:
        told = tmp_path / "cluster" / "worker"
        until(lambda: told.exists() and len(list(tmp_path.glob("many.h5.parts/*.shard"))) >= 4)
        clusters.pop().stop()
        _, err = process.communicate(timeout=600)
    assert process.returncode == 2
    assert "cannot write many.h5: the Dask scheduler no longer answers; finished cases are kept; run the same" in err
    done = runs.run(tmp_path, "many.toml", before=SMALL)
    assert " kept from an earlier run" in done.stdout
    assert runs.contents(tmp_path / "many.h5") == whole
