"""The command list: print the shipped studies."""

from typing import TYPE_CHECKING, Any

from . import tables
from .present import Result, presents

if TYPE_CHECKING:
    from studies.grammar.axes import Axis


@presents()
def list_studies() -> Result:
    """List the shipped studies with their axes and laws."""
    rows = _list()
    return Result(lambda: rows, lambda: _print(rows))


def _print(rows: list[dict[str, Any]]) -> None:
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
    from solver.problem.quantities import unit_of
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
        drawn = study.coarse()
        sampled = {"samples": drawn.samples_count, "sampled": list(drawn.sampled), "refined": study.refine is not None}
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
