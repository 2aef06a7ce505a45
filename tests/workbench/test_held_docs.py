"""docs/how-to/hold-the-ends.md: its studies, its commands and its Python run as they stand."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.workbench import doc_pages
from workbench import cli

ROOT = Path(__file__).parents[2]
DOCS = doc_pages.read(ROOT / "docs" / "how-to" / "hold-the-ends.md")
STUDIES = dict(re.findall(r"```toml\n# (\w+)\.toml\n(.*?)```", DOCS, re.DOTALL))
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", DOCS, re.DOTALL) for line in block.splitlines()]


def run(line: str) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(line.removeprefix("workbench ")))
    assert end.value.code == 0, line


def test_the_command_of_the_page_names_the_loading_of_each_index(capsys) -> None:
    run(COMMANDS[0])
    said = capsys.readouterr().out
    assert "held: height; the search began at an equilibrium under dead loads, which has FZ = " in said
    assert "index 0 under held ends, 0 under dead loads" in said


def test_a_held_study_stores_reactions_and_its_index(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = STUDIES["moment"].replace("count = 9", "count = 3")
    Path("moment.toml").write_text(short, encoding="utf-8")
    run("workbench run moment.toml")
    with xr.open_dataset("moment.h5", engine="h5netcdf") as ds:
        assert ds["solved"].all()
        assert (ds["held_index"] == 0).all()
        assert np.isfinite(ds[["FZ", "betaL"]].to_array()).all()
        assert ds["beta"][:, -1].values == pytest.approx(ds["betaL"].values, abs=1e-12)
        assert "height" not in ds.data_vars or ds["height"].ndim == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES)
def test_the_studies_of_the_page_run_and_are_drawn(name: str, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path(f"{name}.toml").write_text(STUDIES[name], encoding="utf-8")
    for line in COMMANDS:
        if f" {name}." in line:
            run(line)
    with xr.open_dataset(f"{name}.h5", engine="h5netcdf") as ds:
        assert ds["solved"].all()
    if f"held_{name}.png" in DOCS:
        assert Path(f"held_{name}.png").stat().st_size > 10_000
        assert (ROOT / "docs" / "figures" / f"held_{name}.png").exists()


PYTHON = re.findall(r"```python\n(.*?)```", DOCS, re.DOTALL)


def told_by(code: str, capsys) -> str:
    exec(compile(code, "hold-the-ends.md", "exec"), {})  # the page's own code
    return str(capsys.readouterr().out)


def test_the_python_of_the_page_runs(capsys) -> None:
    assert told_by(PYTHON[0], capsys).startswith("-2")


@pytest.mark.slow
def test_the_python_of_alternatives_and_of_the_search_runs(capsys) -> None:
    lines = told_by(PYTHON[1], capsys).splitlines()
    assert lines[0].startswith("the seed, 0.")
    assert len(lines) > 1
    assert all(line.endswith("rad from the seed") for line in lines[1:])
    assert "equilibria, not proved complete: searched over FZ from -60 to 0" in told_by(PYTHON[2], capsys)


@pytest.mark.slow
def test_the_list_of_the_page_is_drawn(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (line,) = [one for one in COMMANDS if "--plot held_equilibria.png" in one]
    run(line)
    said = capsys.readouterr().out
    assert "8 equilibria, 2 stable under held ends: height" in said
    assert Path("held_equilibria.png").stat().st_size > 10_000
    assert (ROOT / "docs" / "figures" / "held_equilibria.png").exists()
