"""The report: one self-contained HTML file, made from stored datasets and their pictures."""

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageChops

from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES
from studies import tenants
from studies.laws import law_words
from studies.paper.readings import TABLE_1, Reading

from ..commands.docs import PAPER
from ..figures import colours
from ..run import atomic
from ..stored.stored_study import StoredStudy
from ..web import pages
from ..web.live.presets import PRESETS
from ..web.turntable import turntable_page
from ..words import caution_words, labels
from . import report_runs, sources
from .law_cards import CLASSES, claims_of, in_degrees, law_of, mechanism, of_readings, sentence
from .sources import ReportedStudy

if TYPE_CHECKING:
    from ..lab.measured_runs import MeasuredRun

NAME = "report.html"
TEMPLATE = "report.html.j2"
CAPTIONS = {
    "solved": "Change the values: the rod is solved again here, in this file. Drag to turn it, arrow keys turn it too.",
    "stored": "Drag to turn the rod about the axis of the cylinder; the slider goes through the cases of the figure.",
    "row": "The blue frame above marks the rod that is shown here; the slider moves it. Drag to turn the rod.",
}
TITLES = {"trade": "Accuracy against cost", "extremes": "The extremes"}
STORY = "The rod with its letters, rods over the modulus, their number of bends, and the verdicts of all readings"
SCENE, DRAWING = {"quality": 85}, {"lossless": True}  # options of WebP
LEVELS = 63  # of a colour in a drawing above 0: what rounding takes away is not seen, and a fifth of the bytes
RODS = "rods"  # the text in the PNG of a row of rods that says where each stands
WHITE, MARGIN = 0.995, 16  # from which a pixel counts as blank; pixels of margin that a picture keeps
MOST_BYTES = 400_000  # of the stations of a panel
SHOWN = (
    "bends", "bend_number", "amplitude", "turns_around", "height", "kappa_mean", "kappa_max", "contact_size_mean",
    "push_min", "push_max", "attached", "overlaps", "energy", "index",
)  # fmt: skip
FIELDS = ("E", "R", "beta", "F1", "dgamma", "F3")  # those that the reading uses get a slider


def write(out: Path, results: Sequence[ReportedStudy], **parts: Any) -> Path:
    """Write `report.html` into the folder `out` and return it, with the measurements that are stored there.

    parts: as of `html`. Raises `InputError` where it cannot be written.
    """
    measured = []
    if tenants.is_there("workbench.lab"):
        measured = tenants.module_of("workbench.lab.measured_runs").comparisons(out)
    return atomic.write_text(out / NAME, html(results, measured=measured, **parts))


def html(
    results: Sequence[ReportedStudy],
    readings: StoredStudy | None = None,
    refusals: Sequence[str] = (),
    measured: "Sequence[MeasuredRun]" = (),
    equilibria: tuple[StoredStudy, Mapping[str, Path]] | None = None,
    story: Path | None = None,
    release: Mapping[str, Any] | str = "",
) -> str:
    """The report as text, with every picture, a turntable for each panel and the compiled core inside it.

    readings: the dataset of `report_runs.run_readings`. refusals: studies that could not be run under this reading, and
    why. equilibria: the dataset of `run_equilibria` and its pictures. story: the figure of the whole story.
    release: as of `report_runs.release`, or why there is none.
    """
    if not results:
        raise InputError("a report needs at least one study")
    figures = {f"turn-{result.stored.attrs['study_name']}": figure_of(result.stored) for result in results}
    figures = {name: figure for name, figure in figures.items() if figure is not None}
    sections = [_section(result, figures) for result in results]
    datasets = [*(result.stored for result in results), *([] if readings is None else [readings])]
    cases = [[result.stored[name].values.ravel() for result in results] for name in ("caution", "solved")]
    texts, solved = (np.concatenate(each) for each in cases)
    laws = [row for section in sections for row in section["laws"]]
    verdicts = "".join(f" --{CLASSES[name]}: {colour};" for name, colour in colours.VERDICTS.items())
    style = f":root {{{verdicts} }}\n{turntable_page.look()}{_text('report.css')}"
    program = f"{turntable_page.program()}\n{_text('enlarge.js')}"
    claims = claims_of(sections)
    return pages.page(
        _text(TEMPLATE),
        style,
        {"program": program},
        turntable_page.data(figures),
        finalize=with_hard_spaces,
        restable=caution_words.restable(texts, solved),
        barred=all(map(caution_words.is_barred, texts[solved])),
        reading=str(results[0].stored.attrs["reading"]),
        read_as=results[0].stored.reading,
        claims=claims,
        title=_title_of(claims),
        meanings=[(key, labels.typeset(text)) for key, text in law_words.MEANING.items()],
        sections=sections,
        laws=laws,
        notes=list(dict.fromkeys(law["fixed_note"] for law in laws if law["fixed_note"])),
        readings=of_readings(readings),
        errata=_text("errata.html"),
        sources=[sources.row(result) for result in results],
        error=sources.least_bound(results),
        versions=sources.versions(datasets),
        created=max(str(result.stored.attrs["created"]) for result in results),
        refusals=[labels.typeset(in_degrees(refusal)) for refusal in refusals],
        paper=PAPER,
        table_1=sources.table_1(str(results[0].stored.attrs["reading"])),
        version=sources.version(datasets),
        turntable=turntable_page.figure,
        captions=CAPTIONS,
        measured=[_measure(run) for run in measured],
        story=[] if story is None else [_picture(story, STORY, DRAWING) | _column(story)],
        left_out=caution_words.LEFT_OUT,
        equilibria=_equilibria(*equilibria) if equilibria else None,
        release=release,
    )


