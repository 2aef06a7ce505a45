"""The command sensitivity: what the observables of a case, or of a sampled study, depend on."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError

from ..run import atomic
from . import console, tables
from .options import At, argument, axis_values, flag, names, number, option
from .present import Result, presents
from .summary import in_units_of_engineers

if TYPE_CHECKING:
    import xarray as xr

CSV = (".csv",)
LOCAL = ("observable", "value", "unit", "field", "at", "field_unit", "derivative", "derivative_unit", "effect",
         "effect_unit", "amount", "remark")  # fmt: skip
GLOBAL = ("observable", "field", "first", "first_conf", "total", "total_conf", "blocks", "lost", "remark")
PAIRS = ("observable", "field", "other", "second", "second_conf")
Study = Annotated[Path, argument("STUDY", "Shipped study, TOML file, or stored study: a file that run wrote.")]


@presents(
    "Diagram: tornado diagrams, with --global the indices; .png, .pdf or .svg.",
    "Table, .csv, in full precision.",
    suffixes=CSV,
)
def sensitivity(
    study: Study,
    at: At = None,
    fields: Annotated[
        list[str] | None, option("NAMES", "Fields, separated by commas; default: every numeric field of the case.")
    ] = None,
    show: Annotated[
        list[str] | None,
        option(
            "NAMES",
            "Observables, separated by commas; default: all that are no whole numbers; with --global all "
            "that are stored.",
        ),
    ] = None,
    whole: Annotated[
        bool, flag("Sobol' indices over the ranges of a stored study of Saltelli's design (extra global).", "--global")
    ] = False,
    confidence: Annotated[
        float | None, option("SHARE", "Confidence of the intervals of --global; default: 0.95.", parser=number)
    ] = None,
) -> Result:
    """Tell what matters: how the observables answer the fields.

    Of one case: the exact derivatives, as elasticities, the change in percent for 1 % of a field. --at chooses the case
    of a study. With --global: the shares of the variance that each sampled field explains, over its whole range.
    """
    if whole and fields:
        raise InputError("--fields is an option of the derivatives of one case; --global tells all sampled fields")
    if confidence is not None and not whole:
        raise InputError("--confidence is an option of --global: derivatives are exact and have no interval")
    if whole:
        units: dict[str, str] = {}  # indices have none
        table, said = _indices(study, at, names(show), confidence)
    else:
        table, said, units = _local(study, at, names(fields) or None, names(show) or None)
    pairs = {"pairs": table_pairs(table)} if "second" in table else {}
    return Result(
        lambda: {**table.attrs, "rows": table_rows(table), **pairs, "notes": said},
        lambda: _print(table, said, units),
        dataset=lambda: table,
        write=lambda path: _write(table, path),
        figure="indices" if whole else "tornado",
    )


def _local(
    file: Path, at: list[str] | None, fields: list[str] | None, show: list[str] | None
) -> "tuple[xr.Dataset, list[str], dict[str, str]]":
    """The table of one case with its title, the sentences on it, and the units of "length" and "force"."""
    from solver.observe.observables import is_count
    from studies import load

    from ..influence import derivatives
    from ..run import in_memory
    from ..stored import case_of_file, quantity_variables, reading
    from ..stored.stored_study import StoredStudy

    real = None if show is None else [name for name in show if not is_count(name)]
    left_out = derivatives.counts_left_out(show or [])
    if show and not real:
        real = show  # refused with the choices
    if case_of_file.is_study(file):
        study = load(file)
        stored = StoredStudy(in_memory.outline(study))
    else:
        stored = reading.read_stored(file)
        study = stored.study
    solution = case_of_file.solve_case(stored, axis_values(stored, at), study)
    table = derivatives.local(
        solution, fields, real, study.unit_system, "FZ0" in {*study.base.given, *study.variation.fields}
    )
    varied = " ".join(quantity_variables.dimension(name) for name in study.variation.fields)
    table = table.assign_attrs(title=study.title, reading=study.reading or "", varied=varied)
    return table, [*derivatives.sentences(table), *([left_out] if left_out else [])], study.unit_system


def _indices(
    file: Path, at: list[str] | None, show: list[str], confidence: float | None
) -> "tuple[xr.Dataset, list[str]]":
    """The indices of a stored study, and the sentences on them."""
    from ..influence import sobol_indices
    from ..stored import case_of_file, reading

    if case_of_file.is_study(file):
        raise InputError(f"--global needs a stored study: workbench run {file} stores one")
    stored = reading.read_stored(file)
    share = sobol_indices.CONFIDENCE if confidence is None else confidence
    table = sobol_indices.sobol(stored.ds, show, axis_values(stored, at), share)
    return table, sobol_indices.sentences(table)


def _print(table: "xr.Dataset", said: list[str], units: Mapping[str, str]) -> None:
    console.say(table.attrs["title"])
    if "derivative" in table:
        _print_local(table, units)
    else:
        _print_indices(table)
    console.say("")
    for sentence in said:
        console.say(sentence)


def _print_local(table: "xr.Dataset", units: Mapping[str, str]) -> None:
    """The case, and the effects: a row an observable, a column a field."""
    from ..influence import derivatives

    names = [str(name) for name in table["field"].values]
    rows = [_statement(table.isel(field=i), "field", "at", units) for i in range(len(names))]
    cells = [[row["name"], row["at"], row["units"]] for row in rows]
    tables.print_table(["field", "value", "unit"], cells)
    names = [name for name in names if name not in derivatives.without_effect(table)]
    heads = [tables.column_title(name, str(table["amount"].sel(field=name).values)) for name in names]
    console.say("")
    effects = [_effects(table, i, names, units) for i in range(table.sizes["observable"])]
    tables.print_table(["observable", "value", "unit", "in", *heads], effects)


def _statement(row: "xr.Dataset", what: str, number: str, units: Mapping[str, str]) -> dict[str, Any]:
    """The name, number and units, as engineers state them, of one field or observable of the table."""
    unit = str(row[{"field": "field_unit", "observable": "unit"}[what]].values)
    stated = in_units_of_engineers({"name": str(row[what].values), "at": float(row[number]), "units": unit}, units)
    return stated | {"units": "" if unit == "1" else stated["units"]}


def _effects(table: "xr.Dataset", i: int, fields: list[str], units: Mapping[str, str]) -> list[str]:
    """The cells of an observable; a dash where there is no derivative."""
    row = table.isel(observable=i)
    stated = _statement(row, "observable", "value", units)
    values = (float(row["effect"].sel(field=name)) for name in fields)
    cells = ["-" if value != value else f"{value:+.3g}" if value else "0" for value in values]
    return [stated["name"], f"{stated['at']:.5g}", stated["units"], str(row["effect_unit"].values), *cells]


def _print_indices(table: "xr.Dataset") -> None:
    rows = []
    for row in table_rows(table):
        first, total = (_index(row, key) for key in ("first", "total"))
        rows.append([row["observable"], row["field"], first, total])
    tables.print_table(["observable", "field", "first", "total"], rows)
    if pairs := table_pairs(table):
        console.say("")
        cells = [[row["observable"], f"{row['field']} and {row['other']}", _index(row, "second")] for row in pairs]
        tables.print_table(["observable", "pair", "second"], cells)


def _index(row: "dict[str, Any]", key: str) -> str:
    """An index and half its interval; a dash where there is none."""
    from studies.laws.law_kinds import with_error

    return "-" if row[key] != row[key] else with_error(row[key], row[f"{key}_conf"])


def table_rows(ds: "xr.Dataset") -> list[dict[str, Any]]:
    """A row for each observable and field, of a dataset of `local` or `sobol`."""
    return _rows(ds, LOCAL if "derivative" in ds else GLOBAL, ("observable", "field"))


def table_pairs(ds: "xr.Dataset") -> list[dict[str, Any]]:
    """A row for each observable and pair of fields; none where the design does not tell pairs apart."""
    if "second" not in ds:
        return []
    order = {name: i for i, name in enumerate(ds["field"].values.tolist())}
    every = _rows(ds, PAIRS, ("observable", "field", "other"))
    return [row for row in every if order[row["field"]] < order[row["other"]]]


def _rows(ds: "xr.Dataset", columns: Sequence[str], dims: Sequence[str]) -> list[dict[str, Any]]:
    """The columns, which are variables or dimensions, over the product of the dimensions."""
    table = ds[[name for name in columns if name not in dims]].to_dataframe(dim_order=dims)
    rows: list[dict[str, Any]] = table.reset_index()[[*columns]].to_dict("records")
    return rows


def _write(ds: "xr.Dataset", path: Path) -> None:
    """Write the rows as CSV in full precision; those of pairs follow in the columns other, second, second_conf."""
    from ..words.escaping import in_csv

    lines = [*table_rows(ds), *table_pairs(ds)]
    columns = list(dict.fromkeys(name for row in lines for name in row))
    cells = [[row.get(name, "") for name in columns] for row in lines]
    atomic.write_text(path, in_csv([columns, *cells]), newline="")
