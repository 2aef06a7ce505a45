"""What storing, workers, a cluster and going on cost, as ratios measured in one run; and the memory of large studies.

Run from the checkout: `.venv/bin/python -m benchmarks.large` (some minutes; `--only NAME ...`). The rows of the
cluster need the extra `cluster`, that of xyzpy the packages xyzpy and joblib. Prints a table and, with `--json FILE`,
writes it. Nothing here is asserted: machines differ.
"""

import argparse
import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.timing import compare_times, seconds_of_processor
from solver import solve
from solver.observe.observables import observe
from studies import Study
from studies.language.loader import loads
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.words import caution_words

STUDY = """
title = "Benchmark"
reading = "force-first/tension/paper"
observables = ["bends", "turns_around", "height", "kappa_max"]
outputs = {outputs}
stations = {stations}
method = "{method}"

[units]
length = "cm"
force = "N"

[axes.E]
from = 5e3
to = 4e4
count = {E}
spacing = "geometric"

[axes.F1]
from = 1.0
to = 9.0
count = {F1}
"""


SAMPLE = """
[sample]
size = {size}
seed = 1

[sample.E]
distribution = "log-uniform"
from = 5e3
to = 4e4

[sample.F1]
from = 1.0
to = 9.0
"""


def study(E: int, F1: int, stations: int = 101, outputs: tuple[str, ...] = (), method: str = "auto") -> Study:
    """E times F1 cases."""
    text = STUDY.format(E=E, F1=F1, stations=stations, outputs=json.dumps(list(outputs)), method=method)
    return loads(text, default_name="benchmark")


def samples(size: int) -> Study:
    """So many samples over the ranges of `study`, of which the same is stored."""
    text = STUDY.format(E=2, F1=2, stations=101, outputs="[]", method="auto").partition("[axes.E]")[0]
    return loads(text + SAMPLE.format(size=size), default_name="benchmark")


def work_of_run(work: Study, folder: Path, **options: object) -> Callable[[], None]:
    """A run of the study, to its end, each time anew."""

    def run() -> None:
        run_to_file(work, folder / "benchmark.h5", RunOptions(restart=True, **options))  # type: ignore[arg-type]

    return run


def bare(work: Study) -> Callable[[], None]:
    """The solver and its observables on the same arrays: one call each, nothing stored."""
    case = work.case()

    def run() -> None:
        observe(solve(case, work.tol, work.method, work.stations), work.wanted)

    return run


def overhead(folder: Path, rounds: int) -> dict[str, float]:
    """100,000 cases at 101 stations, observables only: run and stored by one worker, against the bare solver."""
    work = study(250, 400)
    mine, theirs, ratio = compare_times(work_of_run(work, folder, workers=1), bare(work), rounds)
    return {"stored [s]": mine, "bare [s]": theirs, "stored / bare": ratio}


def processor(folder: Path, rounds: int) -> dict[str, float]:
    """20,000 such cases, processor time: run and stored by one worker, the bare solver, and this with the cautions."""
    work = study(100, 200)
    case, wanted = work.case(), dict.fromkeys((*work.wanted, *caution_words.JUDGED))

    def tell_cautions() -> None:
        sol = solve(case, work.tol, work.method, work.stations)
        caution_words.of_cases(sol, observe(sol, wanted, errors=True))

    parts = {
        "stored [s]": work_of_run(work, folder, workers=1),
        "bare [s]": bare(work),
        "bare, with cautions [s]": tell_cautions,
        "solved alone [s]": lambda: solve(case, work.tol, work.method, work.stations),
    }
    spent = {name: [seconds_of_processor(part) for _ in range(rounds + 1)][1:] for name, part in parts.items()}
    found = {name: statistics.median(values) for name, values in spent.items()}
    return {
        **found,
        "stored / bare": found["stored [s]"] / found["bare [s]"],
        "stored / bare, with cautions": found["stored [s]"] / found["bare, with cautions [s]"],
    }


def many_samples(folder: Path, rounds: int) -> dict[str, float]:
    """100,000 samples, drawn, run and stored by one worker, against a grid of as many: processor time."""
    return _samples(folder, 100_000, (250, 400), rounds)


def million_samples(folder: Path, rounds: int) -> dict[str, float]:
    """1,000,000 samples, drawn, run and stored by one worker, against a grid of as many: processor time."""
    return _samples(folder, 1_000_000, (1000, 1000), 1)


def _samples(folder: Path, size: int, axes: tuple[int, int], rounds: int) -> dict[str, float]:
    """In processes of their own, in turn, so that each has its own largest memory."""
    (folder / "samples.toml").write_text(samples(size).text)
    (folder / "grid.toml").write_text(study(*axes).text)
    spent: dict[str, list[tuple[float, float]]] = {"samples": [], "grid": []}
    for _ in range(rounds):
        for name, measured in spent.items():
            command = [
                sys.executable,
                "-m",
                "workbench.cli",
                "run",
                f"{name}.toml",
                "--workers",
                "1",
                "--restart",
                "--json",
            ]
            measured.append(_watch(command, folder)[1:])
    found = {f"{name} [s]": statistics.median(seconds for seconds, _ in told) for name, told in spent.items()}
    found |= {f"{name}, peak [GB]": max(peak for _, peak in told) for name, told in spent.items()}
    return {**found, "samples / grid": found["samples [s]"] / found["grid [s]"]}


