"""The command trade: store, draw and print accuracy against cost of every method."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from . import console, tables
from .options import option
from .present import Result, presents

if TYPE_CHECKING:
    import xarray as xr

    from solver.benchmark import Row
    from solver.methods.base import Ladder


@presents()
def trade(
    cases: Annotated[list[str] | None, option("NAMES", "Cases to measure, separated by commas; default: all.")] = None,
    methods: Annotated[
        list[str] | None, option("NAMES", "Methods to measure, separated by commas; default: all.")
    ] = None,
    out: Annotated[Path, option("FOLDER", "Folder for trade.h5 and its pictures.")] = Path("trade"),
) -> Result:
    """Measure the accuracy and the cost of every method.

    Each method solves cases with a known solution, at several values of its own setting of accuracy (steps, nodes or
    a tolerance). The folder receives trade.h5, and trade_seconds.png and trade_evaluations.png with six cases at most.

    When interrupted, the command stores and draws the finished cases as trade_interrupted; trade.h5 stays unchanged.
    """
    from ..compare import trade_runs as comparison
    from ..compare.trade_cases import choose
    from ..store import writing
    from .option_checks import names

    named, ladders = choose(names(cases)), comparison.ladders_of(names(methods))
    comparison.check_kinds(named, ladders)
    writing.check_folder(out)
    writing.check_free(out / "trade.h5", "trade")
    measure, store = partial(comparison.rows_of, named, ladders), partial(_store, ladders, out)
    ds, files = console.keep_finished(measure, len(named), "cases", store, "trade")
    found = comparison.summary_of(ds)
    stored = {"file": str(files[0]), "pictures": [str(picture) for picture in files[1:]]}
    return Result(lambda: found | stored, lambda: _print(found, files))


def _store(
    ladders: "Mapping[str, Ladder]", out: Path, cases: "Sequence[Sequence[Row]]", name: str
) -> "tuple[xr.Dataset, list[Path]]":
    """The dataset of the rows of cases, and the files made of it: NAME.h5 and its pictures."""
    from ..compare.trade_runs import dataset_of
    from ..figures import canvas, kinds
    from ..figures.work_precision import COSTS
    from ..store import writing

    ds = dataset_of([row for rows in cases for row in rows], ladders)
    path = writing.write(ds, out / f"{name}.h5")
    pictures = [out / f"{name}_{cost}.png" for cost in COSTS]
    for cost, picture in zip(COSTS, pictures, strict=True):
        canvas.save(kinds.figure(ds, "trade", cost=cost), picture)
    return ds, [path, *pictures]


def _print(found: Mapping[str, Any], files: Sequence[Path]) -> None:
    rows = [
        [
            row["case"],
            *(f"{b['method']}  {1e3 * b['seconds']:.2g} ms" if b["method"] else "none" for b in row["cheapest"]),
        ]
        for row in found["table"]
    ]
    levels = [f"{best['level']:.0e}" for best in found["table"][0]["cheapest"]]
    tables.print_table(["cheapest method for", *levels], rows)
    console.say("")
    counts = f"{found['solved']} runs solved, {found['failed']} failed, {found['not run']} omitted as too slow"
    console.say(f"{counts}; {found['machine']}")
    console.say("")
    for row in found["advice"]:
        console.say(_advice(row))
    for file in files:
        console.say(str(file))


def _advice(row: Mapping[str, Any]) -> str:
    """``For an error of 1e-06 in start problems: swing (17 of 17 cases, median 0.19 ms).``"""
    wanted = f"For an error of {row['level']:.0e} in {row['kind']} problems:"
    if row["method"] is None:
        return f"{wanted} no method reaches it."
    return f"{wanted} {row['method']} ({row['reached']} of {row['cases']} cases, median {1e3 * row['seconds']:.2g} ms)."
