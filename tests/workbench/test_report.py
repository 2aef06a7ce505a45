"""The report: one file with everything in it, on machines with and without OpenGL."""

import base64
import gzip
import json
import re
import shutil
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from importlib.util import find_spec
from io import BytesIO
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib import image

from solver.problem.errors import InputError
from studies import READINGS, load, names
from tests.workbench import small
from tests.workbench.pictures import share_of_hue
from workbench.data import labels, law_verdicts, writing
from workbench.figures import style
from workbench.run import in_memory
from workbench.run.in_memory import StudyResult
from workbench.scene import opengl
from workbench.web import browser_assets
from workbench.web.report import document, interactive_view, measured_runs, readings_table
from workbench.web.report.errata import ERRATA

ADVICE = "OpenGL does not work here, so no scenes are drawn; install libegl1 libgl1-mesa-dri"
BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1366,1400")  # fmt: skip
PAPER = [name for name in names() if name.startswith("fig")]  # the studies of the report
PATIENCE = 600  # s that anything is waited for, on a machine with much else to do
needs_explore = pytest.mark.skipif(
    not (find_spec("trame_client") and find_spec("trame_vtk")), reason="pip install '.[explore]'"
)
DOT = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


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
        if tag == "img":
            self.pictures.append(found)
        if tag == "script" and "id" in found:
            self.packed[found["id"]] = ""
        elif "id" in found:
            self.ids.append(found["id"])
            self.section = found["id"]
        if tag == "tr":
            self.rows[self.section] = self.rows.get(self.section, 0) + 1
        if tag not in {"img", "meta", "br"}:
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data) -> None:
        if self.open and self.open[-1] not in {"style", "script"}:
            self.text += data
        elif self.open and self.open[-1] == "script" and self.packed:
            last = list(self.packed)[-1]
            self.packed[last] += "" if "figure" in data else data


@pytest.fixture(scope="module")
def readings() -> xr.Dataset:
    return readings_table.run()


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> list[StudyResult]:
    folder = tmp_path_factory.mktemp("pictures")
    found = []
    for name in PAPER:
        ds = in_memory.run(load(name))
        pictures = {part: folder / f"{name}_{part}.png" for part in ("figure", "scene")}
        for path in pictures.values():
            path.write_bytes(DOT)
        found.append(replace(in_memory.result(load(name), ds, folder / f"{name}.h5"), pictures=pictures))
    return found


@pytest.fixture(scope="module")
def measured(tmp_path_factory) -> list[measured_runs.Measured]:
    return measured_runs.both(tmp_path_factory.mktemp("nothing"))


@pytest.fixture(scope="module")
def text(results, readings, measured) -> str:
    return document.html(results, readings, measured=measured)


def without_scenes(results: list[StudyResult]) -> list[StudyResult]:
    return [replace(result, pictures={"figure": result.pictures["figure"]}) for result in results]


def test_nothing_outside_the_file_is_needed(text) -> None:
    page = Page(text)
    assert all(link.startswith(("#", "data:image/")) for link in page.links)
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    own = re.sub(r'<script type="text/plain".*?</script>', "", text, flags=re.DOTALL)
    assert not re.search(r"https?:|@import|url\(|<link|src=\"(?!data:)", own)
    assert "default-src 'none'" in own  # nor may what is unpacked ask for anything
    assert len(text) < 8e6


def test_every_section_is_there(text) -> None:
    assert Page(text).ids == [*PAPER, "laws", "readings", "trade", "extremes", "errata", "sources"]


def test_every_picture_is_inside_and_described(text, results) -> None:
    pictures = Page(text).pictures
    assert len(pictures) == sum(len(result.pictures) for result in results) + 2  # the trade and the extremes
    for picture in pictures:
        data = BytesIO(base64.b64decode(picture["src"].partition(",")[2]))
        assert image.imread(data, format="webp").ndim == 3
        assert len(picture["alt"]) > 10


def test_each_study_tells_what_no_real_rod_could_do(text: str, results) -> None:
    for result in results:
        assert result.ds.attrs["caution"]
        assert result.ds.attrs["caution"].replace("kappa", "κ") in Page(text).text


def test_tables_are_complete(text, results) -> None:
    rows = Page(text).rows
    laws = [row for result in results for row in result.verdicts]
    assert rows["laws"] == 1 + len(laws) + sum(len(row["also"]) for row in laws)
    assert rows["readings"] == 1 + len(READINGS) == 13
    assert rows["errata"] == 1 + len(ERRATA)
    assert rows["sources"] == 1 + len(PAPER)


