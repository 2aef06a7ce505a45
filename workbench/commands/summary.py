"""The command summary: which studies are shipped, or what a stored study or another file holds."""

from collections.abc import Mapping
from math import degrees, floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.quantities import unit_of

from ..words import escaping
from . import console, tables
from .options import argument
from .present import Result, presents
from .stored_words import JUDGED, SAMPLING, print_sentences, print_verdicts

if TYPE_CHECKING:
    from studies.grammar.axes import Axis

SPREAD = {name: name for name in ("min", "median", "max", "units")}  # columns of a table
NUMBERS = ("from", "to", "min", "median", "max", "half_width", "at")  # of a row, in its units


@presents()
def summary(
    file: Annotated[
        Path | None, argument("FILE", "Stored study, or another file that the workbench stored; default: none.")
    ] = None,
) -> Result:
    """Summarise a stored file; without one, list the studies that come with the workbench.

    Prints its axes, observables, outcomes, laws and versions, and the cases of the largest error and condition number;
    of lists of equilibria, branches, fold maps and measurements their numbers.
    """
    if file is None:
        rows = _list()
        return Result(lambda: rows, lambda: _print_studies(rows))
    from ..stored import file_kinds, reading
    from ..stored.file_summary import brief_law, contents
    from ..stored.file_summary import summary as summarise

    if reading.kind_of_file(file) is file_kinds.STUDY:
        study = summarise(file)
        return Result(lambda: study | {"laws": [brief_law(row) for row in study["laws"]]}, lambda: _print(study))
    described = contents(file)
    return Result(lambda: described, lambda: _print_contents(described))


def _print_contents(found: dict[str, Any]) -> None:
    """Print the summary of a file that is no study."""
    console.say(found["title"] or found["kind"])
    console.say(f"{found['file']}: {escaping.bytes_in_words(found['bytes'])}, {found['kind']}")
    console.say(", ".join(f"{name} {size}" for name, size in found["sizes"].items()))
    console.say(f"along the rod: {', '.join(found['along']) or 'nothing'}")
    console.say("")
    tables.print_rows(map(in_degrees, found["numbers"]), {"name": "number", "over": "over", **SPREAD})
    given = (
        f"{row['name']} = {tables.text_of(row['min'])} {'' if row['units'] == '1' else row['units']}"
        for row in map(in_degrees, found["fields"])
    )
    console.say(", ".join(text.strip() for text in given))
    _print_outcomes(found["outcomes"])
    for name, sentence in found["said"].items():
        console.say(f"{name}: {sentence}")
    print_sentences(found, ["caution"])


def _print_outcomes(outcomes: Mapping[str, int]) -> None:
    for text, count in outcomes.items():
        console.say(f"  {count} x {text}")


def _print(found: dict[str, Any]) -> None:
    from studies.grammar.axes import SAMPLE, in_words
    from studies.laws.law_words import count_of

    reading = f", {found['reading']}" if found["reading"] else ""
    console.say(f"{found['title']}{reading}")
    size = escaping.bytes_in_words(found["bytes"])
    console.say(
        f"{found['file']}: {size}, format {found['format']}, study {found['study_name']}, stored {found['created']}"
    )
    versions = ", ".join(f"{name} {number}" for name, number in found["versions"].items())
    console.say(f"method {found['method']}, tolerance {found['tolerance']:g}; {versions}")
    along = f"{', '.join(found['along'])} at {found['stations']} stations" if found["along"] else "nothing"
    console.say(f"along the rod: {along}")
    console.say("")
    rows = []
    for axis in found["axes"]:
        for entry in [axis, *(found["sampled"] if axis["name"] == SAMPLE else [])]:
            row = in_degrees(entry)
            name = f"{'' if entry is axis else '  '}{entry['name']}"
            rows.append([name, entry["count"] if entry is axis else "", *(row[key] for key in ("from", "to", "units"))])
    tables.print_table(["axis", "values", "from", "to", "units"], rows or [["(none)", "", "", "", ""]])
    print_sentences(found, SAMPLING)
    _print_boundaries(found["boundaries"])
    console.say("")
    if found["observables"]:
        stated = [in_units_of_engineers(row, found["unit_system"]) for row in found["observables"]]
        tables.print_rows(stated, {"name": "observable", **SPREAD})
        console.say("")
    if found["states"]:
        units = {axis["name"]: "deg" if axis["units"] == "rad" else axis["units"] for axis in found["axes"]}
        heads = {**dict.fromkeys(found["states"][0], ""), "state": "state along the rod"}
        tables.print_rows(found["states"], heads, units)
        console.say("")
    console.say(f"{count_of(found['cases'], 'case')}, {found['unsolved']} unsolved")
    _print_outcomes(found["outcomes"])
    for worst in found["worst"]:
        at = ", ".join(in_words(name, value) for name, value in worst["at"].items())
        console.say(f"largest {worst['name']}: {tables.text_of(worst['value'])}{f' at {at}' if at else ''}")
    print_sentences(found, JUDGED)
    if found["laws"]:
        console.say("")
        print_verdicts(found["laws"])