def figure_of(stored: StoredStudy) -> dict[str, Any] | None:
    """The plain data of a panel's turntable; None where no case has a shape."""
    if not stored.axes and (solving := _solve(stored)):
        return solving
    try:
        return turntable_page.turntable_of_dataset(stored, most_bytes=MOST_BYTES, facts=facts_of).data
    except InputError:
        return None


def _solve(stored: StoredStudy) -> dict[str, Any] | None:
    """The data of the rod of Table 1, which the page solves itself; None for any other rod."""
    reading, preset = str(stored.attrs.get("reading", "")), next(known for known in PRESETS if known.name == "table1")
    if not reading or any(abs(float(stored[name]) - TABLE_1[name]) > 1e-9 for name in ("E", "R", "a", "L")):
        return None
    read = Reading(*reading.split("/"))
    fields = [name for name in FIELDS if name != read.inert_field]
    return {
        "state": {**preset.state, "base": dict(preset.state["base"]), "reading": reading},
        "fields": fields,
        "spans": asdict(preset)["spans"],
        "quantities": {
            name: [row.symbol, row.long_name.partition(" (")[0], row.dimension] for name, row in QUANTITIES.items()
        },
        "letters": {name: row.symbol for name, row in QUANTITIES.items()} | {"beta": "β₀", "dbeta": "β₀′"},
        "units": stored.units,
    }


def facts_of(case: StoredStudy) -> list[tuple[str, str]]:
    """Long name and value of each observable of a dataset of one case; of those that it has and that are finite."""
    return [_row(case, name) for name in SHOWN if name in case and np.isfinite(case[name])]


def _row(case: StoredStudy, name: str) -> tuple[str, str]:
    value = float(case[name])
    if name == "overlaps":
        return "passes through itself", "yes" if value else "no"
    words = "Morse index, 0 where stable" if name == "index" else labels.long_name(case[name])
    return words, labels.value(value, case[name])


def _column(picture: Path) -> dict[str, Any]:
    """A diagram as wide as one column, for a narrow screen, where it was drawn."""
    narrow = column_of(picture)
    return _narrow(narrow) if narrow.exists() else {}


def _narrow(file: Path | BytesIO) -> dict[str, Any]:
    return {"narrow": _picture(file, "", DRAWING)["src"]}


def column_of(picture: Path) -> Path:
    """The file of a diagram that is as wide as one column."""
    return picture.with_stem(f"{picture.stem}_column")


def _measure(run: "MeasuredRun") -> dict[str, Any]:
    picture = _picture(BytesIO(run.picture), f"{TITLES[run.name]}: {run.shows}", DRAWING)
    picture |= _narrow(BytesIO(run.column)) if run.column else {}
    return {"name": run.name, "title": TITLES[run.name], "shows": run.shows, "source": run.source, "picture": picture}


def _equilibria(stored: StoredStudy, files: Mapping[str, Path]) -> dict[str, Any] | None:
    alt = "The stable equilibrium and the rod of Table 1, between the same ends under the same loads"
    return report_runs.rows(stored, [_picture(path, alt, SCENE) for path in files.values()])


