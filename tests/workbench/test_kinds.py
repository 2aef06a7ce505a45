"""Every file that the workbench stores is summarised, drawn, or called what it is."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from solver import Case, Cylinder, Ends, InputError, Rod, follow, solve
from tests.workbench import small
from workbench import cli
from workbench.store import file_kinds

ENDS = small.text(
    {"EI": 1.0, "GJ": 0.8, "a": 0.2, "L": 4.0, "R": 0.8, "beta0": 0.2, "betaL": 0.3, "FZ": -3.0}, stations=51
)
LOOPS = "loops --length-unit cm --force-unit N --EI 1 --GJ 0.8 --a 0.1 --L 20 --R 1 --folds 1,2"
MADE = {  # file -> the command that stores it, and what it is called
    "list.h5": ("equilibria ends.toml --out list.h5", "a list of equilibria"),
    "axis.h5": ("equilibria ends.toml --axis FZ=-3:-2:3 --out axis.h5", "all equilibria over an axis"),
    "folds.h5": ("folds ends.toml --axis FZ=-3.2:-2.8 --axis betaL=0.2:0.4 --out folds.h5", "a fold map"),
    "loops.h5": (f"{LOOPS} --out loops.h5", "a list of closed rods"),
    "branch.h5": ("", "a branch of equilibria"),
}


def run(words: str) -> tuple[int, str]:
    done = CliRunner().invoke(cli.app, words.split())
    error = str(done.exception) if isinstance(done.exception, InputError) else ""
    return 2 if error else done.exit_code, error or " ".join(done.output.split())


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """One file of each kind."""
    folder = tmp_path_factory.mktemp("kinds")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        Path("ends.toml").write_text(ENDS)
        for words, _ in MADE.values():
            status, said = run(words) if words else (0, "")
            assert status in (0, 1), said
        case = Case(Rod(EI=1.0, GJ=0.8, a=0.2, L=4.0), Cylinder(R=0.8), Ends(beta0=0.2, betaL=0.3, FZ=-3.0))
        branch = follow(solve(case), FZ=-2.9)
        branch.to_dataset(length="cm", force="N").to_netcdf("branch.h5", engine="h5netcdf")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_a_file_of_any_kind_is_summarised_and_drawn_or_called_what_it_is(name, folder, monkeypatch) -> None:
    monkeypatch.chdir(folder)
    what = MADE[name][1]
    (kind,) = [kind for kind in file_kinds.KINDS if kind.what == what]
    status, said = run(f"summary {name}")
    assert status == 0, said
    assert what in said
    found = json.loads(CliRunner().invoke(cli.app, ["summary", name, "--json"]).stdout)
    assert found["kind"] == what
    assert "push_max" in [row["name"] for row in found["numbers"]] or what == "a fold map"
    status, said = run(f"plot {name} --out {name}.png --dpi 50 --force")
    assert (status == 0 and Path(f"{name}.png").exists()) if kind.figure else (status == 2 and what in said), said
    for command in (f"check {name}", f"merge {name} {name} --out no.h5"):
        status, said = run(command)
        assert status == 2, said
        assert f"{name} is {what}, which summary" in said
    if not kind.scene:
        status, said = run(f"scene {name}")
        assert (status, what in said) == (2, True), said
