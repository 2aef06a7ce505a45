"""Dask in docs/how-to/run-large-studies.md and Snakemake in use-other-programs.md: what stands there runs."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver import Case, Cylinder, Rod, Start, solve
from tests.workbench import doc_pages, runs
from tests.workbench.command import run
from tests.workbench.study_kinds import STUDIES

HOW_TO = Path(__file__).parents[2] / "docs" / "how-to"


def blocks(page: str, language: str, part: str = "") -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", doc_pages.read(HOW_TO / page, part), re.DOTALL)


def python(folder: Path, text: str) -> str:
    """What a script prints, in a process of its own: workers read its file."""
    (folder / "script.py").write_text(text, encoding="utf-8")
    env = {**os.environ, "PYTHONPATH": str(runs.ROOT)}
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=folder, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_study_over_two_ends_is_divided_between_machines_as_its_page_says(tmp_path, monkeypatch) -> None:
    lines = blocks("run-large-studies.md", "sh")[0].splitlines()
    first, second, copy, last = (line.partition("#")[0].strip() for line in lines)
    here, there, whole = (tmp_path / name for name in ("here", "there", "whole"))
    assert copy == "scp 'there:study.h5.parts/*' study.h5.parts/"
    for place, command in ((whole, last), (there, second), (here, first), (here, last)):
        place.mkdir(exist_ok=True)
        monkeypatch.chdir(place)
        Path("study.toml").write_text(STUDIES["sweep"].text, encoding="utf-8")
        run(command)
        if command == first:
            shutil.copytree(there / "study.h5.parts", "study.h5.parts", dirs_exist_ok=True)
    assert runs.contents(here / "study.h5") == runs.contents(whole / "study.h5")


def test_the_dask_page_solves_in_tasks(capsys) -> None:
    pytest.importorskip("dask")
    names: dict[str, object] = {}
    exec(compile(blocks("run-large-studies.md", "python", "Use Dask")[2], "use-dask.md", "exec"), names)
    assert "(1000,)" in capsys.readouterr().out
    rods = Rod(E=np.array([5e3, 4e4]), nu=0.25, a=0.25, L=20.0)
    ends = solve(Case(rods, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0))).z[:, -1]
    np.testing.assert_allclose(names["found"][[0, -1]], ends, rtol=1e-9)  # type: ignore[index]


@pytest.mark.slow
def test_the_dask_page_reads_a_stored_study_in_pieces(tmp_path, monkeypatch) -> None:
    pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    (study,) = blocks("run-large-studies.md", "toml", "Use Dask")
    Path("grid.toml").write_text(study, encoding="utf-8")
    _, command = blocks("run-large-studies.md", "sh", "Use Dask")
    run(command.strip())
    names: dict[str, object] = {}
    exec(compile(blocks("run-large-studies.md", "python", "Use Dask")[0], "use-dask.md", "exec"), names)
    pressed = names["pressed"]
    assert isinstance(pressed, xr.DataArray)
    assert pressed.shape == (20, 5)
    names["ds"].close()  # type: ignore[attr-defined]
    with xr.open_dataset("grid.h5") as ds:
        np.testing.assert_array_equal(pressed, (ds.rod.push > 0).mean("u"))


@pytest.mark.slow
def test_the_dask_page_solves_the_same_file_on_a_cluster(tmp_path, monkeypatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    (study,) = blocks("run-large-studies.md", "toml", "Use Dask")
    Path("grid.toml").write_text(study, encoding="utf-8")
    run("workbench run grid.toml")
    assert python(tmp_path, blocks("run-large-studies.md", "python", "Use Dask")[1]) == "{'solved': 100}\n"
    with xr.open_dataset("grid.h5") as here, xr.open_dataset("again.h5") as there:
        for one in (here, there):
            for name in ("created", "statistics", "recipe", "checksums"):  # of that moment
                del one.attrs[name]
        xr.testing.assert_identical(here, there)


@pytest.fixture
def workflow(tmp_path: Path) -> Path:
    """The files of the page on Snakemake, each named by its first line."""
    pytest.importorskip("snakemake", reason="Snakemake is not installed")
    for language in ("text", "python"):
        for text in blocks("use-other-programs.md", language, "Use Snakemake"):
            if name := re.match(r"# (\w+(\.\w+)?)\n", text):
                (tmp_path / name[1]).write_text(text, encoding="utf-8")
    return tmp_path


def snakemake(folder: Path, *more: str) -> str:
    tools = folder / "bin"  # `workbench` and `python` of this checkout, whatever is installed
    tools.mkdir(exist_ok=True)
    for name, words in (("python", ""), ("workbench", " -m workbench")):
        (tools / name).write_text(f'#!/bin/sh\nexec {sys.executable}{words} "$@"\n')
        (tools / name).chmod(0o755)
    env = {**os.environ, "PYTHONPATH": str(runs.ROOT), "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"}
    command = [
        sys.executable,
        "-m",
        "snakemake",
        *shlex.split(blocks("use-other-programs.md", "sh", "Use Snakemake")[1])[1:],
        *more,
    ]
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_snakemake_plans_the_workflow_of_the_page(workflow) -> None:
    assert sorted(path.name for path in workflow.iterdir()) == ["Snakefile", "table.py", "template.toml"]
    told = snakemake(workflow, "--dry-run")
    assert re.search(r"^solve +3$", told, re.MULTILINE)
    assert re.search(r"^total +10$", told, re.MULTILINE)


@pytest.mark.slow
def test_the_snakemake_page_runs_as_it_stands_and_solves_only_what_is_new(workflow) -> None:
    snakemake(workflow)
    assert (workflow / "radii.png").stat().st_size > 10_000
    assert len((workflow / "radii.csv").read_text().splitlines()) == 1 + 15 * 3
    with xr.open_dataset(workflow / "radii.h5") as ds:
        assert ds["R"].values.tolist() == [0.5, 0.75, 1.0]
    assert "Nothing to be done" in snakemake(workflow)
    file = workflow / "Snakefile"
    file.write_text(file.read_text().replace('"1.0"]', '"1.0", "1.5"]'))
    assert re.search(r"^solve +1$", snakemake(workflow), re.MULTILINE)
    with xr.open_dataset(workflow / "radii.h5") as ds:
        assert ds["R"].values.tolist() == [0.5, 0.75, 1.0, 1.5]
