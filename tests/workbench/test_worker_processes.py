"""The processes of a pool: what they are copies of, and what they do with memory."""

import os
import sys
from pathlib import Path

import pytest

from studies import load
from tests.workbench import runs
from tests.workbench.command import output_of
from workbench.run import block, plan, worker_processes

linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc, and copies are made on Linux only")
BASE = """
[base]
nu = 0.25
a = 0.25
L = 20.0
R = 0.75
beta = 0.5
dbeta = 0.5
F3 = 10.0
"""


def parent(pid: int | None) -> int:
    """The process that started that one."""
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def of_no_paper(path: Path) -> Path:
    """The study in that file with a rod of its own, so that it needs no tenant."""
    text = path.read_text().replace('reading = "force-first/tension/paper"\n', "")
    path.write_text(text + BASE)
    return path


@pytest.mark.slow
@linux
def test_what_workers_are_copies_of_has_one_thread_so_that_copying_is_safe() -> None:
    code = "import os, workbench.run.preload; print(len(os.listdir('/proc/self/task')))"
    assert output_of(code, **dict.fromkeys(worker_processes.ONE_THREAD, "1")) == ["1"]


@linux
def test_what_workers_are_copies_of_has_read_all_that_a_block_needs(tmp_path) -> None:
    path = of_no_paper(runs.study(tmp_path, runs.grid(2, 2), method="auto"))
    code = f"""
import sys, workbench.run.preload
from pathlib import Path
from studies import load
from workbench.run import block, plan
before = set(sys.modules)
work = plan.plan(load({str(path)!r}))
block.solve_chunk(work.light, work.chunk(0, 4), work.block)
print("read", *sorted(set(sys.modules) - before))
"""
    assert output_of(code) == ["read"]


@linux
def test_workers_are_copies_of_one_process_and_solve_what_this_one_would(tmp_path) -> None:
    work = plan.plan(load(str(of_no_paper(runs.study(tmp_path, runs.grid(2, 3))))))
    workers = [worker_processes.Worker() for _ in range(2)]
    try:
        for worker in workers:
            worker.call(os.getpid)
            assert worker.answer() == worker.process.pid
        parents = {parent(worker.process.pid) for worker in workers}
        assert len(parents) == 1
        assert os.getpid() not in parents
        for worker, (a, b) in zip(workers, [(0, 2), (2, 6)], strict=True):
            worker.call(block.solve_chunk, work.light, work.chunk(a, b), 2)
            assert worker.answer() == block.solve_chunk(work.light, work.chunk(a, b), 2)
    finally:
        for worker in workers:
            worker.stop()


@linux
def test_a_worker_whose_model_ends_is_told_in_one_sentence_and_not_taken_for_an_interruption(tmp_path) -> None:
    (tmp_path / "deadly.py").write_text("import os\nos._exit(1)\n")
    code = """
from solver import InputError
from workbench.run import worker_processes
worker_processes.PRELOAD = "deadly"
try:
    worker_processes.Worker()
except InputError as error:
    print(str(error).replace(" ", "_"))
"""
    path = os.pathsep.join([str(tmp_path), str(runs.ROOT)])
    assert output_of(code, PYTHONPATH=path) == [
        "a_worker_process_cannot_start:_the_process_from_which_it_is_forked_has_ended"
    ]


@linux
def test_a_process_that_keeps_memory_does_not_fetch_it_anew_for_every_array() -> None:
    code = """
import resource
import numpy as np
from workbench.run import worker_processes
if {keep}:
    worker_processes.keep_memory()
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
np.ones(2**20)
before = faults()
for _ in range(50):
    np.ones(2**20)
print(faults() - before)
"""
    # as Dask starts its workers: nothing is kept. 50 arrays of 8 MB in pages of 4 kB, or in larger ones
    as_dask = {"MALLOC_TRIM_THRESHOLD_": "65536"}
    (kept,) = output_of(code.format(keep=True), **as_dask)
    (fetched,) = output_of(code.format(keep=False), **as_dask)
    if int(fetched) < 200:
        pytest.skip("this C library keeps memory by itself")
    assert int(kept) < int(fetched) / 10  # one of the fifty would be a fiftieth