def _section(result: ReportedStudy, figures: Mapping[str, Any]) -> dict[str, Any]:
    """The section of one study."""
    stored = result.stored
    scenes = [(name, path) for name, path in result.pictures.items() if name.startswith("scene")]
    others = [(name, path) for name, path in result.pictures.items() if not name.startswith("scene")]
    laws = [law_of(stored, row) | {"why": mechanism(row["claim"], stored)} for row in stored.verdicts]
    name, title = str(stored.attrs["study_name"]), str(stored.attrs["title"])
    caution = labels.typeset(str(stored.attrs.get("caution", "")))  # which has a paragraph of its own
    turntable = figures.get(f"turn-{name}")
    pictures = [
        _picture(path, f"{title}: {_of(stored, part)}", SCENE) | _rods(path, part, turntable) for part, path in scenes
    ]
    diagrams = [_picture(path, f"{title}: curves and laws", DRAWING) | _column(path) for _, path in others]
    return {
        "id": name,
        "title": title,
        "turning": turntable,
        "row": bool(stored.axes) and bool(scenes),
        "restable": stored.restable,
        "sentences": list(dict.fromkeys(row["source"] for row in stored.verdicts)),
        "laws": laws,
        "single": facts_of(stored) if not stored.axes else [],
        "note": sentence(str(stored.attrs.get("fold_note", ""))),
        "caution": caution,
        "unsolved": stored.unsolved,
        "cases": int(stored["outcome"].size),
        "scenes": pictures,
        "others": diagrams,
        "caption": " ".join(text for text in result.caption if text != caution),
    }


def _rods(path: Path, part: str, turntable: Mapping[str, Any] | None) -> dict[str, Any]:
    """Where each rod of a row stands in its picture, and which slider of the turntable goes along the row."""
    with Image.open(path) as picture:
        stored = json.loads(picture.info.get(RODS, "[]"))
        size, box = picture.size, _ink_box(picture)
    axes = (turntable or {}).get("axes", [])
    places = [k for k, axis in enumerate(axes) if axis["name"] == part.removeprefix("scene").strip()]
    if not places or len(stored) != len(axes[places[0]]["texts"]):
        return {}
    left, top, right, low = box
    boxes = np.array(stored) * (2 * size) - (left, top, left, top)
    wide, high = right - left, low - top
    return {"rods": json.dumps((boxes / (wide, high, wide, high)).round(4).tolist()), "axis": places[0]}


def _of(stored: StoredStudy, name: str) -> str:
    axis = name.removeprefix("scene").strip()
    return f"the rod along {labels.axis_label(stored[axis])}" if axis in stored.sizes else "the rod on its cylinder"


def _picture(file: Path | BytesIO, alt: str, how: dict[str, Any]) -> dict[str, Any]:
    """A PNG as a data URL of WebP, a fifth of the size; edges of a drawing stay as sharp as they are."""
    packed = BytesIO()
    with Image.open(file) as picture:
        trimmed = picture.crop(_ink_box(picture))
        if how is DRAWING:
            trimmed = trimmed.point(lambda level: round(round(level / 255 * LEVELS) / LEVELS * 255))
        trimmed.save(packed, "webp", **how)
    src = f"data:image/webp;base64,{base64.b64encode(packed.getvalue()).decode('ascii')}"
    return {"src": src, "alt": alt, "kind": "drawing" if how is DRAWING else "scene"}


def _ink_box(picture: Image.Image) -> tuple[int, int, int, int]:
    """The part of a picture that is not blank, with a narrow margin: left, top, right and lower edge in pixels."""
    ink = ImageChops.invert(picture.convert("RGB")).point(lambda level: 255 * (level > 255 * (1 - WHITE)))
    left, top, right, low = ink.getbbox() or (0, 0, *picture.size)
    wide, high = picture.size
    return max(left - MARGIN, 0), max(top - MARGIN, 0), min(right + MARGIN, wide), min(low + MARGIN, high)


def _title_of(claims: Sequence[Mapping[str, Any]]) -> str:
    """What the report finds: ``5 claims about an elastic rod on a cylinder: 1 true, 4 true in part``."""
    count, _, verdicts = law_words.tally_of(claims, "claim").partition(": ")
    return f"{count} about an elastic rod on a cylinder: {verdicts}" if claims else "An elastic rod on a cylinder"


def _text(name: str) -> str:
    """The text of a file of this folder."""
    return pages.read(__package__, name)


HARD = "\u00a0"  # a space at which no line ends
SIGNS = "[=<>≤≥→]"
SPACES = re.compile(
    rf"(?<=\S) (?={SIGNS} )|(?<={SIGNS}) (?=\S)|(?<=\b\w) (?=\w {SIGNS} )"
    r"|(?<=\d) (?=(?:rad|cm|N|m|mm)\b)|(?<=\beq\.) (?=\()|(?<=\btau) (?=[−\d])"
)


def with_hard_spaces(value: Any) -> Any:
    """A plain text with hard spaces in its formulas; markup and what is no text as they are."""
    return SPACES.sub(HARD, value) if type(value) is str else value
