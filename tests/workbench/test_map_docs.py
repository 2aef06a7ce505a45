"""docs/how-to/draw-diagrams.md: its study and its commands run as they stand, and its picture is the one they make."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from studies import load
from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli
from workbench.run import in_memory

ROOT = Path(__file__).parents[2]
DOCS = doc_pages.read(ROOT / "docs" / "how-to" / "draw-diagrams.md", "Draw a map")
STATUS = {"run regimes": 1}  # as the page says


def run(line: str) -> None:
    command = line.removeprefix("workbench ")
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(command))
    assert end.value.code == STATUS.get(command, 0), line


def commands(folder: Path) -> list[str]:
    """The commands of the page; its study is written into the folder."""
    (study,) = re.findall(r"```toml\n(.*?)```", DOCS, re.DOTALL)
    (folder / "three.toml").write_text(study, encoding="utf-8")
    return [line for block in re.findall(r"```sh\n(.*?)```", DOCS, re.DOTALL) for line in block.splitlines()]


def test_the_study_of_the_page_is_drawn_at_one_value_of_an_axis(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    solve, _, draw = commands(tmp_path)[-3:]
    run(solve)
    run(f"{draw} --dpi 50")
    assert Path("one.png").exists()


@pytest.mark.slow
def test_the_page_runs_as_it_stands(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    lines = commands(tmp_path)
    assert len(lines) == 8
    for line in lines:
        run(line)
    for name in ("regimes.png", "bends.pdf", "turned.png", "lines.png", "three.png", "one.png"):
        assert Path(name).stat().st_size > 10_000
    assert "12 of 19 rows agree" in capsys.readouterr().out
    shown, made = pixels(ROOT / "docs" / "figures" / "map_regimes.png"), pixels(Path("regimes.png"))
    assert shown.shape[1] / shown.shape[0] == pytest.approx(made.shape[1] / made.shape[0], rel=0.01)


def test_the_two_regimes_of_the_page_are_those_of_the_potential() -> None:
    ds = in_memory.run(load("regimes").at_stations(401))
    highest = np.degrees(ds["beta"].max("u").values)
    near, bent = highest < 30, ds["turns"].values > 0  # a rod that ends before its first bend has not turned yet
    assert highest[near & bent].max() < 28
    assert highest[~near & bent].min() > 50
    # beta'^2 + G(beta) = h: beta turns where G is again that of the start, near the helix or beyond its saddle
    case, start = load("regimes").case(), np.radians(10.0)
    A, rho = (np.broadcast_to(one, near.shape)[..., None] for one in (case.rod.bending_stiffness, case.rho))
    FZ, FY = -10.0 * np.cos(start), -10.0 * np.sin(start)  # F3 = -10 and F2 = 0 at the start; M3 = 0
    twice_l = 2 * (FY * rho / A + np.sin(start) ** 3 / rho)

    def G(beta):
        return (twice_l - np.sin(beta) ** 3 / rho) * np.sin(beta) / rho + 2 * FZ / A * np.cos(beta)

    turns = (G(np.radians(np.linspace(10.01, 30, 2000))) > G(start)).any(axis=-1)
    np.testing.assert_array_equal(turns[bent], near[bent])
    np.testing.assert_array_equal((ds["attached"].values > 1 - 1e-9)[bent], near[bent])
