"""The command fit: values of fields of a case that fit targets and measured points."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.declared_fields import ALL_FIELDS
from solver.problem.errors import InputError

from . import console, tables
from .case_options import GivenOptions
from .options import (
    At,
    Choose,
    Reading,
    Table1,
    argument,
    axis_values,
    flag,
    names,
    numbers,
    option,
    parse_choose,
    ranges,
)
from .present import Result, presents
from .tables import number_stated, unit_stated

if TYPE_CHECKING:
    from solver.fits.fit_result import Fit
    from studies.language.case_input import CaseInput

OUT = (".toml", ".csv")
OF_HELIX = ("E", "nu", "EI", "GJ", "inner_radius", "a", "R")  # what the loads of a wound helix depend on


Study = Annotated[
    Path | None, argument("FILE|STUDY", "TOML file or name of a study; default: Table 1, or the options alone.")
]
Target = Annotated[
    list[str] | None,
    option(
        "NAME=VALUE",
        "Wanted value of an observable, such as height=10, in the units of the case; repeatable. FZ0@axial-backward is "
        "that of the same rod with friction that slides in this other way.",
    ),
]
Points = Annotated[
    Path | None,
    option(
        "FILE",
        "Measured points, .csv or .parquet: columns alpha [rad] and z [length]; s, beta and sigma_NAME are optional.",
    ),
]
Vary = Annotated[list[str] | None, option("NAMES", "Fields that are fitted, separated by commas, such as E,M3.")]
Bounds = Annotated[
    list[str] | None,
    option("NAME=LOW:HIGH", "Bounds of a field of --vary, such as F1=1:9, in the units of the case; repeatable."),
]
Sigma = Annotated[
    list[str] | None,
    option(
        "NAME=VALUE",
        "Standard deviation of a target, or of alpha, z or beta of all points; repeatable. Default: none is known, and "
        "the intervals use the residuals.",
    ),
]


@presents(
    "Picture, .png, .pdf or .svg: curve and points, region, which data decide.",
    "The fitted case as a .toml file for solve, or the fitted values as a .csv table.",
    suffixes=OUT,
    case=tuple(ALL_FIELDS),
)
def fit(
    file: Study = None,
    target: Target = None,
    points: Points = None,
    vary: Vary = None,
    bounds: Bounds = None,
    sigma: Sigma = None,
    wrapped: Annotated[bool, flag("Measured azimuths are known only up to whole turns.", "--wrapped")] = False,
    starts: Annotated[int, option("NUMBER", "Number of Sobol' points tried beside the case.", min=0)] = 32,
    seed: Annotated[int, option("NUMBER", "Seed of the Sobol' points.", min=0)] = 0,
    at: At = None,
    table1: Table1 = False,
    reading: Reading = None,
    *,
    given: GivenOptions,
    choose: Choose = None,
) -> Result:
    """Find values of fields that give wanted observables or fit measured points, with their intervals.

    The search starts from the values of the case and from Sobol' points, and uses exact derivatives. It prints 95 %
    intervals, which data decide each value, correlations, and other minima.

    Angles: a number in rad, or a form like 30deg or pi/6. Exit status 1 if the data do not determine the values.
    """
    from solver import fit as fitted

    from .. import fitting

    read, sigmas = fitting.read_points(points) if points is not None else (None, {})
    base = _case(file, at, given, table1, reading)
    targets, fields = numbers("--target", target, base.units), _vary(vary, ranges("--bounds", bounds, base.units))
    if base.wound and (moving := [name for name in fields if name in OF_HELIX]):
        raise InputError(
            f"tension and lay are the loads of the rod as it is, and {moving[0]} would change them: give beta0, betaL, "
            "FZ, MZ and M3 in their place"
        )
    result = fitted(
        base.case,
        fields,
        targets,
        read,
        sigma={**sigmas, **numbers("--sigma", sigma, base.units)},
        wrapped=wrapped,
        starts=starts,
        seed=seed,
        choose=_rule(base, choose),
        FZ0=base.stand_ins.get("FZ0"),
    )
    if not result.reached:
        raise InputError(result.outcome.removeprefix("failed: "))
    drawn = result.solution is not None
    return Result(
        lambda: _as_data(result, base),
        lambda: _show(result, base),
        0 if result.solved else 1,
        (lambda: fitting.as_dataset(result, base.units, read, wrapped)) if drawn else None,
        (lambda path: fitting.write(result, base, path)) if drawn else None,
        "fit",
    )


def _case(
    file: Path | None, at: list[str] | None, given: GivenOptions, table1: bool, reading: str | None
) -> "CaseInput":
    """The case, of a study at a place of its axes."""
    from studies import load
    from studies.language.case_input import check_alone, read_case

    from ..run.in_memory import outline
    from ..stored.case_of_file import case_at
    from ..stored.stored_study import StoredStudy

    if file is None:
        if at:
            raise InputError(f"--at {at[0]} names an axis of a study, and no study is given")
        return read_case(None, given.values, given.units, table1, reading)
    check_alone(file, given.units, table1)
    study = load(str(file)).under(reading)
    if study.variation.from_base:
        raise InputError(
            f"{study.name} follows one equilibrium along {study.variation.followed}: fit takes a study of single cases"
        )
    return case_at(study, axis_values(StoredStudy(outline(study)), at), given.values)


def _vary(texts: list[str] | None, bounds: dict[str, tuple[float, float]]) -> "dict[str, tuple[float, float] | None]":
    """Field -> bounds or None. Raises `InputError` where no field is named, or one is bounded that is not varied."""
    fields = names(texts)
    if not fields:
        raise InputError("fit needs --vary NAMES, the fields that are fitted, such as --vary E,M3")
    if twice := [name for name in fields if fields.count(name) > 1]:
        raise InputError(f"--vary names {twice[0]} twice")
    for name in bounds:
        if name not in fields:
            raise InputError(f"--bounds {name} is of no field of --vary; choose from {', '.join(fields)}")
    return {name: bounds.get(name) for name in fields}


def _rule(asked: "CaseInput", choose: str | None) -> Any:
    """Which equilibrium of an ends problem the search begins with."""
    from solver.held.equilibrium_choice import NEAREST

    which = asked.study.equilibrium if asked.study else None
    if choose is not None:
        which = parse_choose(choose, asked.case.given)
    if which is None:
        return NEAREST
    if which.rule is None:
        raise InputError("the study names its equilibrium by dbeta0 and energy, which move in a fit: give --choose")
    return which.rule


def _show(found: "Fit", asked: "CaseInput") -> None:
    """Print a fit for people; angles in degrees."""
    from studies.grammar.axes import in_words

    where = ", ".join(in_words(name, value) for name, value in asked.place.items())
    console.say(f"rod: {asked.source}{f', at {where}' if where else ''}")
    console.say_units(asked.units, asked.assumed)
    console.say("")
    if found.solution is not None:
        _show_values(found, asked)
        _show_data(found, asked)
        _show_pairs(found)
        _show_minima(found, asked)
    for remark in (*found.remarks, *_cautions(found, asked)):
        console.say(f"caution: {remark}")
    count = "" if math.isnan(found.probability) else f", chance of larger residuals {found.probability:.3g}"
    console.say(f"{found.outcome} ({found.solves} solutions, {found.derivatives} with derivatives{count})")


def _as_data(found: "Fit", asked: "CaseInput") -> dict[str, Any]:
    """A fit as plain data for --json; angles in rad."""
    from studies.language.case_input import field_values

    columns = ("measured", "computed", "residuals")
    data = [
        {
            "group": group,
            **{name.removesuffix("s"): float(getattr(found, name)[i]) for name in columns},
            "shares": {name: float(row[i]) for name, row in found.shares.items()},
        }
        for i, group in enumerate(found.groups)
    ]
    same = ("outcome", "values", "rule", "condition", "directions", "cost", "freedom", "probability", "solves",
            "derivatives")  # fmt: skip
    return {
        "source": asked.source,
        "at": asked.place,
        "assumed": asked.assumed,
        "units": asked.units,
        **{name: getattr(found, name) for name in same},
        "intervals": {name: list(ends) for name, ends in found.intervals.items()},
        "covariance": found.covariance.tolist(),
        "correlation": found.correlation.tolist(),
        "shares": {group: found.share_of(group) for group in dict.fromkeys(found.groups)},
        "data": data,
        "minima": [
            {"values": m.values, "cost": m.cost, "as_good": m.as_good, "at_bound": list(m.at_bound)}
            for m in found.minima
        ],
        "remarks": list(found.remarks),
        "caution": " ".join(_cautions(found, asked)),
        "case": field_values(found.case),
    }


def _cautions(found: "Fit", asked: "CaseInput") -> list[str]:
    """The sentence of `solve` on what a real rod could not do."""
    from ..words import caution_words

    if found.solution is None:
        return []
    sentence = caution_words.said(caution_words.of_cases(found.solution, units=asked.units))
    return [sentence] if sentence else []


def _show_values(found: "Fit", asked: "CaseInput") -> None:
    from studies.grammar.axes import quantity_of

    from ..fitting import UNDETERMINED

    rows = []
    for name, value in found.values.items():
        low, high = (number_stated(name, end, asked.units) for end in found.intervals[name])
        between = f"{tables.text_of(low)} to {tables.text_of(high)}"
        known = "unknown" if math.isnan(low) else UNDETERMINED if math.isinf(high) else between
        stated = number_stated(name, value, asked.units), known, unit_stated(name, asked.units)
        rows.append([name, *stated, quantity_of(name).long_name])
    tables.print_table(["fitted", "value", "95 % interval", "unit", ""], rows)
    console.say(f"{found.rule}\n")


def _show_data(found: "Fit", asked: "CaseInput") -> None:
    """A row for each target and each third of the points: how well it is met, and its share in each field."""
    import numpy as np

    from solver.fits.data import target_parts
    from solver.observe.observables import OBSERVABLES

    targets = {group for group in found.groups if target_parts(group)[0] in OBSERVABLES}
    rows: list[list[Any]] = []
    for label, group, mine in _groups(found, asked, targets):
        shares = [f"{100 * row[mine].sum():.3g} %" if np.isfinite(row).all() else "" for row in found.shares.values()]
        pair: list[Any] = ["", "", ""] if targets else []
        if group in targets:
            name = target_parts(group)[0]
            stated = (number_stated(name, float(v[mine][0]), asked.units) for v in (found.measured, found.computed))
            pair = [*stated, unit_stated(name, asked.units)]
        rows.append([label, *pair, f"{math.sqrt(float(np.mean(found.residuals[mine] ** 2))):.3g}", *shares])
    heads = ["datum", *(["wanted", "fitted", "unit"] if targets else []), "residual"]
    tables.print_table([*heads, *(f"share in {name}" for name in found.values)], rows)
    size = "standard deviations" if found.rule.endswith("normal distribution") else "units of the target, or of rho"
    console.say(f"residual: root mean square in {size}; share: of the field's variance, all fields fitted together\n")


def _groups(found: "Fit", asked: "CaseInput", targets: set[str]) -> "list[tuple[str, str, Any]]":
    """A label, the group and which data belong to it: each target, and of each column of the points each third of L."""
    import numpy as np

    groups, rows = np.array(found.groups), []
    for group in dict.fromkeys(found.groups):
        mine = groups == group
        if group in targets or found.feet is None:
            rows.append((group, group, mine))
            continue
        s, L = found.feet[0], float(found.case.rod.L)
        third = np.minimum(3 * s // L, 2)
        for k in range(3):
            part = mine.copy()
            part[mine] = third == k
            if part.any():
                until = f"{(k + 1) * L / 3:.3g} {asked.units['length']}"
                rows.append((f"{group}, {part.sum()} points to s = {until}", group, part))
    return rows


def _show_pairs(found: "Fit") -> None:
    pairs = [
        f"{first} and {second} {found.correlation[i, j]:+.3f}"
        for i, second in enumerate(found.values)
        for j, first in enumerate(found.values)
        if j < i and math.isfinite(found.correlation[i, j])
    ]
    if pairs:
        console.say(f"correlation of {', '.join(pairs)}; condition number {found.condition:.3g}")


def _show_minima(found: "Fit", asked: "CaseInput") -> None:
    if not found.minima:
        return
    rows = []
    for minimum in found.minima:
        stated = {name: tables.text_of(number_stated(name, minimum.values[name], asked.units)) for name in found.values}
        cells = [text + " (bound)" * (name in minimum.at_bound) for name, text in stated.items()]
        rows.append([_sum(found, minimum.cost), *cells, "yes" if minimum.as_good == found.exact else "no"])
    heads = [tables.column_title(name, unit_stated(name, asked.units)) for name in found.values]
    goal = "data" if found.feet is not None else "target" if len(found.groups) == 1 else "targets"
    judged = f"reaches the {goal}" if found.exact else "excluded by the data"
    console.say("")
    tables.print_table(["sum of squares", *heads, judged], rows, title="other minima")
    console.say(f"sum of squares of the fit: {_sum(found, found.cost)}")


def _sum(found: "Fit", cost: float) -> str:
    """A sum of squares; 0 where the residuals are rounding."""
    return f"{2 * cost:.4g}" if cost > 1e-20 * len(found.groups) else "0"
