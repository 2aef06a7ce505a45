"""The report: one file with everything in it, on machines with and without OpenGL."""

import base64
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import image
from PIL import Image, PngImagePlugin

from solver.problem.errors import InputError
from studies import READINGS, load, names
from studies.laws import law_words
from tests import transcripts
from tests.workbench import browser, node, small
from tests.workbench.pictures import shares_of_push
from tests.workbench.waiting import until
from workbench.commands import docs
from workbench.figures import canvas
from workbench.lab import measured_runs
from workbench.paper import law_cards, report_document, report_runs, reproduce
from workbench.paper.sources import ReportedStudy
from workbench.run import in_memory, writing
from workbench.stored import reading, stored_verdicts
from workbench.stored.stored_study import StoredStudy
from workbench.words import labels

PAPER = [name for name in names() if name.startswith("fig")]  # the studies of the report
# pixels of the height of each panel's rods, of 1440 of width, and of its drawing, of 700
HIGH = {"fig6": (570, 1107), "fig7_1_modulus": (995, 936), "fig7_2_radius": (793, 864),
        "fig7_3_start_angle": (964, 1376), "fig7_4_end_angle": (823, 1219), "fig7_5_forces": (917, 1389)}  # fmt: skip


class Page(HTMLParser):
    """What is linked to, the pictures, the ids, the table rows and the text of a page; tags must balance."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.ids: list[str] = []
        self.rows: dict[str, int] = {}
        self.text = ""
        self.packed: dict[str, str] = {}
        self.open: list[str] = []
        self.section = ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs) -> None:
        found = dict(attrs)
        self.links += [found[name] for name in ("href", "src", "srcset", "action") if name in found]
        if tag == "img" and "src" in found:
            self.pictures.append(found)
        if tag == "script" and "id" in found:
            self.packed[found["id"]] = ""
        elif tag == "section":
            self.ids.append(found["id"])
            self.section = found["id"]
        if tag == "tr":
            self.rows[self.section] = self.rows.get(self.section, 0) + 1
        if tag not in {"img", "meta", "br", "source"}:
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data) -> None:
        if self.open and self.open[-1] not in {"style", "script"}:
            self.text += data.replace("\u00a0", " ")
        elif self.open and self.open[-1] == "script" and self.packed and not self.packed["data"]:
            self.packed["data"] = data


@pytest.fixture(scope="module")
def readings() -> StoredStudy:
    return StoredStudy(report_runs.run_readings())


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> list[ReportedStudy]:
    folder = tmp_path_factory.mktemp("pictures")
    found = []
    for name in PAPER:
        ds = small.study_dataset(name)
        pictures = {part: folder / f"{name}_{part}.png" for part in ("figure", "scene")}
        column = report_document.column_of(pictures["figure"])
        sizes = {pictures["figure"]: (96, 74), pictures["scene"]: (1440, HIGH[name][0]), column: (700, HIGH[name][1])}
        for path, size in sizes.items():
            Image.new("RGB", size, "white").save(path)
        found.append(ReportedStudy(StoredStudy(ds), folder / f"{name}.h5", pictures))
    return found


@pytest.fixture(scope="module")
def measured(tmp_path_factory) -> list[measured_runs.MeasuredRun]:
    save = canvas.save
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(canvas, "save", lambda fig, page, dpi: save(fig, page, 40))  # few dots are soon drawn
        return measured_runs.comparisons(tmp_path_factory.mktemp("nothing"))


@pytest.fixture(scope="module")
def text(results, readings, measured) -> str:
    return report_document.html(results, readings, measured=measured)


def test_nothing_outside_the_file_is_needed(text) -> None:
    page = Page(text)
    cited = f"https://doi.org/{docs.PAPER['doi']}"
    assert all(link.startswith(("#", "data:image/")) or link == cited for link in page.links)
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    own = text.replace(cited, "").replace("http://www.w3.org/2000/svg", "")
    assert not re.search(r"https?:|@import|url\(|<link|src=\"(?!data:)", own)
    own = unescape(own)
    assert "default-src 'none'" in own
    assert "unsafe-eval" not in own.replace("wasm-unsafe-eval", "")
    assert len(text) < 4e6


def words(text: str) -> list[str]:
    """What a reader sees, a line for each paragraph, cell or list entry; without versions and dates."""
    text = re.sub(r"<(style|script|svg)\b.*?</\1>", "", text, flags=re.DOTALL)
    text = re.sub(r"<su([bp])>(.*?)</su\1>", r"\1(\2)", text)
    blocks = "p|h\\d|t[hdr]|li|figcaption|summary|d[tdl]|div|section|button|label|pre|details|header|figure"
    parts = re.split(rf"</?(?:{blocks})\b[^>]*>", text)
    lines = [" ".join(unescape(re.sub(r"<[^>]*>", "", part)).split()) for part in parts]
    seen = [line for line in lines if line and not line.startswith("Made 20")]
    return [re.sub(r"workbench [\d.]+|20\d\d-\d\d-\d\d", "…", line) for line in seen]


def test_the_drop_of_tension_to_the_sharpest_bend_is_that_between_stations() -> None:
    stored = StoredStudy(small.study_dataset("fig7_1_modulus"))
    tension = stored.select({"E": 8}).solve(20_001, ["beta"]).along("F3").values
    assert f"to {tension[0] - tension.min():.3g} N)" in law_cards.mechanism("(1)", stored)


def test_the_report_says_what_is_stored(text) -> None:
    assert transcripts.differences("report.words", words(text)) == []


def test_that_no_real_rod_could_keep_the_shapes_is_said_once_at_the_top_and_leads_to_what_they_would_do(
    results,
) -> None:
    let_go = {"head": [], "rows": [], "count": 9, "on": "9 of them keep", "file": "let_go.h5"}
    text = report_document.html(results, release=let_go)
    said = Page(text).text
    assert said.count("o real rod could keep") == 1
    assert "o real rod could keep" in said.partition("Judged by")[0]
    assert text.partition('class="claims"')[0].count('href="#let_go"') == 1
    kept = results[1].stored.ds.assign(caution=results[1].stored.ds["caution"].copy(data=np.full(9, "")))
    mixed = Page(report_document.html([replace(results[1], stored=StoredStudy(kept)), *results[2:3]])).text
    assert mixed.count("Real rods could keep nine of the 18 shapes") == 1
    assert mixed.count("; no real rod could keep these shapes") == 1  # of the other panel


def test_every_picture_is_inside_and_described(text, results) -> None:
    pictures = Page(text).pictures
    drawings = len(results) + 2  # the trade and the extremes
    assert len(pictures) == len(results) + 2 * drawings  # rods; a drawing for a wide and for a narrow place
    for picture in pictures:
        data = BytesIO(base64.b64decode(picture["src"].partition(",")[2]))
        assert image.imread(data, format="webp").ndim == 3
        assert len(picture["alt"]) > 10


def test_the_card_of_a_claim_and_the_table_of_readings_have_one_verdict(readings) -> None:
    study = load("fig7_5_forces").under("twist-first/tension/solid")
    stored = StoredStudy(in_memory.run(study).isel(F1=[0, 4, 8], F3=[0, 4, 8]))
    told = Page(report_document.html([ReportedStudy(stored)], readings)).text
    cells = {row["name"]: row["cells"] for row in law_cards.of_readings(readings)["rows"]}
    assert cells["twist-first/tension/solid"][4]["verdict"] == "not decided"
    assert re.search(r"Not decided: .*\(not decided\).*Fig. 7 \(5\)", told.partition("In the pictures")[0], re.DOTALL)
    assert "1 claim about an elastic rod on a cylinder: 1 not decided" in told
    assert "not tested along F₁: F₁ has no effect under this reading" in told
    assert "F1 has no effect" not in told
    assert set(stored_verdicts.verdicts_of_lines(stored, study.laws[0]).values.ravel()) == {"not decided"}
    assert stored_verdicts.is_refuted(0, stored.verdicts)


ROOT = Path(__file__).parents[2]
CLAIMS = (ROOT / "docs" / "explanation" / "claims.md").read_text(encoding="utf-8")
TOLD = [[cell.strip(" `") for cell in row.strip("|").split("|")] for row in CLAIMS.splitlines() if row.startswith("|")]


def test_the_page_on_the_claims_has_the_verdict_of_each_reading(readings) -> None:
    table = {row[0]: row[1:] for row in TOLD if row[0] in READINGS}
    told = [list(row) for row in readings["claim_verdict"].values.tolist()]
    assert table == dict(zip(READINGS, told, strict=True))
    failing = [claim for claim, *column in zip("12345", *table.values(), strict=True) if "false" in column]
    assert failing == [*"1345"]  # every claim except (2), as the page says


def test_the_page_on_the_claims_has_the_measured_numbers_of_each_law(results) -> None:
    own = [result for result in results if result.stored.verdicts]
    laws = [row for result in own for row in result.stored.verdicts]
    words = (law_words.law_in_words, law_words.measure, law_words.sentence)
    assert [row for row in TOLD[1:] if len(row) == 4][2:] == [[row["claim"], *(f(row) for f in words)] for row in laws]
    worst = {c: law_cards.worst([row["verdict"] for row in laws if row["claim"] == c]) for c in ("(3)", "(4)")}
    both = "(3), (4)", ", ".join(f"{claim} {verdict}" for claim, verdict in worst.items())
    sentences = {row[1]: (row[0], row[2]) for row in TOLD if len(row) == 3}
    for row in laws:
        claim = row["claim"]
        alone = claim, law_cards.worst([one["verdict"] for one in laws if one["claim"] == claim])
        assert sentences[row["source"]] == (both if claim in worst else alone)
    rods = sum(result.stored.ds["outcome"].size for result in own)
    assert sum(int(re.findall(r"(\d+) would lift off", result.stored.ds.attrs["caution"])[0]) for result in own) == rods
    through = sum(int(result.stored.ds["overlaps"].sum()) for result in own)
    told = " ".join(CLAIMS.split())
    assert f"of the {rods} rods of the five panels all would lift off" in told
    assert f" {through} pass through themselves" in told
    tally = law_words.tally_of(law_cards.claims_of([report_document._section(result, {}) for result in own]), "claim")
    false = max(line.count("| false ") for line in CLAIMS.splitlines() if re.match(r"\| `\w+-?\w*/", line))
    for page in ("README.md", "docs/index.md"):
        first = " ".join((ROOT / page).read_text(encoding="utf-8").partition("\n## ")[0].split())
        assert f"{tally.partition(': ')[2]}; in other readings up to {false} are false" in first, page
        assert f"none of the {rods} rods" in first, page
        assert f"all would lift off, and {through} pass through themselves" in first, page


def test_no_line_ends_inside_a_formula(text) -> None:
    shown = re.sub(r"<style>.*?</style>|<script.*?</script>", "", text, flags=re.DOTALL)
    assert "F₃\u00a0=\u00a010" in shown
    assert not re.search(r"\d [=<>→] [−\d]", shown)


def test_the_versions_are_those_of_all_files_and_where_they_differ_each_is_named(results) -> None:
    packages = json.loads(results[0].stored.ds.attrs["versions"])
    one = packages["rod-workbench"]
    assert f"this report as “rod workbench {one}, Figures" in Page(report_document.html(results[:2])).text
    older = json.dumps(packages | {"rod-workbench": "0.0.1"})
    mixed = [replace(results[0], stored=StoredStudy(results[0].stored.ds.assign_attrs(versions=older))), *results[1:3]]
    told = Page(report_document.html(mixed)).text
    each = f"0.0.1 (fig6) and {one} (fig7_1_modulus, fig7_2_radius)"
    assert f"this report as “rod workbench {each}, Figures" in told
    assert f"rod-workbench {each}" in told.partition("Made 20")[2]
    assert f"numpy {packages['numpy']}, " in told


def test_without_readings_the_report_says_so(results) -> None:
    assert "The readings were not computed." in report_document.html(results[:1])


@pytest.mark.slow
def test_a_study_that_a_reading_does_not_admit_is_named_with_its_reason(results, readings) -> None:
    told = report_document.html(results, readings, refusals=["Fig. 7 (4): its own end angle lies beyond 60 degrees"])
    assert "Fig. 7 (4): its own end angle lies beyond 60 degrees" in Page(told).text
    assert "Left out." not in Page(report_document.html(results, readings)).text


def test_below_a_diagram_stands_its_caption(results, tmp_path) -> None:
    for result in results[:2]:  # one rod, and rods along an axis
        pictures, caption = reproduce._draw(result.stored, tmp_path, able=False)
        assert any("seen from outside" in sentence for sentence in caption)
        text = Page(report_document.html([replace(result, pictures=pictures, caption=caption)])).text
        caution = labels.typeset(result.stored.caution)  # it has a paragraph of its own
        assert " ".join(sentence for sentence in caption if sentence != caution) in text
        assert text.count(caution) == 1


def test_what_a_study_says_is_text_and_not_markup(results) -> None:
    ds = results[0].stored.ds.assign_attrs(title="<script>alert(1)</script>")
    text = report_document.html([replace(results[0], stored=StoredStudy(ds))])
    assert "<script>alert" not in text


@pytest.mark.slow
def test_the_report_replaces_the_old_one_whole(results, measured, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(measured_runs, "comparisons", lambda folder: measured if folder == tmp_path else [])
    assert report_document.write(tmp_path, results[:1]) == tmp_path / "report.html"
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert 'id="extremes"' in (tmp_path / "report.html").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="cannot write"):
        report_document.write(tmp_path / "nowhere", results[:1])
    with pytest.raises(InputError, match="at least one study"):
        report_document.html([])


def test_a_drawing_is_packed_as_sharp_as_it_is(tmp_path) -> None:
    dots = np.random.default_rng(5).integers(0, 256, (20, 30, 3), dtype=np.uint8)
    image.imsave(tmp_path / "dots.png", dots)
    packed = report_document._picture(tmp_path / "dots.png", "dots", report_document.DRAWING)["src"].partition(",")[2]
    found = image.imread(BytesIO(base64.b64decode(packed)), format="webp")[..., :3].astype(int)
    assert np.abs(found - dots).max() <= 3  # of 255: of the colours alone something is lost, and no eye sees it
    assert {0, 255} <= set(found.ravel())


def test_a_picture_keeps_a_narrow_white_margin(tmp_path) -> None:
    pixels = np.ones((200, 300, 3))
    pixels[80:90, 120:140] = 0
    image.imsave(tmp_path / "dot.png", pixels)
    packed = report_document._picture(tmp_path / "dot.png", "dot", report_document.DRAWING)["src"].partition(",")[2]
    found = image.imread(BytesIO(base64.b64decode(packed)), format="webp")[..., 0]
    np.testing.assert_array_equal(found == 0, np.pad(np.ones((10, 20), bool), report_document.MARGIN))


@node.needs_node
def test_the_page_solves_the_stored_rod_of_table_1(results) -> None:
    (ds,) = [result.stored.ds for result in results if result.stored.attrs["study_name"] == "fig6"]
    data = report_document.figure_of(StoredStudy(ds))
    assert data["fields"] == ["E", "R", "beta", "F1", "F3"]
    script = """const s = rod_shape.marched(core, rod_case.caseOf(given.state, given.letters));