def test_verdicts_are_words_and_colours(text, readings) -> None:
    kinds = "|".join(document.CLASSES.values())
    cells = re.findall(rf'<td class="({kinds})"[^>]*><span class="mark (\w+)">([^<]+)</span>', text)
    assert len(cells) == 12 * 5
    assert all(outer == inner == document.CLASSES[word] for outer, inner, word in cells)
    assert [word for *_, word in cells] == readings["claim_verdict"].values.ravel().tolist()


def test_the_paper_is_quoted_and_its_fold_named(text, results) -> None:
    page = Page(text).text
    for result in results:
        for law in result.study.laws:
            assert law.source in page
    (note,) = [result.ds.attrs["fold_note"] for result in results if "fold_note" in result.ds.attrs]
    value = re.search(r"beta\(L\) = ([\d.]+) rad \(([\d.]+) deg\)", note)
    assert f"The equilibrium ceases to exist at β(L) = {value[1]} rad ({value[2]}°), where β′(0) = " in page


def test_each_claim_stands_on_top_with_the_words_and_values_of_its_laws(text, results) -> None:
    top = Page(text).text.partition("Sections")[0].partition("The tube has")[0]
    for result in results:
        for row in result.verdicts:
            assert f": {law_verdicts.measured(row)}, {row['verdict']}" in top
            assert labels.law_text(row, law_verdicts.detail(row)) in top
            if row["lines"] > 1:
                assert f"of {row['lines']} lines {row['lines_hold']} hold, " in top
    rows = [row for result in results for row in result.verdicts]
    assert law_verdicts.tallied(rows) in top
    level = [r for result in results for r in result.verdicts if r["direction"] == "not-falling"]
    assert level  # claim (4), whose sentence says increase
    for row in level:
        assert (row["qualifications"] == ["not contradicted"]) == (row["first"] == row["last"])


def test_the_report_says_which_rules_were_fixed_in_advance_and_which_after(text, results) -> None:
    laws = text.partition('<section id="laws">')[2].partition("</section>")[0]
    page = Page(laws).text
    for result in results:
        for row in result.verdicts:
            assert row["fixed_note"] in page
    told = re.findall(r"<td>(in advance|after|not stated)<", laws)
    assert told == [row["fixed"] for result in results for row in result.verdicts]
    assert told.count("after") == 2


