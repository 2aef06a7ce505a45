"""The pages: their links resolve, the index lists them all, their tables agree with the code, the tutorials run."""

import json
import re
import runpy
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from docs import notebook
from solver import Cylinder, Ends, Rod, Start
from solver.methods import METHODS
from solver.observe.observables import OBSERVABLES, is_count
from solver.problem.quantities import unit_of
from studies import load, names
from studies.language.loader import loads
from studies.language.study import OUTPUTS
from studies.laws.law_kinds import KINDS as KINDS_OF_LAWS
from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.rglob("*.md"), *ROOT.glob("*.md")])
KINDS = ("tutorial", "how-to", "reference", "explanation", "developer")
FENCED = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)
# of the vocabulary: the wrong word, which no page may use
WRONG = (
    "where left out", "slab", "unrolled curve", "asked wrongly", "meets itself",
    "at the door", "the dial", "crew", "landscape", "half a swing",
)  # fmt: skip


def text(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ (.*)$", FENCED.sub("", text(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def rows(page: str, heading: str = "") -> list[list[str]]:
    """The cells of the first table of a page, or of the first after a heading."""
    body = text(DOCS / "reference" / page).split(f"\n{heading}\n", 1)[1] if heading else text(DOCS / "reference" / page)
    table = re.search(r"(?:^\|.*\n)+", body, re.MULTILINE)
    assert table
    lines = table[0].replace(r"\|", "¦").splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def code(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", doc_pages.read(page), re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_no_line_of_a_block_of_code_is_wider_than_a_terminal(page: Path) -> None:
    wide = [line for block in FENCED.findall(text(page)) for line in block.splitlines() if len(line) > 80]
    assert not wide


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_of_a_page_resolves(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", FENCED.sub("", text(page))):
        if target.startswith("http"):
            continue
        name, _, anchor = target.partition("#")
        found = (page.parent / name).resolve() if name else page
        assert found.exists(), target
        assert not anchor or anchor in anchors(found), target
    for named in re.findall(r"`(docs/[\w/.-]+\.(?:md|toml|png))`", text(page)):
        assert (ROOT / named).exists(), named


def test_the_index_lists_every_page_and_each_page_has_one_kind() -> None:
    listed = re.findall(r"^- \[.*?\]\(([^)#]+)\)", text(DOCS / "index.md"), re.MULTILINE)
    more = re.findall(r"\]\((?!\.\./)([^)#]+\.md)\)", text(DOCS / "index.md"))
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")} - {"index.md"}
    assert set(listed) | set(more) == pages
    assert {page.partition("/")[0] for page in pages} == {*KINDS, "decisions.md"}


def test_the_pages_for_developers_name_what_exists_and_the_first_one_every_package() -> None:
    tops = ("solver", "studies", "workbench", "docs", "tests", "benchmarks")
    there = {f"/{path.relative_to(ROOT).as_posix()}" for top in tops for path in [ROOT / top, *(ROOT / top).rglob("*")]}
    architecture = text(ROOT / "ARCHITECTURE.md")
    for page in (architecture, *map(text, (DOCS / "developer").glob("*.md"))):
        named = re.findall(r"`((?:\w+/)*\w+(?:\.py|\.c|\.h|/)|(?:\w+/)+\w+)`", page)
        assert named
        for name in named:
            ends = tuple(f"/{name.rstrip('/')}{ending}" for ending in ("", ".py"))
            assert any(path.endswith(ends) for path in there), name
    packages = {path.parent.name for top in tops[:3] for path in (ROOT / top).glob("*/__init__.py")}
    assert not packages - set(re.findall(r"`(?:\w+/)*?(\w+)/`", architecture))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_a_page_uses_the_terms_of_the_glossary(page: Path) -> None:
    found = re.sub(r"\s+", " ", text(page)).lower()
    assert not [word for word in WRONG if word in found]


def test_the_readme_has_a_picture_and_no_more_than_120_lines() -> None:
    readme = text(ROOT / "README.md").splitlines()
    assert len(readme) <= 120
    assert readme[2].startswith("<img ")  # `test_gallery` looks at both


def test_the_table_of_observables_is_that_of_the_code() -> None:
    table = rows("quantities.md", "## Observables")
    assert [row[0].strip("`") for row in table] == list(OBSERVABLES)
    for name, unit, sign, *_ in table:
        assert unit_of(name.strip("`"), {"length": "[L]", "force": "[F]"}) == unit, name
        assert ("whole" in sign or sign == "0 or 1") == is_count(name.strip("`")), name


def test_the_table_of_fields_is_that_of_the_code() -> None:
    table = {name for row in rows("quantities.md", "## Fields of a case") for name in re.findall(r"`(\w+)`", row[1])}
    assert table == {field.name for part in (Rod, Cylinder, Start, Ends) for field in fields(part)}


def test_the_table_of_methods_is_that_of_the_code() -> None:
    table = {row[0].strip("`"): row for row in rows("methods.md")}
    assert set(table) == set(METHODS)
    for name, method in METHODS.items():
        assert table[name][1] == ", ".join(method.problems)
        assert re.findall(r"`(\w+)`", table[name][5]) == [knob.name for knob in fields(method)]


def test_the_outputs_are_marked_in_the_table_of_arrays() -> None:
    table = rows("quantities.md", "## Arrays along the rod")
    marked = [name for cell, *_ in table if "*" in cell for name in re.findall(r"`(\w+)`", cell)]
    assert marked == list(OUTPUTS)


def test_every_command_is_listed() -> None:
    import typer.main

    table = [re.match(r"`(\w+)", row[0]) for row in rows("commands.md")]
    commands = typer.main.get_command(cli.app).commands  # type: ignore[attr-defined]
    assert {found[1] for found in table if found} == set(commands)


def test_the_tutorial_names_every_shipped_study() -> None:
    shipped = names()
    (said,) = re.findall(
        r"The table lists (.*?)\. Each row", text(DOCS / "tutorial" / "reproduce-a-figure.md"), re.DOTALL
    )
    assert set(re.findall(r"`(\w+)`", said)) == {name for name in shipped if not name.startswith("fig7")}
    assert said.startswith({17: "17 "}[len(shipped)])


def test_the_table_of_fidelities_is_that_of_the_code() -> None:
    from workbench.commands.fidelity import FIDELITIES

    for name, tolerance, stations, _ in rows("methods.md", "## `--fidelity`"):
        told = FIDELITIES[name.strip("`")]
        assert float(tolerance) == told.tol
        assert told.stations is None or int(stations) == told.stations


def test_the_tables_of_laws_name_every_kind_and_every_key() -> None:
    page, reference = (
        doc_pages.read(DOCS / "how-to" / "write-a-study.md", "Write a law"),
        text(DOCS / "reference" / "study-file.md"),
    )
    (study,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    for kind, row in KINDS_OF_LAWS.items():
        assert f"`{kind}`" in reference
        assert all(f"`{key}`" in reference for key in row.all_keys)
    assert {law.kind for law in loads(study).laws} == set(KINDS_OF_LAWS) - {"monotone"}
    (example,) = re.findall(r"```toml\n(\[expressions\].*?)```", reference, re.DOTALL)
    study = study.split("[expressions]")[0]
    assert loads(study + example).expressions.keys() == {"lift", "mitchell", "push_share"}


@pytest.mark.parametrize("part, name", [("", "samples_pipe"), ("Refine a boundary", "regimes_refined")])
def test_the_first_study_of_a_page_is_the_shipped_one(part: str, name: str) -> None:
    page = doc_pages.read(DOCS / "how-to" / "sample-a-study.md", part)
    first = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)[0]
    assert loads(first, default_name=name).model_dump() == load(name).model_dump()


def test_the_notebook_of_the_examples_is_the_tutorial() -> None:
    stored = text(notebook.NOTEBOOK)
    assert stored == notebook.notebook(text(notebook.PAGE))  # else: python -m docs.notebook
    lines = [line for cell in json.loads(stored)["cells"] for line in cell["source"]]
    links = re.findall(r"\]\(([^)#]+)\)", "".join(lines))
    assert links
    assert all((notebook.NOTEBOOK.parent / link).exists() for link in links)


def test_the_sketch_of_the_variables_is_what_its_script_draws(tmp_path) -> None:
    script = runpy.run_path(str(DOCS / "figures" / "variables.py"))
    script["draw"]().savefig(tmp_path / "now.png", dpi=200)
    shown, now = pixels(DOCS / "figures" / "variables.png"), pixels(tmp_path / "now.png")
    assert shown.shape == now.shape
    assert np.abs(shown - now).mean() < 0.01
    # its directions are those of the page: B = T x N, and the tangent is that of the centreline
    s = np.array([3.0, 3.0 + 1e-6])
    step = np.diff(script["centreline"](s), axis=0)[0] / 1e-6
    assert step[2] == pytest.approx(np.cos(script["PITCH"]))
    assert np.linalg.norm(step) == pytest.approx(1)
