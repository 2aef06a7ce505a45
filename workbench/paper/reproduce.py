"""The command reproduce: Fig. 6 and all of Fig. 7, from Table 1 to one report."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError

from ..commands import console, tables
from ..commands.options import Reading, option
from ..commands.stored_words import print_verdicts

if TYPE_CHECKING:
    from studies import Study

    from ..stored.stored_study import StoredStudy
    from .sources import ReportedStudy

RODS = "fig6"  # the study of the rod of Table 1
STORY = "story.png"
FIGURES = "fig"  # the shipped studies whose names begin so are figures of the paper


def reproduce(
    out: Annotated[Path, option("FOLDER", "Folder for data, pictures and report.", "--out", "-o")] = Path("results"),
    reading: Reading = None,
) -> int:
    """Reproduce Figures 6 and 7 of the paper from Table 1.

    Solves, stores, draws and judges every panel and writes report.html. A panel that is already complete in the
    folder is not solved again. Exit status 1 if a panel is omitted, a case is unsolved, or a law is false or not
    decided; a law that is true in part gives 0, because under every reading of the paper some laws are.
    """
    from studies import READINGS, load, names

    from ..run import writing
    from ..stored import stored_verdicts
    from ..stored.stored_study import StoredStudy
    from . import report_runs

    studies = [load(name).under(reading) for name in names() if name.startswith(FIGURES)]
    with writing.folder_of_results(out):
        files = {study.name: out / f"{study.name}.h5" for study in studies}
        for name, path in {**files, **{name: out / f"{name}.h5" for name in report_runs.NAMES}}.items():
            writing.check_free(path, name, force=False)
        from ..scene import opengl
        from . import report_document  # drawing libraries are imported once all input is checked

        able, advice = opengl.probe()
        advice = "" if able else advice
        panels = report_runs.panels()
        with console.progress(len(studies) * 2 + len(panels) * len(READINGS) + 1) as step:
            results, refusals = _results(studies, files, out, able, step)
            readings = StoredStudy(report_runs.run_readings(panels, step=step))
            writing.write(readings.ds, out / f"{report_runs.READINGS_TABLE}.h5")
            step("writing the report")
            equilibria = _equilibria(load(RODS).under(reading), out, able)
            story = _draw_story(results, readings, out / STORY)
            release = _release(load(report_runs.LET_GO).under(reading), out)
            report_document.write(
                out, results, readings=readings, refusals=refusals, equilibria=equilibria, story=story, release=release
            )
        _print(results, readings, out, advice)
        for refusal in refusals:
            console.say(f"Omitted: {refusal}")
        judged = [result.stored for result in results]
        refuted = any(stored_verdicts.is_refuted(stored.unsolved, stored.verdicts) for stored in judged)
        return 1 if refusals or refuted else 0


def _results(
    studies: "Sequence[Study]", files: dict[str, Path], out: Path, able: bool, step: Any
) -> "tuple[list[ReportedStudy], list[str]]":
    """Solve, store and draw each study; the results, and a sentence for each study that its reading does not admit."""
    from ..run import run_and_resume
    from ..stored import reading
    from .sources import ReportedStudy

    results, refusals = [], []
    for study in studies:
        step(f"solving {study.name}")
        try:
            run_and_resume.run_to_file(study, files[study.name])
        except InputError as error:
            refusals.append(f"{study.title}: {error}")
            step("")
            continue
        step(f"drawing {study.name}")
        stored = reading.read_stored(files[study.name])
        results.append(ReportedStudy(stored, files[study.name], *_draw(stored, out, able)))
    return results, refusals


def _equilibria(study: "Study", out: Path, able: bool) -> "tuple[StoredStudy, dict[str, Path]] | None":
    """Store the equilibria of the rod of Table 1 and draw it beside the stable one; None where it has no shape."""
    from ..run import writing
    from ..stored.stored_study import StoredStudy
    from . import report_runs

    try:
        stored = StoredStudy(report_runs.run_equilibria(study))
    except InputError:
        return None
    writing.write(stored.ds, out / f"{report_runs.EQUILIBRIA}.h5")
    if not able or not stored.attrs[report_runs.OWN]:
        return stored, {}
    from ..scene import layout

    pair = report_runs.pair(stored).with_title("")
    return stored, layout.draw(pair, out / f"{report_runs.EQUILIBRIA}_scene.png")


def _release(study: "Study", out: Path) -> dict[str, Any] | str:
    """Store the rods of a study that are let go; what the report says of them, or why there are none."""
    from ..run import run_and_resume
    from ..stored import reading
    from . import report_runs

    file = out / f"{study.name}.h5"
    try:
        run_and_resume.run_to_file(study, file)
    except InputError as error:
        return str(error)
    return report_runs.release(study, reading.read_stored(file))


def _draw(stored: "StoredStudy", out: Path, able: bool) -> tuple[dict[str, Path], list[str]]:
    """Draw one dataset: name -> file, scenes only if OpenGL works; and the sentences of the caption of the diagram."""
    from ..figures import canvas, figure_kinds
    from ..figures.sheet import COLUMN
    from . import report_document

    name, verdicts = stored.attrs["study_name"], stored.verdicts
    stored = stored.with_title("")  # the report gives the title, once
    pictures = {"figure": out / f"{name}.png"}
    kind = figure_kinds.kind_without_map(stored)
    known: dict[str, Any] = {"verdicts": verdicts} if kind == "lines" else {}
    fig = figure_kinds.figure(stored, kind, **known)
    canvas.save(fig, pictures["figure"])
    with suppress(InputError):  # where it is too low in print
        canvas.save(figure_kinds.figure(stored, kind, COLUMN, **known), report_document.column_of(pictures["figure"]))
    if able:
        from ..scene import layout

        pictures |= layout.draw(stored, out / f"{name}_scene.png")
    return pictures, canvas.caption(fig, advice=False)


def _draw_story(results: "list[ReportedStudy]", readings: "StoredStudy", path: Path) -> Path | None:
    """Draw the figure of the whole story and return its file; None where the reading leaves a study out."""
    from ..figures import canvas
    from ..figures.sheet import COLUMN, sheet
    from . import report_document, story

    files = [*(result.stored for result in results), readings]
    datasets = {str(stored.attrs["study_name"]): stored for stored in files}
    if not set(story.NEEDED) <= set(datasets):
        return None
    for file, of in ((path, sheet("paper", titled=False)), (report_document.column_of(path), COLUMN)):
        canvas.save(story.figure(datasets, of), file, dpi=300)
    return path


def _print(results: "list[ReportedStudy]", readings: "StoredStudy", out: Path, advice: str) -> None:
    verdicts = [row for result in results for row in result.stored.verdicts]
    print_verdicts(verdicts, title=results[0].stored.reading)
    console.say("")
    claims = [str(claim) for claim in readings["claim"].values]
    heads = ["twist from", "F₃₀", "stiffness", *claims]
    tables.print_table(heads, _verdict_rows(readings), title="The claims in each reading of Table 1")
    unsolved = sum(result.stored.unsolved for result in results)
    cases = sum(result.stored.cases for result in results)
    console.say("")
    console.say(f"{cases} cases, {unsolved} unsolved")
    console.say(f"all files are in {out}, the report is {out / 'report.html'}")
    if advice:
        console.say(f"The scenes are omitted: {advice}")


def _verdict_rows(readings: "StoredStudy") -> list[list[str]]:
    """One row for each reading: the verdict of each claim."""
    from studies.laws.line_verdicts import TREND
    from studies.paper.readings import parse

    table = zip(readings["reading"].values, readings["claim_verdict"].values, strict=True)
    return [
        [*parse(str(reading)).symbols, *("trend" if verdict == TREND else str(verdict) for verdict in line)]
        for reading, line in table
    ]