def workers(folder: Path, rounds: int) -> dict[str, float]:
    """The same cases by two workers of this machine, against one."""
    work = study(250, 400)
    two, one, ratio = compare_times(work_of_run(work, folder, workers=2), work_of_run(work, folder, workers=1), rounds)
    return {"two [s]": two, "one [s]": one, "one / two": 1 / ratio}


def cluster(folder: Path, rounds: int) -> dict[str, float]:
    """The same cases by two workers of a Dask cluster on loopback, against two of this machine."""
    at = folder / "scheduler.json"
    address = ("--host", "127.0.0.1", "--scheduler-file", str(at), "--no-dashboard")
    commands = (("scheduler", *address, "--port", "0"), ("worker", *address, "--nworkers", "2", "--nthreads", "1"))
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    started = [subprocess.Popen([sys.executable, "-m", "dask", *words], **quiet) for words in commands]
    try:
        while not at.exists():
            time.sleep(0.1)
        scheduler = json.loads(at.read_text())["address"]
        work = study(250, 400)
        dask = work_of_run(work, folder, scheduler=scheduler)
        theirs, mine, ratio = compare_times(dask, work_of_run(work, folder, workers=2), rounds)
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()
    return {"Dask [s]": theirs, "pool [s]": mine, "Dask / pool": ratio}


def run_and_rerun(folder: Path, rounds: int) -> dict[str, float]:
    """`workbench run` of a study of a million cases: the run itself, its memory, and once more when it is finished."""
    return _large(folder, study(1000, 1000), rounds)


def with_curves(folder: Path, rounds: int) -> dict[str, float]:
    """100,000 cases at 401 stations, with four arrays along the rod."""
    return _large(folder, study(250, 400, 401, ("beta", "alpha", "z", "contact")), 1)


def _large(folder: Path, work: Study, rounds: int) -> dict[str, float]:
    (folder / "benchmark.toml").write_text(work.text)
    command = [sys.executable, "-m", "workbench.cli", "run", "benchmark.toml", "--workers", "2", "--json"]
    seconds, spent, peak = _watch(command, folder)
    size = (folder / "benchmark.h5").stat().st_size
    again = min(_watch(command, folder)[0] for _ in range(rounds))
    return {
        "cases": work.variation.size,
        "run [s]": seconds,
        "run, of the processor [s]": spent,
        "cases a second": work.variation.size / seconds,
        "peak of the run and of each worker [GB]": peak,
        "file [GB]": size / 1e9,
        "once finished [s]": again,
    }


def _watch(command: list[str], folder: Path) -> tuple[float, float, float]:
    """Seconds of a command, those of the processor, and the largest memory that any process of it had at once [GB]
    (Linux)."""
    env = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    began, used = time.perf_counter(), {}
    process = subprocess.Popen(command, cwd=folder, env=env, stdout=subprocess.DEVNULL, start_new_session=True)
    while process.poll() is None:
        used |= {pid: (ticks, peak) for pid, ticks, peak in _usage(process.pid)}
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(0.1)
    if process.returncode > 1:
        raise RuntimeError(f"{command} ended with status {process.returncode}")
    ticks, peaks = zip(*used.values(), strict=True)
    return time.perf_counter() - began, sum(ticks) / os.sysconf("SC_CLK_TCK"), max(peaks) * 1024 / 1e9


def _usage(session: int) -> Iterator[tuple[int, int, int]]:
    """The number of each process of a session, its ticks of the processor, and its most memory so far [kB]."""
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, StopIteration):
            pid = int(folder.name)
            if os.getsid(pid) == session:
                user, system = (folder / "stat").read_text().rpartition(")")[2].split()[11:13]
                lines = (folder / "status").read_text().splitlines()
                peak = next(line for line in lines if line.startswith("VmHWM")).split()[1]
                yield pid, int(user) + int(system), int(peak)


def against_xyzpy(folder: Path, rounds: int) -> dict[str, float]:
    """10,000 cases at 101 stations and one array: run and stored, against xyzpy, which calls the solver for each."""
    import xyzpy

    work = study(100, 100, outputs=("beta",))

    def one(E: float, F1: float) -> tuple[object, ...]:
        sol = solve(work.case_of({"E": E, "F1": F1}), work.tol, work.method, work.stations)
        return (sol.beta, *observe(sol, work.wanted).values())

    runner = xyzpy.Runner(one, ("beta", *work.wanted), var_dims={"beta": "u"})
    axes = {name: values.tolist() for name, values in work.variation.dimensions.fields.items()}

    def theirs() -> None:
        ds = runner.run_combos(axes, parallel=True, num_workers=2, verbosity=0)
        ds.to_netcdf(folder / "xyzpy.h5", engine="h5netcdf")

    slow, fast, ratio = compare_times(theirs, work_of_run(work, folder, workers=2), rounds)
    return {"xyzpy [s]": slow, "stored [s]": fast, "xyzpy / stored": ratio}


PARTS = {
    "overhead": overhead,
    "processor": processor,
    "workers": workers,
    "sampled": many_samples,
    "sampled million": million_samples,
    "cluster": cluster,
    "xyzpy": against_xyzpy,
    "million": run_and_rerun,
    "curves": with_curves,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    found = {}
    for name in asked.only:
        with tempfile.TemporaryDirectory() as folder:
            found[name] = PARTS[name](Path(folder), asked.rounds)
        print((PARTS[name].__doc__ or name).splitlines()[0])
        for what, value in found[name].items():
            print(f"  {what:<42} {value:.4g}", flush=True)
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=2))


if __name__ == "__main__":
    main()
