"""The command fit: values of fields of a case that fit targets and measured points."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from .case_options import Given, takes_case
from .options import At, Choose, Reading, Table1, argument, flag, option
from .present import Result, presents

if TYPE_CHECKING:
    from studies.language.case_input import CaseInput

OUT = (".toml", ".csv")


Study = Annotated[
    Path | None, argument("FILE|STUDY", "TOML file or name of a study; default: Table 1, or the options alone.")
]
Target = Annotated[
    list[str] | None,
    option("NAME=VALUE", "Wanted value of an observable, such as height=10, in the units of the case; repeatable."),
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
)
@takes_case()
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
    given: Given,
    choose: Choose = None,
) -> Result:
    """Find values of fields that give wanted observables or fit measured points, with their intervals.

    The search starts from the values of the case and from Sobol' points, and uses exact derivatives. It prints 95 %
    intervals, which data decide each value, correlations, and other minima.

    Angles: a number in rad, or a form like 30deg or pi/6. Exit status 1 if the data do not determine the values.
    """
    from solver import InputError
    from solver import fit as fitted

    from .. import fitting
    from . import option_checks
    from .fit_report import as_data, say

    targets = option_checks.numbers("--target", target or [])
    read, sigmas = fitting.read_points(points) if points is not None else (None, {})
    asked = _case(file, at or [], given, table1, reading)
    found = fitted(
        asked.case,
        _vary(vary, option_checks.ranges("--bounds", bounds or [])),
        targets,
        read,
        sigma={**sigmas, **option_checks.numbers("--sigma", sigma or [])},
        wrapped=wrapped,
        starts=starts,
        seed=seed,
        choose=_rule(asked, choose),
    )
    if not found.reached:
        raise InputError(found.outcome.removeprefix("failed: "))
    status = 0 if found.solved else 1
    if found.solution is None:
        return Result(lambda: as_data(found, asked), lambda: say(found, asked), status)
    return Result(
        lambda: as_data(found, asked),
        lambda: say(found, asked),
        status,
        lambda: fitting.dataset_of(found, asked.units, read, wrapped),
        lambda path: fitting.write(found, asked, path),
        "fit",
    )


def _case(file: Path | None, at: list[str], given: Given, table1: bool, reading: str | None) -> "CaseInput":
    """The case, of a study at a place of its axes."""
    from solver import InputError
    from studies import load
    from studies.language.case_input import check_alone, read_case

    from ..store.one_case import case_at, outline
    from .option_checks import axis_values

    if file is None:
        if at:
            raise InputError(f"--at {at[0]} names an axis of a study, and no study is given")
        return read_case(None, given.values, given.units, table1, reading)
    check_alone(file, given.units, table1)
    study = load(str(file)).under(reading)
    if study.follow is not None:
        raise InputError(
            f"{study.name} follows one equilibrium along {study.followed}: fit takes a study of single cases"
        )
    return case_at(study, axis_values(outline(study), at), given.values)


def _vary(texts: list[str] | None, bounds: dict[str, tuple[float, float]]) -> "dict[str, tuple[float, float] | None]":
    """Field -> bounds or None. Raises `InputError` where no field is named, or one is bounded that is not varied."""
    from solver import InputError

    from .option_checks import names as read_names

    names = read_names(texts)
    if not names:
        raise InputError("fit needs --vary NAMES, the fields that are fitted, such as --vary E,M3")
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError(f"--vary names {twice[0]} twice")
    for name in bounds:
        if name not in names:
            raise InputError(f"--bounds {name} is of no field of --vary; choose from {', '.join(names)}")
    return {name: bounds.get(name) for name in names}


def _rule(asked: "CaseInput", choose: str | None) -> Any:
    """Which equilibrium of an ends problem the search begins with."""
    from solver import InputError
    from solver.choose.selection import NEAREST

    from .option_checks import parse_choose

    which = asked.study.equilibrium if asked.study else None
    if choose is not None:
        which = parse_choose(choose, asked.case.given)
    if which is None:
        return NEAREST
    if which.rule is None:
        raise InputError("the study names its equilibrium by dbeta0 and energy, which move in a fit: give --choose")
    return which.rule
