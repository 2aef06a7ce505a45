"""The command reproduce: Fig. 6 and all of Fig. 7, from Table 1 to one report."""

from dataclasses import replace
from pathlib import Path

import xarray as xr

from solver.problem.errors import InputError
from studies import READINGS, load, names
from studies.laws import TREND

from ..data import law_verdicts, writing
from ..run import in_memory, study_store
from ..run.in_memory import StudyResult
from ..web.report import readings_table
from . import console

DEFAULT_STUDIES = "fig"  # the shipped studies whose names begin so are figures of the paper


def reproduce(out: Path, reading: str | None) -> int:
    """Do everything into the folder `out`; 0, or 1 where a panel is left out, a case is unsolved, or a law fails or is
    not decided. A qualified law is 0 here: of this paper some are, under every reading, and the report says why.

    The studies are stored as `workbench run` stores them; one that is already complete there is not solved again.
    Raises `InputError` before any work where the reading is unknown, the folder cannot be written, or a file
    in it is something else.
    """
    studies = [load(name).under(reading) for name in names() if name.startswith(DEFAULT_STUDIES)]
    writing.check_folder(out)
    files = {study.name: out / f"{study.name}.h5" for study in studies}
    for name, path in {**files, readings_table.NAME: out / f"{readings_table.NAME}.h5"}.items():
        writing.check_free(path, name)
    from ..scene import opengl
    from ..web.report import document  # drawing is loaded once nothing more can be refused

    able, advice = opengl.probe()
    panels = readings_table.panels()
    work = len(studies) * 2 + len(panels) * len(READINGS) + 1
    with console.progress(work) as step:
        results, refusals = [], []
        for study in studies:
            step(f"solving {study.name}")
            try:
                study_store.run_to_file(study, files[study.name])
            except InputError as error:  # a panel that this reading does not admit leaves the others alone
                refusals.append(f"{study.title}: {error}")
                step("")
                continue
            ds = writing.read(files[study.name])
            result = in_memory.result(study, ds, files[study.name])
            step(f"drawing {study.name}")
            results.append(replace(result, pictures=_draw(result, out, able)))
        readings = readings_table.run(panels, step=step)
        writing.write(readings, out / f"{readings_table.NAME}.h5")
        step("writing the report")
        document.write(results, out, readings=readings, advice="" if able else advice, refusals=refusals)
    _summary(results, readings, out, "" if able else advice)
    for refusal in refusals:
        console.say(f"Left out: {refusal}")
    refuted = any(law_verdicts.refuted(law_verdicts.unsolved(result.ds), result.verdicts) for result in results)
    return 1 if refusals or refuted else 0


def _draw(result: StudyResult, out: Path, able: bool) -> dict[str, Path]:
    """The pictures of one dataset: name -> file. Scenes only where OpenGL works."""
    from ..figures import canvas, study_figure

    ds = result.ds
    name = ds.attrs["study_name"]
    pictures = {"figure": out / f"{name}.png"}
    canvas.save(study_figure.figure(ds, result.verdicts), pictures["figure"])
    if able:
        from ..scene import layout

        pictures |= layout.draw(ds, out / f"{name}_scene.png")
    return pictures


def _summary(results: list[StudyResult], readings: xr.Dataset, out: Path, advice: str) -> None:
    reading = results[0].ds.attrs["reading"]
    verdicts = [row for result in results for row in result.verdicts]
    rows = [
        [row["claim"], law_verdicts.stated(row), law_verdicts.measured(row), law_verdicts.said(row)] for row in verdicts
    ]
    console.print_table(["claim", "law", "measured", "verdict"], rows, title=f"Table 1 read {reading}")
    console.say(law_verdicts.tallied(verdicts))
    console.say("")
    claims = [str(claim) for claim in readings["claim"].values]
    console.print_table(["reading", *claims], _marks(readings), title="The claims in each reading")
    unsolved = sum(law_verdicts.unsolved(result.ds) for result in results)
    cases = sum(result.ds["outcome"].size for result in results)
    console.say("")
    console.say(f"{cases} cases, {unsolved} unsolved")
    console.say(f"everything is in {out}, the report is {out / 'report.html'}")
    if advice:
        console.say(f"The scenes were left out: {advice}")


def _marks(readings: xr.Dataset) -> list[list[str]]:
    """One row a reading: the verdict of each claim."""
    table = zip(readings["reading"].values, readings["claim_verdict"].values, strict=True)
    short = {TREND: "trend"}
    return [[str(reading), *(short.get(str(one), str(one)) for one in line)] for reading, line in table]