answer({ ...s.at(Float64Array.from(given.s)), end: s.z.at(-1) });"""
    found = node.run(script, data | {"s": ds["s"].values.tolist()}, ("rod_shape", "rod_case"))
    for name in ("beta", "alpha", "z"):
        np.testing.assert_allclose(found[name], ds[name], atol=1e-6)  # both solve to 1e-8, condition number 10
    assert found["end"] == pytest.approx(float(ds["height"]), abs=1e-6)


def test_a_reading_without_the_force_has_a_slider_for_the_twist(results) -> None:
    (ds,) = [result.stored.ds for result in results if result.stored.attrs["study_name"] == "fig6"]
    fields = report_document.figure_of(StoredStudy(ds.assign_attrs(reading="twist-first/tension/paper")))["fields"]
    assert fields == ["E", "R", "beta", "dgamma", "F3"]


def test_a_rod_without_a_shape_does_not_turn(results) -> None:
    (one,) = [result for result in results if result.stored.attrs["study_name"] == "fig7_1_modulus"]
    ds = small.with_outcomes(one.stored.ds, ["failed: for the test"] * 9)
    assert report_document.figure_of(StoredStudy(ds)) is None
    text = report_document.html([replace(one, stored=StoredStudy(ds))])
    assert 'class="turntable"' not in text


def test_paper_gets_the_still_picture_and_whole_tables(text) -> None:
    assert re.search(r"\.still \{ display: block !important", text)
    assert "overflow: visible" in text.partition("@page")[2].partition("</style>")[0]
    assert not re.search(r"table[^{}]*\{[^}]*min-width", text.partition("</style>")[0])  # as wide as a page of paper


@pytest.mark.slow
def test_a_run_beside_the_report_is_drawn_and_a_broken_one_gives_way(tmp_path, measured) -> None:
    for one in measured:
        assert "a run that comes with the workbench" in one.source
        assert re.search(r"Measured 20\d\d-\d\d-\d\d [\d:]+ UTC on \S+", one.source)
    ds = reading.read(measured_runs.SHIPPED / "trade.h5", study=False)
    writing.write(ds.isel(case=[0, 1]).assign_attrs(machine="a test"), tmp_path / "trade.h5")
    (tmp_path / "extremes.h5").write_bytes(b"no dataset")
    extremes, trade = measured_runs.comparisons(tmp_path)
    assert "on 2 rods" in trade.shows
    assert "on a test, with" in trade.source
    assert trade.source.endswith("trade.h5 beside this report")
    assert "extremes.h5 beside this report cannot be drawn" in extremes.source
    assert extremes.shows == measured[0].shows


@pytest.fixture(scope="module")
def shown(text, tmp_path_factory) -> Iterator[Any]:
    """The report in a browser, once its view is there."""
    path = tmp_path_factory.mktemp("shown") / "report.html"
    path.write_text(text, encoding="utf-8")
    with browser.chromium(tmp_path_factory.mktemp("chromium"), "1366,1400") as driver:
        driver.get(path.as_uri())
        driver.execute_script("document.querySelector('#turn-fig7_1_modulus').scrollIntoView()")
        comes_to(driver, "return !!document.querySelector('#turn-fig7_1_modulus').view")
        yield driver


def comes_to(driver: Any, condition: str) -> None:
    until(lambda: driver.execute_script(condition), lambda: driver.get_log("browser"))


FIGURE = "#turn-fig7_1_modulus"


def seen_in(driver: Any) -> np.ndarray:
    """The pixels of a turntable at rest."""
    driver.execute_script(f"document.querySelector('{FIGURE}').view.rest()")
    png = driver.find_element("css selector", f"{FIGURE} .view").screenshot_as_png
    return np.asarray(image.imread(BytesIO(png)))[..., :3]


@pytest.mark.slow
def test_in_a_browser_the_rod_is_drawn_turns_and_nobody_is_asked(shown) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    def azimuth() -> float:
        return shown.execute_script(f"return document.querySelector('{FIGURE}').view.camera.azimuth")

    front, at = seen_in(shown), azimuth()
    assert shares_of_push(front)[0] > 0.02  # where the cylinder would have to pull
    canvas = shown.find_element("css selector", f"{FIGURE} canvas.rod")
    ActionChains(shown, duration=20).drag_and_drop_by_offset(canvas, 80, 0).perform()
    assert azimuth() == pytest.approx(at - 80 * 0.008, abs=0.02)  # rad a pixel of a drag
    assert (np.abs(seen_in(shown) - front).max(axis=-1) > 0.1).mean() > 0.02
    slider = shown.find_element("css selector", f"{FIGURE} input")
    before = slider.get_attribute("aria-valuetext")
    slider.send_keys(Keys.ARROW_RIGHT)
    assert slider.get_attribute("aria-valuetext") == "14140 N/cm²" != before
    assert [entry["message"] for entry in shown.get_log("browser") if entry["level"] == "SEVERE"] == []
    own = ("file:", "data:", "blob:", "chrome:", "chrome-untrusted:")  # the last two are the browser's first page
    assert [url for url in browser.requests_of(shown) if not url.startswith(own)] == []


@pytest.mark.slow
def test_in_a_browser_a_picture_is_enlarged_and_closed(shown) -> None:
    shown.execute_script("document.querySelector('section.panel > figure button.enlarge').click()")
    assert shown.execute_script("return document.getElementById('enlarged').open")
    shown.execute_script("document.getElementById('enlarged').click()")
    assert not shown.execute_script("return document.getElementById('enlarged').open")


@pytest.mark.slow
def test_a_link_opens_the_section_that_it_points_at_and_paper_shows_all(shown) -> None:
    folded = "return [...document.querySelectorAll('section > details:not([open])')].map((one) => one.parentElement.id)"
    before = shown.execute_script(folded)
    shown.execute_script("document.querySelector('nav a[href=\"#errata\"]').click()")
    assert {*before} - {*shown.execute_script(folded)} == {"errata"}
    shown.execute_script("window.dispatchEvent(new Event('beforeprint'))")
    assert shown.execute_script(folded) == []


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_that_bars_people_from_the_report(shown, tmp_path, scheme) -> None:
    browser.emulate(shown, prefers_color_scheme=scheme)
    shown.execute_script("scrollTo(0, 0)")  # where the row of links covers no text
    assert browser.barriers(shown, browser.axe(tmp_path)) == []


@pytest.mark.slow
def test_in_the_dark_scheme_paper_stays_white(shown) -> None:
    paper_of = "return getComputedStyle(document.body).backgroundColor"
    browser.emulate(shown, prefers_color_scheme="dark")
    assert shown.execute_script(paper_of) != "rgb(255, 255, 255)"
    features = [{"name": "prefers-color-scheme", "value": "dark"}]
    shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": features})
    try:
        assert shown.execute_script(paper_of) == "rgb(255, 255, 255)"
    finally:
        shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})


def test_a_panel_with_two_rows_of_rods_is_known_as_tall(text, results) -> None:
    rows = {**results[0].pictures, "scene F3": results[0].pictures["scene"]}
    assert 'class="panel tall"' in report_document.html([replace(results[0], pictures=rows)])
    assert 'class="panel tall"' not in text


def test_a_row_of_rods_says_where_each_stands_so_that_the_slider_can_frame_it(results, tmp_path) -> None:
    (result,) = [result for result in results if result.stored.attrs["study_name"] == "fig7_1_modulus"]
    pixels = np.ones((100, 200, 3), dtype=np.uint8) * 255
    pixels[40:60, 20:180] = 0  # ink; 16 pixels of margin are kept around it
    info, path = PngImagePlugin.PngInfo(), tmp_path / "row.png"
    info.add_text("rods", json.dumps([[0.1 + 0.08 * k, 0.4, 0.18 + 0.08 * k, 0.6] for k in range(9)]))
    Image.fromarray(pixels).save(path, pnginfo=info)
    text = report_document.html([replace(result, pictures={"scene E": path})])
    axis, rods = re.search(r'data-axis="(\d)" data-rods="([^"]*)"', text).groups()
    assert axis == "0"
    assert len(json.loads(rods)) == 9
    assert json.loads(rods)[0] == pytest.approx([16 / 192, 16 / 52, 32 / 192, 36 / 52], abs=1e-3)
    assert 'class="turntable with-row"' in text


def test_the_rod_of_table_1_is_named_among_its_equilibria(results, tmp_path) -> None:
    ds = report_runs.run_equilibria(load("fig6"))
    assert (ds.sizes["equilibrium"], ds.attrs["rank_of_study"], ds.attrs["rank_of_stable"]) == (13, 13, 1)
    told = Page(report_document.html(results[:1], equilibria=(StoredStudy(ds), {}))).text
    told = re.sub(r"\s+", " ", told)
    assert "is number 13 of 13, unstable in 6 ways. Number 1 is stable" in told
    top = told.partition("In the pictures the tube")[0]
    assert "ways. Disturbed on the cylinder, it would leave this shape for a stable one, such as number 1." in top
    assert report_runs.pair(StoredStudy(ds))["index"].values.tolist() == [0, 6]


LETTERS = """return [...document.querySelectorAll(".panel")].map((panel) => {
  const size = (one) => Math.min(one.clientWidth / one.naturalWidth, one.clientHeight / one.naturalHeight) * 200 / 96;
  const seen = [...panel.querySelectorAll("img")].filter((one) => one.clientWidth);
  return [panel.id, panel.scrollHeight, ...seen.map((one) => (one.matches(".narrow") ? 7 : 8) * size(one))];
})"""  # points of the smallest letters of a row of rods and of a drawing, which have 200 pixels an inch


@pytest.mark.slow
def test_on_paper_a_panel_fits_one_page_and_its_letters_have_six_points(shown) -> None:
    size = {"width": 695, "height": 1000, "deviceScaleFactor": 1, "mobile": False}  # 184 mm
    shown.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": []})
    try:
        panels = shown.execute_script(LETTERS)
    finally:
        shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})
        shown.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert [name for name, *_ in panels] == list(HIGH)
    for name, filled, scene, drawing in panels:
        assert filled <= 275 * 96 / 25.4, name
        assert min(scene, drawing) >= 6, name


def test_only_a_touch_screen_is_told_to_tap(text) -> None:
    style_ = text.partition("<style>")[2].partition("</style>")[0]
    (line,) = [line for line in style_.splitlines() if "tap to enlarge" in line]
    assert line.startswith("@media screen and (hover: none) and (pointer: coarse) {")


def test_beside_each_turntable_stand_the_observables_of_its_rod(text, results) -> None:
    figures = json.loads(Page(text).packed["data"])["figures"]
    (one,) = [result for result in results if result.stored.attrs["study_name"] == "fig7_1_modulus"]
    cases = figures["turn-fig7_1_modulus"]["cases"]
    told = [dict(case["facts"])["number of bends"] for case in cases]
    assert told == [str(int(count)) for count in one.stored.ds["bends"].values]


@pytest.mark.slow
def test_on_a_phone_the_page_is_no_wider_than_the_screen_and_letters_of_pictures_have_nine_pixels(shown) -> None:
    size = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    shown.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    assert shown.execute_script("return document.documentElement.scrollWidth") == 390
    for name, _, *points in shown.execute_script(LETTERS):
        assert min(points) * 96 / 72 > 9, name


@pytest.mark.slow
def test_a_turntable_comes_back_after_a_lost_drawing_context(shown) -> None:
    shown.execute_script(f"document.querySelector('{FIGURE}').scrollIntoView()")
    before = seen_in(shown)
    canvas = f"document.querySelector('{FIGURE} canvas.rod')"
    shown.execute_script(f"window.lose = {canvas}.getContext('webgl2').getExtension('WEBGL_lose_context')")
    told = f"document.querySelector('{FIGURE} .lost').textContent"
    shown.execute_script("lose.loseContext()")
    comes_to(shown, f"return {told}.includes('stopped drawing')")
    shown.execute_script("lose.restoreContext()")
    comes_to(shown, f"return {told} === ''")
    np.testing.assert_allclose(seen_in(shown), before, atol=0.02)


def test_the_report_says_what_the_rods_would_do_or_what_to_install(results) -> None:
    page = Page(report_document.html(results, release="it needs a package"))
    assert "The rods were not let go: it needs a package." in page.text
    ds = small.study_dataset(report_runs.LET_GO)
    page = Page(report_document.html(results, release=report_runs.release(load(report_runs.LET_GO), StoredStudy(ds))))
    assert "What these rods would do" in page.text
    assert page.rows[report_runs.LET_GO] == 1 + ds["outcome"].size
    for gap in ds["gap_max"].values:
        assert f"{gap:.2f}" in page.text
    assert "7.1 ± 7.1 %" in page.text, "a share is told with its error"
    assert "At most 1 of them keeps a stretch" in page.text


@pytest.mark.slow
def test_on_a_phone_a_label_of_the_rods_let_go_and_its_value_share_a_line(results, tmp_path) -> None:
    ds = small.study_dataset(report_runs.LET_GO)
    release = report_runs.release(load(report_runs.LET_GO), StoredStudy(ds))
    (tmp_path / "report.html").write_text(report_document.html(results, release=release), encoding="utf-8")
    with browser.chromium(tmp_path / "chromium", "390,844") as driver:
        size = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        driver.get((tmp_path / "report.html").as_uri())
        heights = driver.execute_script(
            "return [...document.querySelectorAll('#let_go td')].map((cell) => cell.clientHeight /"
            "parseFloat(getComputedStyle(cell).lineHeight))"
        )
    assert heights
    assert max(heights) < 2
