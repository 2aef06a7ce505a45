"""The report: one file with everything in it, on machines with and without OpenGL."""

import base64
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
import xarray as xr

from solver.errors import InputError
from studies import READINGS, load, names
from workbench import check, gl, readings_run, report, runner
from workbench.errata import ERRATA
from workbench.runner import StudyResult

ADVICE = "OpenGL does not work here, so no scenes are drawn; install libegl1 libgl1-mesa-dri"
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
        self.open: list[str] = []
        self.section = ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs) -> None:
        found = dict(attrs)
        self.links += [found[name] for name in ("href", "src", "srcset", "action") if name in found]
        if tag == "img":
            self.pictures.append(found)
        if "id" in found:
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


@pytest.fixture(scope="module")
def readings() -> xr.Dataset:
    return readings_run.run()


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> list[StudyResult]:
    folder = tmp_path_factory.mktemp("pictures")
    found = []
    for name in names():
        ds = runner.run(load(name))
        pictures = {part: folder / f"{name}_{part}.png" for part in ("figure", "scene")}
        for path in pictures.values():
            path.write_bytes(DOT)
        found.append(replace(runner.result(load(name), ds, folder / f"{name}.h5"), pictures=pictures))
    return found


@pytest.fixture(scope="module")
def text(results, readings) -> str:
    return report.html(results, readings)


def without_scenes(results: list[StudyResult]) -> list[StudyResult]:
    return [replace(result, pictures={"figure": result.pictures["figure"]}) for result in results]


def test_nothing_outside_the_file_is_needed(text) -> None:
    page = Page(text)
    assert all(link.startswith(("#", "data:image/")) for link in page.links)
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    assert not re.search(r"https?:|@import|url\(|<script|<link", text)


def test_every_section_is_there(text) -> None:
    assert Page(text).ids == [*names(), "laws", "readings", "errata", "sources"]


def test_every_picture_is_inside_and_described(text, results) -> None:
    pictures = Page(text).pictures
    assert len(pictures) == sum(len(result.pictures) for result in results)
    for picture in pictures:
        assert base64.b64decode(picture["src"].partition(",")[2]) == DOT
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
    assert rows["sources"] == 1 + len(names())


def test_verdicts_are_words_and_colours(text, readings) -> None:
    cells = re.findall(r'<td class="(holds|trend|fails)"[^>]*><span class="mark (\w+)">([^<]+)</span>', text)
    assert len(cells) == 12 * 5
    assert all(outer == inner == report.CLASSES[word] for outer, inner, word in cells)
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
            assert f": {check.measured(row)}, {row['verdict']}" in top
            if row["lines"] > 1:
                assert f"{row['lines_hold']} of {row['lines']} lines hold" in top
    level = [r for result in results for r in result.verdicts if r["direction"] == "not-falling"]
    assert level  # claim (4), whose sentence says increase
    for row in level:
        assert (row["reason"] == "it does not change") == (row["first"] == row["last"])


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
    page = Page(report.html(without_scenes(results), readings, ADVICE))
    assert page.text.count("No picture of the scene.") == len(results)
    assert "libegl1 libgl1-mesa-dri" in page.text
    assert len(page.pictures) == len(results)


def test_without_readings_the_report_says_so(results) -> None:
    assert "The readings were not run." in report.html(results[:1])


def test_a_study_that_a_reading_does_not_admit_is_named_with_its_reason(results, readings) -> None:
    told = report.html(results, readings, refusals=["Fig. 7 (4): its own end angle lies beyond 60 degrees"])
    assert "Fig. 7 (4): its own end angle lies beyond 60 degrees" in Page(told).text
    assert "Left out." not in Page(report.html(results, readings)).text


def test_what_a_study_says_is_text_and_not_markup(results) -> None:
    ds = results[0].ds.assign_attrs(title="<script>alert(1)</script>")
    text = report.html([replace(results[0], ds=ds)])
    assert "<script>" not in text


def test_the_report_replaces_the_old_one_whole(results, tmp_path) -> None:
    assert report.write(results[:1], tmp_path) == tmp_path / "report.html"
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    with pytest.raises(InputError, match="cannot write"):
        report.write(results[:1], tmp_path / "nowhere")
    with pytest.raises(InputError, match="at least one study"):
        report.html([])


def test_on_a_machine_without_opengl_everything_else_is_done(readings, monkeypatch, tmp_path: Path, capsys) -> None:
    from workbench import reproduce

    # VTK would end this very process, as it does there
    monkeypatch.setattr(gl, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    monkeypatch.setitem(sys.modules, "workbench.scenes", None)
    monkeypatch.setattr(reproduce.readings_run, "run", lambda panels, step: readings)  # seconds saved
    gl.probe.cache_clear()
    try:
        assert reproduce.reproduce(tmp_path, None) == 0
    finally:
        gl.probe.cache_clear()
    assert "libegl1 libgl1-mesa-dri" in capsys.readouterr().out
    for name in names():
        assert (tmp_path / f"{name}.h5").exists()
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert not list(tmp_path.glob("*scene*"))
    assert "libegl1 libgl1-mesa-dri" in (tmp_path / "report.html").read_text(encoding="utf-8")