def linear(colour: str) -> Any:
    """A colour as light, (red, green, blue)."""
    value = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def lab(light: Any) -> Any:
    """CIE L*a*b* of light, white at D65."""
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    share = to_xyz @ np.clip(light, 0, 1) / [0.9505, 1.0, 1.089]
    x, y, z = np.where(share > 0.008856, np.cbrt(share), 7.787 * share + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


# how light reaches those who lack one kind of cone: Machado, Oliveira and Fernandes (2009), severity 1
SEEN = {
    "all cones": np.eye(3),
    "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
}


@pytest.mark.parametrize("eye", SEEN)
def test_the_colours_of_verdicts_are_told_apart_by_every_eye_and_read_on_white(eye: str) -> None:
    colours = {verdict: linear(colour) for verdict, colour in style.VERDICT_COLOURS.items()}
    assert list(colours) == list(document.CLASSES)
    for light in colours.values():
        assert 1.05 / (light @ [0.2126, 0.7152, 0.0722] + 0.05) >= 4.5  # what WCAG asks of text
    shown = [lab(np.array(SEEN[eye]) @ light) for light in colours.values()]
    apart = [np.linalg.norm(a - b) for a, b in combinations(shown, 2)]
    assert min(apart) > 20  # ten times what is just noticed


def test_no_sentence_is_left_in_plain_letters(text) -> None:
    shown = re.sub(r"<pre>.*?</pre>|<code>.*?</code>", "", text, flags=re.DOTALL)
    words = Page(shown).text.partition("Errata of the paper")[0]
    assert not re.search(r"\bbeta\b|\bdeg\b|kappa|limit must", words)
    assert "The rod itself already ends at β(L) = " in words  # one reading does not admit panel (4)


def test_of_one_rod_its_index_and_whether_it_meets_itself_are_told(results, text) -> None:
    (one,) = [result.ds for result in results if result.study.name == "fig6"]
    assert f"Morse index, 0 where stable{int(one['index'])}" in Page(text).text
    assert f"passes through itself{'yes' if one['overlaps'] else 'no'}" in Page(text).text


def test_versions_and_errata_are_told(text) -> None:
    page = Page(text).text
    for word in ("python", "numpy", "scipy", "xarray", "workbench reproduce", *(row.where for row in ERRATA)):
        assert word in page


def test_without_opengl_a_note_says_what_to_install(results, readings) -> None:
    page = Page(document.html(without_scenes(results), readings, ADVICE))
    assert page.text.count("No picture of the scene.") == len(results)
    assert "libegl1 libgl1-mesa-dri" in page.text
    assert len(page.pictures) == len(results)


def test_without_readings_the_report_says_so(results) -> None:
    assert "The readings were not computed." in document.html(results[:1])


def test_a_study_that_a_reading_does_not_admit_is_named_with_its_reason(results, readings) -> None:
    told = document.html(results, readings, refusals=["Fig. 7 (4): its own end angle lies beyond 60 degrees"])
    assert "Fig. 7 (4): its own end angle lies beyond 60 degrees" in Page(told).text
    assert "Left out." not in Page(document.html(results, readings)).text


def test_what_a_study_says_is_text_and_not_markup(results) -> None:
    ds = results[0].ds.assign_attrs(title="<script>alert(1)</script>")
    text = document.html([replace(results[0], ds=ds)])
    assert "<script>alert" not in text


def test_the_report_replaces_the_old_one_whole(results, measured, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(measured_runs, "both", lambda folder: measured if folder == tmp_path else [])
    assert document.write(results[:1], tmp_path) == tmp_path / "report.html"
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert 'id="extremes"' in (tmp_path / "report.html").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="cannot write"):
        document.write(results[:1], tmp_path / "nowhere")
    with pytest.raises(InputError, match="at least one study"):
        document.html([])


@pytest.mark.slow
def test_on_a_machine_without_opengl_everything_else_is_done(readings, monkeypatch, tmp_path: Path, capsys) -> None:
    from workbench.commands.reproduce import reproduce

    # VTK would end this very process, as it does there
    monkeypatch.setattr(opengl, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    monkeypatch.setitem(sys.modules, "workbench.scene.layout", None)
    monkeypatch.setattr(readings_table, "run", lambda panels, step: readings)  # seconds saved
    opengl.probe.cache_clear()
    try:
        assert reproduce(tmp_path) == 0
    finally:
        opengl.probe.cache_clear()
    assert "libegl1 libgl1-mesa-dri" in capsys.readouterr().out
    for name in PAPER:
        assert (tmp_path / f"{name}.h5").exists()
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert not list(tmp_path.glob("*scene*"))
    assert "libegl1 libgl1-mesa-dri" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_drawing_is_packed_without_loss(tmp_path) -> None:
    dots = np.random.default_rng(5).integers(0, 256, (20, 30, 3), dtype=np.uint8)
    image.imsave(tmp_path / "dots.png", dots)
    packed = document._picture(tmp_path / "dots.png", "dots", document.DRAWING)["src"].partition(",")[2]
    np.testing.assert_array_equal(image.imread(BytesIO(base64.b64decode(packed)), format="webp")[..., :3], dots)


@needs_explore
def test_the_scene_that_turns_is_the_stored_rod(text, results) -> None:
    packed = {name: gzip.decompress(base64.b64decode(data)).decode() for name, data in Page(text).packed.items()}
    for name, path in browser_assets.scripts().items():
        assert packed[name] == path.read_text(encoding="utf-8")
    (ds,) = [result.ds for result in results if result.study.name == "fig6"]
    parts = {part["name"]: part for part in json.loads(packed["scene"])["parts"]}
    assert set(parts) == {"wall", "pushed", "lifted"}
    rod = np.concatenate([np.reshape(parts[name]["points"], (-1, 3)) for name in ("pushed", "lifted")])
    a, rho = float(ds["a"]), float(ds["rho"])
    reach = rho + a
    for name, part in parts.items():
        polygons = np.reshape(part["polygons"], (-1, 4))
        assert (polygons[:, 0] == 3).all()
        assert polygons[:, 1:].max() == len(part["points"]) // 3 - 1, name
        np.testing.assert_allclose(
            np.linalg.norm(np.reshape(part["normals"], (-1, 3)), axis=1), 1, atol=2e-3
        )  # rounded
    far = np.hypot(rod[:, 0], rod[:, 1]) * reach
    # the tube touches the cylinder and is as thick as the rod; points are rounded to 1e-4 of the reach
    assert far.min() == pytest.approx(rho - a, abs=2e-4 * reach)
    assert far.max() == pytest.approx(rho + a, abs=2e-4 * reach)


def test_without_the_extra_the_still_picture_stays_and_the_report_says_so(results, readings, monkeypatch) -> None:
    monkeypatch.setattr(browser_assets, "FILES", {"vtk.js": ("no_such_package", "vtk.js")})
    page = Page(document.html(results, readings))
    assert "still picture only: vtk.js is not installed: pip install 'rod-workbench[explore]'" in page.text
    assert page.packed == {}
    assert len(page.pictures) == sum(len(result.pictures) for result in results)


def test_a_rod_without_a_shape_does_not_turn(results) -> None:
    (one,) = [result for result in results if result.study.name == "fig6"]
    ds = small.with_outcomes(one.ds, "failed: for the test")
    if find_spec("trame_vtk"):
        with pytest.raises(InputError, match="failed: for the test"):
            interactive_view.view(ds)


def test_paper_gets_the_still_picture_and_whole_tables(text) -> None:
    paper = text.partition("@media print {")[2].partition("</style>")[0]
    assert re.search(r"\.turns\.live \.viewport[^}]*display: none", paper)
    assert re.search(r"\.turns\.live \.still \{ display: block", paper)
    assert "overflow: visible" in paper
    # wider than a page of paper only on a screen
    assert all(rule.startswith("@media screen") for rule in re.findall(r"@media[^{]*\{[^\n]*min-width", text))


def test_a_run_beside_the_report_is_drawn_and_a_broken_one_gives_way(tmp_path, measured) -> None:
    for one in measured:
        assert "a run that comes with the workbench" in one.source
        assert re.search(r"Measured 20\d\d-\d\d-\d\d [\d:]+ UTC on \S+", one.source)
    ds = writing.read(measured_runs.SHIPPED / "trade.h5", study=False)
    writing.write(ds.isel(case=[0, 1]).assign_attrs(machine="a test"), tmp_path / "trade.h5")
    (tmp_path / "extremes.h5").write_bytes(b"no dataset")
    trade, extremes = measured_runs.both(tmp_path)
    assert "on 2 rods" in trade.shows
    assert "on a test, with" in trade.source
    assert trade.source.endswith("trade.h5 beside this report")
    assert "extremes.h5 beside this report cannot be drawn" in extremes.source
    assert extremes.picture == measured[1].picture


@pytest.fixture(scope="module")
def shown(text, tmp_path_factory) -> Iterator[Any]:
    """The report in a browser, once its view is there."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="pip install '.[test]'")
    if not (BROWSER and DRIVER):
        pytest.skip("there is no Chromium here: apt-get install chromium chromium-driver")
    path = tmp_path_factory.mktemp("shown") / "report.html"
    path.write_text(text, encoding="utf-8")
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    try:
        driver.get(path.as_uri())
        driver.execute_script("document.querySelector('figure.turns').scrollIntoView()")
        end = time.monotonic() + PATIENCE
        while not driver.execute_script("return !!document.querySelector('figure.turns').view"):
            assert time.monotonic() < end, driver.get_log("browser")
            time.sleep(0.05)
        yield driver
    finally:
        driver.quit()


@needs_explore
def test_in_a_browser_the_rod_is_drawn_turns_and_nobody_is_asked(shown) -> None:
    def seen() -> np.ndarray:
        png = shown.find_element("css selector", ".turns .viewport").screenshot_as_png
        return np.asarray(image.imread(BytesIO(png)))[..., :3]

    front = seen()
    assert share_of_hue(front, style.LIFTED) > 0.02
    assert share_of_hue(front, style.PUSHED) > 0.005
    from selenium.webdriver.common.action_chains import ActionChains

    hand = ActionChains(shown, duration=20)  # ms a move; vtk.js takes moves 200 ms apart for different ones
    hand = hand.move_to_element(shown.find_element("css selector", ".turns .viewport")).click_and_hold()
    for _ in range(10):
        hand = hand.move_by_offset(15, 6)
    hand.pause(0.3).release().perform()
    dragged = seen()
    assert (np.abs(dragged - front).max(axis=-1) > 0.1).mean() > 0.02
    shown.find_element("name", "front").click()
    np.testing.assert_allclose(seen(), front, atol=0.02)  # a shade in 255 or two
    shown.find_element("name", "side").click()
    side = seen()
    assert (np.abs(side - front).max(axis=-1) > 0.1).mean() > 0.02
    shown.find_element("name", "nearer").click()
    assert share_of_hue(seen(), style.LIFTED) > 1.1 * share_of_hue(side, style.LIFTED)
    assert not shown.find_element("css selector", ".turns .still").is_displayed()
    shown.find_element("name", "still").click()
    assert shown.find_element("css selector", ".turns .still").is_displayed()
    assert [entry["message"] for entry in shown.get_log("browser") if entry["level"] == "SEVERE"] == []
    messages = [json.loads(entry["message"])["message"] for entry in shown.get_log("performance")]
    asked = {m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"}
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:", "chrome://"))] == []


@needs_explore
def test_on_a_phone_the_page_is_no_wider_than_the_screen(shown) -> None:
    shown.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    )
    assert shown.execute_script("return document.documentElement.scrollWidth") == 390
