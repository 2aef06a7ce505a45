"""What a run survives: kill -9 of itself and of its workers, Ctrl-C, a full disk, a second run on the same output."""

import json
import os
import random
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
import xarray as xr

from solver import InputError
from studies import load
from tests.slow import slow
from tests.workbench import runs, small
from tests.workbench.waiting import alive, until
from workbench.commands import console
from workbench.run import recipe, run_and_resume, shards, worker_processes

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")

GRID = runs.grid(3, 50)  # 150 cases
SMALL = "from workbench.run import plan; plan.BLOCK = 16\n"  # ten blocks of them

# A run that takes its time: at each block, and wherever a file is put on the disk.
SLOW = (
    SMALL
    + """
import os, time
from workbench.run import block
block_of, fsync = block.block_of, os.fsync
def slowly(study, part):
    time.sleep(0.03)
    return block_of(study, part)
def slow_disk(handle):
    time.sleep(0.01)
    return fsync(handle)
block.block_of, os.fsync = slowly, slow_disk
"""
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> dict[str, bytes]:
    """What an uninterrupted run stores."""
    folder = tmp_path_factory.mktemp("whole")
    done = runs.run(folder, runs.study(folder, GRID), "--workers", 1, before=SMALL)
    assert done.returncode == 0, done.stderr
    return runs.contents(folder / "many.h5")


def begun(process: subprocess.Popen[str]) -> None:
    """Wait until a run has told its size: then it is at work."""
    assert process.stdout is not None
    line = process.stdout.readline()
    assert "cases" in line, line + (process.stderr.read() if process.stderr else "")


def finished(folder: Path, whole: dict[str, bytes], *args: object) -> str:
    """Run to the end, and nothing is there but the output, as if nothing had happened."""
    done = runs.run(folder, "many.toml", *args, before=SMALL)
    assert done.returncode == 0, done.stderr
    assert runs.contents(folder / "many.h5") == whole
    assert {path.name for path in folder.iterdir()} == {"many.toml", "many.h5", "main.py"}
    return done.stdout


def killed_and_finished(folder: Path, whole: dict[str, bytes], times: int, seed: int) -> int:
    """Kill the run at so many random moments, then let it end; how many kills met it at work."""
    chance = random.Random(seed)
    runs.study(folder, GRID)
    met = 0
    for _ in range(times):
        process = runs.start(folder, "many.toml", "--chunk", 1, "--workers", chance.choice([1, 1, 2]), before=SLOW)
        begun(process)
        time.sleep(chance.uniform(0, 0.5))
        met += process.poll() is None
        process.kill()
        process.communicate()
    finished(folder, whole)
    return met


@pytest.mark.slow
def test_a_run_killed_at_twenty_random_moments_ends_with_every_bit_of_one_that_was_not(whole, tmp_path) -> None:
    met = 0
    for seed in range(4):
        folder = tmp_path / str(seed)
        folder.mkdir()
        met += killed_and_finished(folder, whole, 5, seed)
    assert met > 10


WAYS = {
    "while the file is assembled": ("workbench.run.writing._create", []),
    "while the parts are removed": ("pathlib.Path.rmdir", [pytest.mark.slow]),
    "while a shard is renamed": ("os.replace", [pytest.mark.slow]),
    "while a shard is put on the disk": ("os.fsync", [pytest.mark.slow]),
}


@pytest.mark.parametrize("where", [pytest.param(at, id=name, marks=marks) for name, (at, marks) in WAYS.items()])
def test_a_run_killed(where, whole, tmp_path) -> None:
    module, name = where.rsplit(".", 1)
    owner, _, kind = module.rpartition(".") if module == "pathlib.Path" else (module, "", "")
    target = f"__import__('importlib').import_module({owner!r})" + (f".{kind}" if kind else "")
    dies = f"import os, signal\nsetattr({target}, {name!r}, lambda *args: os.kill(os.getpid(), signal.SIGKILL))\n"
    runs.study(tmp_path, GRID)
    killed = runs.run(tmp_path, "many.toml", "--workers", 1, "--chunk", 32, before=SMALL + dies)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    finished(tmp_path, whole)


# workers

TELLING = (
    SMALL
    + """
import os, time
from pathlib import Path
from workbench.run import block
def telling(study, part, block_of=block.block_of):
    if part.start == 32 and not Path("worker").exists():
        Path("worker.part").write_text(str(os.getpid()))
        os.replace("worker.part", "worker")
        time.sleep(60)
    return block_of(study, part)
block.block_of = telling
"""
)


def awaited(path: Path, process: subprocess.Popen[str]) -> str:
    """What the file says once it is there."""

    def is_there() -> bool:
        assert process.poll() is None, process.communicate()
        return path.exists()

    until(is_there)
    return path.read_text()


def test_a_worker_that_is_killed_costs_a_chunk_which_is_solved_again(whole, tmp_path) -> None:
    runs.study(tmp_path, GRID)
    with runs.start(tmp_path, "many.toml", "--workers", 2, "--chunk", 48, before=TELLING) as process:
        worker = int(awaited(tmp_path / "worker", process))
        assert worker != process.pid
        os.kill(worker, signal.SIGKILL)
        out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    assert re.sub(r"^\d+ of 150 cases.*\n", "", err, flags=re.MULTILINE) == ""  # how far it was every 5 s
    assert "150 cases, 0 unsolved" in out
    assert runs.contents(tmp_path / "many.h5") == whole


KILLED = f"{worker_processes.KILLED} (it was killed by SIGKILL)"
DEADLY = (
    SMALL
    + """
import os, signal
from workbench.run import block
def deadly(study, part, block_of=block.block_of):
    with open("deaths", "a") as file:
        if (part.values["F1"] == 9.0).any() and (part.values["E"] == 5e3).any():
            file.write("x")
            file.flush()
            os.kill(os.getpid(), signal.SIGKILL)
    return block_of(study, part)
block.block_of = deadly
"""
)


@pytest.mark.slow
def test_a_chunk_that_kills_workers_twice_is_recorded_as_failed_case_by_case(tmp_path) -> None:
    runs.study(tmp_path, GRID)
    done = runs.run(tmp_path, "many.toml", "--workers", 2, "--chunk", 48, before=DEADLY)
    assert done.returncode == 1, done.stderr
    assert (tmp_path / "deaths").read_text() == "xx"
    assert f"150 cases, 16 unsolved\n  16 x {KILLED}" in done.stdout
    with xr.open_dataset(tmp_path / "many.h5") as ds:
        failed = (ds["outcome"] == KILLED).values.ravel()
        assert failed.nonzero()[0].tolist() == list(range(48, 64))  # the block of the deadly case, and no more
        assert ds["kappa_max"].isnull().values.ravel().tolist() == failed.tolist()
        assert ds["beta"].isnull().any("u").values.ravel().tolist() == failed.tolist()


def test_workers_that_cannot_start_are_told_in_one_sentence(tmp_path) -> None:
    before = "import os\nif __name__ != '__main__':\n    os._exit(3)\n"
    runs.study(tmp_path, GRID)
    done = runs.run(tmp_path, "many.toml", "--workers", 2, before=before)
    assert (done.returncode, done.stderr) == (2, "workbench: a worker process cannot start: it ended with status 3\n")
    assert {path.name for path in tmp_path.iterdir()} == {"many.toml", "main.py"}


def test_a_worker_of_other_code_or_without_the_method_is_refused() -> None:
    study = load("fig6")
    recipe.check_worker(study.model_copy(update={"method": "orbit"}), recipe.code_version())
    with pytest.raises(InputError, match=r"a worker has the code .*, but the run was started with older"):
        recipe.check_worker(study, "older")
    with pytest.raises(InputError, match="a worker has no method 'swirl': install there what is installed here"):
        recipe.check_worker(study.model_copy(update={"method": "swirl"}), recipe.code_version())


# Ctrl-C


@pytest.mark.parametrize("workers", [slow(1), slow(2)])
def test_ctrl_c_says_how_to_go_on_and_leaves_no_process(workers, whole, tmp_path) -> None:
    runs.study(tmp_path, GRID)
    before = TELLING.replace("part.start == 32", "part.start == 80") + (
        "if __name__ == '__main__':\n"
        "    import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # ignored in the background
    )
    args = ("many.toml", "--workers", workers, "--chunk", 16)
    with runs.start(tmp_path, *args, before=before, start_new_session=True) as process:
        worker = int(awaited(tmp_path / "worker", process))
        time.sleep(0.3)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all
        _, err = process.communicate(timeout=600)
    assert process.returncode == 130, err
    way = r"(\d+) of 150 cases are kept in many\.h5\.parts; run the same command again to continue"
    said = re.fullmatch(rf"workbench: interrupted; {way}\n", err)
    assert said, err
    assert not alive(worker)
    assert not (tmp_path / "many.h5").exists()
    (tmp_path / "worker").unlink()
    assert f", {said.group(1)} kept from an earlier run" in finished(tmp_path, whole)


# the disk

# without bytecode: Python would replace that of a library by as much of it as has room
LIMITED = SMALL + (
    "import resource, sys; sys.dont_write_bytecode = True\n"
    "resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))\n"
)


NO_ROOM = [pytest.param(1_000, 0, id="for a shard", marks=pytest.mark.slow), pytest.param(20_000, 5, id="for the file")]


@pytest.mark.parametrize("size, kept", NO_ROOM)
def test_a_disk_that_fills_is_told_and_what_is_finished_is_kept(size, kept, whole, tmp_path) -> None:
    runs.study(tmp_path, GRID)
    done = runs.run(tmp_path, "many.toml", "--workers", 1, "--chunk", 32, before=LIMITED.format(size=size))
    assert done.returncode == 2, done.stderr
    told = "; finished cases are kept; run the same command again to continue" * bool(kept)
    assert re.fullmatch(rf"workbench: cannot write many\.h5: [^;]*{told}\n", done.stderr)
    assert len(list(tmp_path.glob("many.h5.parts/*.shard"))) == kept
    assert not list(tmp_path.glob("many.h5.parts/.*"))
    assert not (tmp_path / "many.h5").exists()
    finished(tmp_path, whole)


@pytest.mark.parametrize("make", [Path.touch, lambda parts: parts.symlink_to("nowhere")], ids=["file", "link"])
def test_what_stands_where_a_run_keeps_its_cases_is_named_and_stays(make, tmp_path) -> None:
    parts = tmp_path / "study.h5.parts"
    make(parts)
    words = "study.h5.parts is no folder, and a run keeps its finished cases in one of that name: rename or remove it"
    with pytest.raises(InputError, match=words):
        run_and_resume.run_to_file(small.study(), tmp_path / "study.h5")
    assert [*tmp_path.iterdir()] == [parts]


def test_a_run_that_cannot_begin_promises_no_cases(tmp_path, monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(run_and_resume, "_run", refuse)
    with pytest.raises(InputError, match=r"cannot write \S+study.h5: Permission denied$"):
        run_and_resume.run_to_file(small.study(), tmp_path / "study.h5")


def test_a_merge_on_a_full_disk_says_so_and_leaves_nothing(tmp_path) -> None:
    for name, E in (("a", [1e4, 2e4]), ("b", [3e4])):
        runs.run(tmp_path, runs.study(tmp_path, {"E": E}), "--out", f"{name}.h5", before=SMALL)
    before = {path.name for path in tmp_path.iterdir()}
    done = runs.command(tmp_path, "merge", "a.h5", "b.h5", "--out", "c.h5", before=LIMITED.format(size=5_000))
    assert (done.returncode, done.stdout) == (2, ""), done.stderr
    assert re.fullmatch(r"workbench: cannot write c\.h5: .*\n", done.stderr)
    assert {path.name for path in tmp_path.iterdir()} == before


def test_a_folder_that_cannot_be_written_is_refused_before_any_work(tmp_path) -> None:
    place = Path("/proc/self") if os.geteuid() == 0 else tmp_path / "closed"  # root may write into any other
    if place.parent == tmp_path:
        place.mkdir(mode=0o555)
    done = runs.run(tmp_path, runs.study(tmp_path, GRID), "--out", place / "many.h5", before=SMALL)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith(f"workbench: cannot write into the folder {place}: ")


# two at once


def test_of_two_runs_on_one_output_the_second_refuses_until_the_first_is_gone(whole, tmp_path) -> None:
    runs.study(tmp_path, GRID)
    with runs.start(tmp_path, "many.toml", "--workers", 1, "--chunk", 16, before=TELLING) as first:
        awaited(tmp_path / "worker", first)
        before = {path.name for path in (tmp_path / "many.h5.parts").iterdir()}
        runs.run(tmp_path, "many.toml")  # asked twice, it says so twice
        second = runs.run(tmp_path, "many.toml")
        assert second.returncode == 2
        said = (
            rf"workbench: another run is at work on many\.h5 \(process {first.pid} on \S+, since 20\S+ [\d:]{{8}}\)\n"
        )
        assert re.fullmatch(said, second.stderr), second.stderr
        assert {path.name for path in (tmp_path / "many.h5.parts").iterdir()} == before
        first.kill()
    (tmp_path / "worker").unlink()
    assert ", 32 kept from an earlier run" in finished(tmp_path, whole)


def test_a_lock_that_its_owner_removed_is_not_held(tmp_path) -> None:
    folder = tmp_path / "x.h5.parts"
    with shards.lock(folder):
        shards.clear(folder)
        assert not folder.exists()
        with shards.lock(folder):  # a new one
            assert folder.exists()


# progress


def test_a_line_now_and_then_where_nobody_watches_and_json_for_programs(monkeypatch, capsys) -> None:
    monkeypatch.setattr(console, "EVERY", 0.0)
    for as_json in (False, True):
        with console.progress_bar(150, 50, as_json) as meter:
            meter.add(48, 0)
            meter.add(48, 2)
    plain, last, *rows = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"98 of 150 cases, \S+ a second, 0:00:\d\d left", plain)
    assert last.endswith(", 2 unsolved")
    told = [json.loads(row) for row in rows]
    assert [(row["done"], row["cases"], row["unsolved"]) for row in told] == [(98, 150, 0), (146, 150, 2)]
    assert {"per_second", "seconds_left"} <= set(told[0])


@pytest.mark.slow
def test_a_worker_ends_with_the_run_that_was_killed(tmp_path) -> None:
    runs.study(tmp_path, GRID)
    before = TELLING.replace("time.sleep(60)", "time.sleep(1)")
    with runs.start(tmp_path, "many.toml", "--workers", 2, "--chunk", 16, before=before) as process:
        worker = int(awaited(tmp_path / "worker", process))
        process.kill()
    until(lambda: not alive(worker))


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root mounts a file system")
@pytest.mark.parametrize("size", ["60k", "1m"])
def test_a_file_system_that_is_full_is_told_and_what_is_finished_is_kept(size, whole, tmp_path) -> None:
    small = tmp_path / "small"
    small.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(small)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("this machine does not let itself mount a tmpfs")
    try:
        runs.study(small, GRID)
        believing = SMALL + "from workbench.run import shards; shards.free = lambda folder: 10**12\n"
        done = runs.run(small, "many.toml", "--workers", 1, "--chunk", 16, before=believing)
        assert done.returncode == 2, done.stderr
        assert re.fullmatch(r"workbench: cannot write many\.h5: .*; finished cases are kept; .*\n", done.stderr)
        assert not (small / "many.h5").exists()
        kept = len(list(small.glob("many.h5.parts/*.shard")))
        assert kept > 0
        remount = ["mount", "-o", "remount,size=10m", str(small)]
        subprocess.run(remount, check=True)
        assert f", {min(16 * kept, 150)} kept from an earlier run" in finished(small, whole)
    finally:
        subprocess.run(["umount", str(small)], check=True)
