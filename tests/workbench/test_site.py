"""The sources of the documentation site say what the code says. CI builds the site of them, with warnings as errors."""

import re
import shutil
from pathlib import Path

import pytest
from PIL import Image

from docs.website import api_pages, command_pages, dataset_page, results, sources, study_page
from studies import Study
from studies.laws.judgement import Law
from tests.workbench import browser
from workbench import cli

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def index(tmp_path_factory) -> str:
    """The first page with its tables of contents."""
    folder = tmp_path_factory.mktemp("site")
    shutil.copy(ROOT / "docs" / "index.md", folder)
    sources.add_contents(folder)
    return (folder / "index.md").read_text(encoding="utf-8")


def test_the_tables_of_contents_hold_every_page(index: str) -> None:
    entries = set(re.findall(r"<([^>\s]+)>$", index, re.MULTILINE))
    pages = {page.relative_to(ROOT / "docs").with_suffix("").as_posix() for page in (ROOT / "docs").rglob("*.md")}
    made = {page for _, entries in sources.MADE.values() for _, page in entries}
    assert entries == (pages - {"index"}) | made


def test_what_was_made_is_also_linked_on_the_first_page(index: str) -> None:
    linked = {target.partition(".")[0] for target in re.findall(r"\]\(([^)]+)\)", sources.ON_THE_SITE)}
    made = {page for caption, entries in sources.MADE.values() if caption != "Project" for _, page in entries}
    assert linked == made
    assert index.count("## On this site") == 1


def test_the_first_page_begins_with_the_question_and_the_pictures_of_the_readme(index: str) -> None:
    top = index.partition("## On this site")[0]
    assert top.startswith("# Rod workbench\n")
    assert "What shape does an elastic rod take on a cylinder" in top
    assert re.findall(r'<img class="hero" src="([^"]+)" alt="[^"]{40,}">', top) == [
        "figures/hero_page.webp",
        "figures/hero_sweep.webp",
    ]
    assert "python -m docs.build" not in index  # who reads the site has it


def test_twenty_results_have_commands_that_draw_them_and_three_stand_in_the_readme() -> None:
    assert len({one.name for one in results.RESULTS}) == 20
    for one in results.RESULTS:
        assert one.commands[-1].endswith(f" {one.name}.png")
        assert {command.partition(" ")[0] for command in one.commands} <= set(cli.COMMANDS)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    printed = re.sub(r" \\\n +", " ", readme)
    for one in results.README:
        assert f'<img src="docs/figures/{one.name}.png"' in readme
        assert "".join(f"workbench {command}\n" for command in one.commands) in printed


def test_a_thumbnail_has_no_white_border_and_shows_the_upper_part_of_a_high_picture(tmp_path: Path) -> None:
    high = Image.new("RGB", (400, 1600), "white")
    high.paste("red", (100, 100, 300, 200))
    high.paste("blue", (100, 200, 300, 1500))
    high.save(tmp_path / "high.png")
    results.shrink(tmp_path / "high.png", tmp_path / "small.webp")
    with Image.open(tmp_path / "small.webp") as small:
        assert small.size == results.SIZE
        corner, foot = small.getpixel((results.EDGE + 5, results.EDGE + 5)), small.getpixel((320, 430))
    assert corner[0] > 200 > 60 > corner[2]
    assert foot[2] > 200 > 60 > foot[0]


@pytest.mark.slow
def test_on_a_phone_letters_of_a_picture_have_nine_pixels_and_the_page_is_no_wider_than_the_screen(
    tmp_path,
) -> None:
    css = (ROOT / "docs/website/static/site.css").read_text(encoding="utf-8")
    theme = "article img { max-width: 100%; height: auto }"  # as furo has it
    with Image.open(ROOT / "docs/scenes/grid.png") as picture:
        (wide, _), dots = picture.size, picture.info["dpi"][0]
    body = f'<article role="main"><p><img src="{(ROOT / "docs/scenes/grid.png").as_uri()}"></p></article>'
    head = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    (tmp_path / "page.html").write_text(f"<!doctype html>{head}<style>{theme}{css}</style>{body}", encoding="utf-8")
    (tmp_path / "profile").mkdir()
    with browser.chromium(tmp_path / "profile", "800,900") as driver:
        phone = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
        driver.get((tmp_path / "page.html").as_uri())
        shown = driver.execute_script("return document.querySelector('img').getBoundingClientRect().width")
        assert shown / wide * 7 / 72 * dots >= 9
        assert driver.execute_script("return document.documentElement.scrollWidth") == 390


def test_the_gallery_and_its_examples_name_the_thumbnails_that_are_made() -> None:
    size = re.search(r'"thumbnail_size": \((\d+), (\d+)\)', (ROOT / "docs/website/conf.py").read_text(encoding="utf-8"))
    assert (int(size[1]), int(size[2])) == results.SIZE
    texts = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "examples").glob("*.py")}
    named = {name for name, text in texts.items() if f'"_static/thumbnails/{name}.png"' in text}
    assert named == set(results.THUMBNAILS)


def test_each_command_has_a_page_with_every_option(tmp_path: Path) -> None:
    command_pages.write(tmp_path)
    listed = (tmp_path / "reference" / "command-line.md").read_text(encoding="utf-8")
    for name, command in command_pages.commands_by_name().items():
        page = (tmp_path / "reference" / "command-line" / f"{name}.md").read_text(encoding="utf-8")
        assert f"(command-line/{name}.md)" in listed
        for param in (known for known in command.params if not getattr(known, "hidden", False)):
            for option in param.opts:
                assert option.startswith("-") is False or f"{option}" in page, (name, option)
    assert set(command_pages.commands_by_name()) == set(cli.COMMANDS)


def test_the_keys_of_a_study_are_those_of_the_model() -> None:
    keys = {key.strip("`"): (kind, default) for key, kind, default, _ in study_page.rows("Study")}
    assert set(keys) == set(Study.model_fields)
    assert keys["title"][1] == "required"
    assert keys["stations"] == ("whole number", "`201`")
    assert keys["laws"][0] == "list of: table [[laws]]"
    assert {row[0].strip("`") for row in study_page.rows("Law")} == set(Law.model_fields)


def test_each_table_of_a_study_is_described() -> None:
    assert set(study_page.schema()) == set(study_page.TABLES)


def test_the_first_small_study_stores_everything_with_its_unit() -> None:
    heading, study = next(iter(dataset_page.STUDIES.items()))
    lines = dataset_page.table(dataset_page.run(heading, study))
    assert "| `beta` | E, u | rad | β | angle from the axis to the tangent |" in lines
    assert "| `push_mean` | E | N/cm | mean push | mean push of the cylinder per length, pulls not counted |" in lines


def test_every_public_name_of_the_solver_has_a_page_that_begins_with_its_first_sentence() -> None:
    assert api_pages.sentence("solver.solve") == "The shape of a case, or of each case of a grid."
    assert ".. autoclass:: solver.Rod" in api_pages.page("solver.Rod")
    assert ".. autofunction:: solver.solve" in api_pages.page("solver.solve")
    for paths in api_pages.PUBLIC.values():
        assert all(api_pages.sentence(path).endswith(".") for path in paths)