def _print_boundaries(rows: list[dict[str, Any]]) -> None:
    """Print where each watched observable changes; nothing for a study that is not refined."""
    rows = [
        in_degrees(row) | {"places": [in_degrees({**place, "units": row["units"]}) for place in row["places"]]}
        for row in rows
    ]
    if not rows:
        return
    console.say("")
    heads = {"name": "boundary of", "axis": "along", "half_width": "half width"}
    keys = ("name", "axis", "pairs", "from", "to", "half_width", "units")
    tables.print_rows(rows, {key: heads.get(key, key) for key in keys})
    for row in rows:
        for place in row["places"]:
            digits = max(1 - floor(log10(place["half_width"])), 0)
            at = f"{row['axis']} = {place['at']:.{digits}f} +- {place['half_width']:.{digits}f} {row['units']}".rstrip()
            before, after = (tables.text_of(place[key]) for key in ("before", "after"))
            console.say(f"  {row['name']}: {before} to {after} at {at}")
    for name, unknown in {row["name"]: row["unknown"] for row in rows if row["unknown"]}.items():
        console.say(f"{unknown} pairs of neighbours are not compared: one of the two cases has no number of {name}")


def in_degrees(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of a table with its numbers in degrees, as in pictures, where its units are rad."""
    if row["units"] != "rad":
        return dict(row)
    shown = {key: degrees(row[key]) for key in NUMBERS if isinstance(row.get(key), float)}
    return {**row, **shown, "units": "deg"}


def in_units_of_engineers(row: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """A row of an observable in the unit in which engineers state it, as `solve` does: stresses in ksi or MPa."""
    from solver.problem.quantities import QUANTITIES

    name = row["name"]
    if row["units"] in ("1", "rad") or name not in QUANTITIES:
        return in_degrees(row)
    shown = {key: tables.number_stated(name, row[key], units) for key in NUMBERS if isinstance(row.get(key), float)}
    return {**row, **shown, "units": tables.unit_stated(name, units)}


def _print_studies(rows: list[dict[str, Any]]) -> None:
    from studies.laws import law_words

    table = []
    for row in rows:
        sampled = [f"{row['samples']} samples of {', '.join(row['sampled'])}"] if row["sampled"] else []
        axes = "\n".join([*sampled, *map(_range, row["axes"]), *(["refined"] if row["refined"] else [])])
        laws = "\n".join(f"{law['claim']}: {law_words.law_in_words(law)}" for law in row["laws"])
        table.append([row["study"], row["title"], axes or "-", laws or "-"])
    tables.print_table(["study", "title", "axes", "laws"], table)


def _list() -> list[dict[str, Any]]:
    """The shipped studies as plain data.

    study, title, samples (their number), sampled (fields), refined, axes (axis, from, to, count, unit, follow), laws.
    """
    from studies import load, names
    from studies.grammar.axes import quantity_of

    rows = []
    for name in names():
        study = load(name, draw=False)
        units = study.unit_system
        axes = [_axis(field, axis, unit_of(quantity_of(field).name, units)) for field, axis in study.axes.items()]
        laws = [
            {key: getattr(law, key) for key in ("claim", "kind", "observable", "direction", "does", "axis")}
            for law in study.laws
        ]
        given = study.variation.given
        size, fields = (given.size, list(given.fields)) if given else (0, [])
        sampled = {"samples": size, "sampled": fields, "refined": study.refine is not None}
        rows.append({"study": name, "title": study.title, **sampled, "axes": axes, "laws": laws})
    return rows


def _axis(field: str, axis: "Axis", unit: str) -> dict[str, Any]:
    """An axis as plain data; from is None for a followed axis, which begins at the value of the base case."""
    first, last = (axis.values[0], axis.values[-1]) if axis.values else (axis.from_, axis.to)
    data = {"axis": field, "from": first, "to": last, "count": axis.size, "unit": axis.unit or unit}
    return {**data, "follow": axis.follow}


def _range(axis: dict[str, Any]) -> str:
    """The range of an axis in words."""
    unit = "deg" if axis["unit"] == "deg" else ""
    if axis["from"] is None:
        return f"{axis['axis']} followed to {axis['to']:g}{unit}"
    how = " followed" if axis["follow"] else ""
    return f"{axis['axis']}{how} {axis['from']:g}..{axis['to']:g}{unit} ({axis['count']})"
