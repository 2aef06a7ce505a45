"""docs/how-to/draw-diagrams.md: its commands run as they stand, and its pictures are those that they make."""

import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli

ROOT = Path(__file__).parents[2]
DOCS = doc_pages.read(ROOT / "docs" / "how-to" / "draw-diagrams.md")
SHOWN = {"curves": "curves_modulus", "ridge": "ridge_modulus", "portrait": "portrait_modulus"}


@pytest.mark.slow
def test_the_page_runs_as_it_stands(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line for block in re.findall(r"```sh\n(.*?)```", DOCS, re.DOTALL) for line in block.splitlines()]
    assert len(lines) == 6
    for line in lines:
        with pytest.raises(SystemExit) as end:
            cli.main(shlex.split(line.removeprefix("workbench ")))
        assert end.value.code == 0, line
    for made, name in SHOWN.items():
        shown, now = pixels(ROOT / "docs" / "figures" / f"{name}.png"), pixels(Path(f"{made}.png"))
        assert shown.shape == now.shape
        assert np.abs(shown - now).mean() < 0.01
    assert Path("ridge.csv").stat().st_size > 100_000


def test_the_sketch_of_the_variables_is_what_its_script_draws(tmp_path) -> None:
    script = runpy.run_path(str(ROOT / "docs" / "figures" / "variables.py"))
    script["draw"]().savefig(tmp_path / "now.png", dpi=200)
    shown, now = pixels(ROOT / "docs" / "figures" / "variables.png"), pixels(tmp_path / "now.png")
    assert shown.shape == now.shape
    assert np.abs(shown - now).mean() < 0.01
    # its directions are those of the page: B = T x N, and the tangent is that of the centreline
    s = np.array([3.0, 3.0 + 1e-6])
    step = np.diff(script["centreline"](s), axis=0)[0] / 1e-6
    assert step[2] == pytest.approx(np.cos(script["PITCH"]))
    assert np.linalg.norm(step) == pytest.approx(1)
