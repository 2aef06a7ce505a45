"""The pages on studies show only what works, and list everything."""

import re
from pathlib import Path

import numpy as np
import pytest

from solver import observe, solve
from solver.problem.units import FORCES, LENGTHS
from studies.language.loader import load, loads
from studies.language.study import OUTPUTS

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = (DOCS / "how-to" / "write-a-study.md").read_text(encoding="utf-8").split("<!-- part -->")[0]
KEYS = (DOCS / "reference" / "study-file.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```toml\n(.*?)```", GUIDE, re.DOTALL)
WHOLE = [example for example in EXAMPLES if "title" in example]


def test_there_are_examples() -> None:
    assert len(WHOLE) == 5
    assert len(EXAMPLES) == 6


@pytest.mark.parametrize("example", WHOLE, ids=lambda text: text.splitlines()[0])
def test_each_whole_example_is_a_study(example: str) -> None:
    study = loads(example)
    assert study.case().size == study.variation.size >= 1


def test_the_pipe_in_the_borehole_buckles_as_lubinski_says_and_not_into_a_knot() -> None:
    (text,) = [example for example in WHOLE if "borehole" in example]
    sol = solve(loads(text.replace("count = 4", "count = 2")).case(), stations=101)
    helix = np.arcsin(np.sqrt(-sol.FZ * sol.case.rho**2 / (2 * sol.case.rod.bending_stiffness)))
    # Lubinski's force is the helix's own over its cosine, which is within 1e-4 of 1
    np.testing.assert_allclose(np.abs(sol.beta[:, 50]), helix, rtol=1e-4)
    seen = observe(sol, ["kappa_max", "overlaps"])
    assert (seen["kappa_max"] * sol.case.rod.a < 1e-3).all()
    assert not seen["overlaps"].any()


def test_the_example_of_following_is_a_study_with_a_head() -> None:
    (part,) = set(EXAMPLES) - set(WHOLE)
    assert loads(WHOLE[0] + part).variation.from_base


def test_every_output_that_can_be_asked_for_is_listed() -> None:
    assert re.findall(r"`(\w+)`", KEYS.split("Outputs: ")[1].split("\n\n")[0]) == list(OUTPUTS)


def test_every_unit_is_listed() -> None:
    lengths, forces = KEYS.split("Units of length: ")[1].split(". Of force: ")
    assert lengths.split(", ") == [*LENGTHS]
    assert [*forces.split(".\n")[0].split(", ")] == [*FORCES]


def test_the_million_rods_of_the_docs_are_a_study_that_stores_no_curves() -> None:
    study = load(DOCS / "million.toml")
    assert (study.variation.size, study.stations, study.outputs) == (1_000_000, 101, [])
