"""What pictures of unusual studies say, as stored in `pictures_*.words`: no word is cut off, and no two meet."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from tests.workbench import small, stored_figures
from workbench.figures import (
    along_rods,
    figure_kinds,
    map_figure,
    map_panel,
    one_rod,
    phase_portrait,
    study_figure,
    unrolled,
)
from workbench.figures.sheet import sheet
from workbench.run import in_memory
from workbench.stored import stored_verdicts
from workbench.stored.stored_study import StoredStudy

LAW = small.law(
    "contact_size_mean",
    "E",
    "not-falling",
    claim="a claim of many words",
    also=["kappa_mean", "kappa_max", "turns_around", "attached", "amplitude"],
)
E_OF_NINE = small.axis("E", (123456.7, 134567.8, 9))
E_OF_TWO, E_OF_THREE = small.axis("E", [1e4, 3.7e5]), small.axis("E", [1e4, 2e4, 4e4])
WIDE = small.axis("E", [1e4, 1.1e4, 1.2e4, 2e4, 5e4, 3.7e5]) + small.axis("F3", [5.0, 20.0, 80.0]) + LAW
FORMULA = "-8*pi**2*L**-2*cm + 0*bending_stiffness/(N*cm**3) + bowed**0.5/cm"
ANGLE_LAWS = small.law("kappa_max", "E", claim="a", kind="equals", formula=FORMULA, absolute=9e9) + small.law(
    "amplitude", "E", claim="b", kind="bounded", least=0.5
)
LONG = "A title that goes on for longer than a page of this width can hold, " * 2


def drawn_map(change: Callable[[xr.Dataset], xr.Dataset], **more: Any) -> Figure:
    """The map of the bends of a study over E and R of which something is changed."""
    return map_figure.figure(StoredStudy(change(small.study_dataset("regimes"))), **{"show": ["bends"], **more})


def three(more: str = "") -> xr.Dataset:
    """Over three axes, with a law along one of them and with more laws."""
    return in_memory.run(small.study(small.THREE + more, 'observables = ["bends", "turns_around"]'))


def set_to(name: str, values: Callable[[xr.DataArray], Any]) -> Callable[[xr.Dataset], xr.Dataset]:
    """The dataset with other values of a variable, which are computed from the stored ones."""
    return lambda ds: ds.assign({name: ds[name].copy(data=values(ds[name]))})


def in_classes(turns: xr.DataArray) -> np.ndarray:
    return np.arange(turns.sizes["E"])[:, None] // 4 * 100 + np.zeros(turns.sizes["R"])


def nearly_constant(attached: xr.DataArray) -> np.ndarray:
    return -12.3456789 * (1 + 1e-15 * np.arange(attached.size).reshape(attached.shape))


def noise(error: float) -> Callable[[xr.Dataset], xr.Dataset]:
    """The attached shares of the dataset as rounding, with errors of this size."""

    def change(ds: xr.Dataset) -> xr.Dataset:
        attached = ds["attached"]
        rounding = 1e-12 * np.sin(np.arange(attached.size)).reshape(attached.shape)
        return ds.assign(attached=attached.copy(data=rounding), attached_error=attached.copy(data=0 * rounding + error))

    return change


def every_kind_of_cell(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with cells that are not solved, that lift off, and that have no number of bends."""
    texts, turns = np.full(ds["bends"].shape, "", dtype=object), ds["bends"].values.astype(float)
    solved = np.ones(turns.shape, dtype=bool)
    solved[:3, :4], texts[10:, 5:9], turns[20:, 15:], turns[:3, :4] = False, "pulled", np.nan, np.nan
    changed = {"solved": solved, "caution": texts, "bends": turns}
    return ds.drop_vars("beta").assign({name: ds[name].copy(data=values) for name, values in changed.items()})


def samples_on_a_plane() -> xr.Dataset:
    axes = small.axis("E", [1e4, 2e4]) + small.axis("R", [0.5, 1.0])
    return in_memory.run(small.study(f"{axes}[sample]\nmethod = 'sobol'\nsize = 4\n[sample.F1]\nfrom = 1.0\nto = 9.0"))


def cautions(text: str, count: int | None = None) -> Callable[[xr.DataArray], np.ndarray]:
    def values(caution: xr.DataArray) -> np.ndarray:
        texts = caution.values.astype(object)
        texts.ravel()[:count] = text
        return texts

    return values


def unsolved(rows: slice) -> Callable[[xr.Dataset], xr.Dataset]:
    """The dataset whose cases with these moduli are not solved."""

    def change(ds: xr.Dataset) -> xr.Dataset:
        ds = ds.copy(deep=True)
        ds["solved"][rows] = False
        for name in set(ds.data_vars) & {"bends", "kappa_mean", "alpha", "z"}:
            ds[name] = ds[name].astype(float)
            ds[name][rows] = np.nan
        return ds

    return change


def away_from_buckling() -> xr.Dataset:
    """Pipes without the one at -164 kN, whose small wave begins where last digits decide."""
    return small.study_dataset("pipe_horizontal").isel(FZ=slice(1, None, 2))


def without_number(ds: xr.Dataset) -> xr.Dataset:
    """The dataset whose first case is unsolved, and whose second one is solved and has no mean curvature."""
    ds = unsolved(slice(0, 1))(ds)
    ds["kappa_mean"][1] = np.nan
    return ds


FURTHER = small.law("bends", "F1", "falls", claim="(2)") + small.law("turns_around", "F1", "falls", claim="(3)")
MAPS: dict[str, Callable[[], Figure]] = {
    "a third axis": lambda: map_figure.figure(StoredStudy(three())),
    "a value of the third axis": lambda: map_figure.figure(StoredStudy(three()), show=["bends"], at={"F1": 9.0}),
    "laws along a further axis": lambda: map_figure.figure(StoredStudy(three(FURTHER)), "R", "E", at={"F1": 5.0}),
    "many counts": lambda: drawn_map(set_to("bends", in_classes)),
    "large counts": lambda: drawn_map(set_to("bends", lambda turns: turns * 12345)),
    "constant": lambda: drawn_map(set_to("attached", nearly_constant), show=["attached"]),
    "all lift off": lambda: drawn_map(set_to("caution", cautions("pulled"))),
    "three not checked": lambda: drawn_map(set_to("caution", cautions("not checked: self-contact", 3))),
    "over the other axis": lambda: drawn_map(lambda ds: ds, x="R", y="E"),
    "level but for the errors": lambda: drawn_map(noise(2e-12), show=["attached"]),
    "noise above the errors": lambda: drawn_map(noise(1e-14), show=["attached"]),
    "cells of every kind": lambda: drawn_map(every_kind_of_cell),
    "a sample": lambda: figure_kinds.figure(
        StoredStudy(samples_on_a_plane()), "map", show=["turns_around"], at={"sample": 3}
    ),
    "half not solved": lambda: drawn_map(unsolved(slice(13, None)), shapes=map_panel.ShapeCounts(2, 1)),
    "nothing solved": lambda: drawn_map(unsolved(slice(None)), show=None),
    "shapes": lambda: drawn_map(lambda ds: ds, show=None, shapes=map_panel.ShapeCounts(3, 2)),
}


def drawn_lines(
    axes: str, head: str = "", change: Callable[[xr.Dataset], xr.Dataset] = lambda ds: ds, stations: int = 21,
    **more: Any,
) -> Figure:  # fmt: skip
    """The lines of a study of which something is changed; stations: what a picture needs where no study is left."""
    stored = StoredStudy(change(in_memory.run(small.study(axes, head).at_stations(stations))))
    return figure_kinds.figure(stored, figure_kinds.kind_without_map(stored), **more)


def without_study(ds: xr.Dataset) -> xr.Dataset:
    """The dataset without the text of its study, so that it is drawn at its stations."""
    return ds.drop_attrs(deep=False).assign_attrs({key: of for key, of in ds.attrs.items() if key != "study"})


def thinner(factor: float) -> Callable[[xr.Dataset], xr.Dataset]:
    return lambda ds: without_study(ds).assign(z=factor * ds["z"])


def level(wraps: xr.DataArray) -> np.ndarray:
    return 3.5 + 1e-13 * np.arange(wraps.size)


def two_laws_of_one_claim(panel: str) -> Figure:
    ds = small.six()
    (row, *_) = stored_verdicts.verdicts(ds)
    return study_figure.figure(StoredStudy(ds), [row, {**row, "observable": "bends"}], sheet(panel=panel))


def grid(**more: Any) -> Figure:
    return study_figure.figure(StoredStudy(small.six()), sheet=sheet(**more))


def of_fig6(side: str) -> xr.Dataset:
    return without_study(small.study_dataset("fig6").assign_attrs(side=side))


def with_laws_of_angles(**more: Any) -> Figure:
    """Of a law with a formula in symbols, and of one that bounds an angle."""
    head = 'observables = ["amplitude", "bends", "turns_around"]'
    return drawn_lines(E_OF_TWO + '[expressions]\nbowed = "kappa_max*rho"\n' + ANGLE_LAWS, head, **more)


def with_counts_that_are_level() -> Figure:
    ds = small.six()
    flag = (ds["bends"] * 0 + 1).assign_attrs(long_name="1 where the rod intersects itself, else 0")
    return study_figure.figure(StoredStudy(ds.assign(bends=ds["bends"] * 0 + 3, overlaps=flag)), [])


def angles(**more: Any) -> Figure:
    return study_figure.figure(StoredStudy(small.study_dataset("fig7_3_start_angle")), **more)


LINES: dict[str, Callable[[], Figure]] = {
    "one value": lambda: drawn_lines(small.axis("E", [1e4])),
    "large numbers": lambda: drawn_lines(E_OF_NINE),
    "wide verdict": lambda: drawn_lines(WIDE, change=lambda ds: ds.assign_attrs(title=LONG)),
    "thin": lambda: drawn_lines(E_OF_TWO, change=thinner(1000), stations=1001),
    "thin beside a law": lambda: drawn_lines(E_OF_TWO + LAW, change=thinner(1000), stations=1001),
    "flat": lambda: drawn_lines(E_OF_TWO, change=thinner(1 / 1000), stations=401),
    "an unsolved case": lambda: drawn_lines(E_OF_THREE, 'observables = ["kappa_mean"]', unsolved(slice(1, 2))),
    "a case without a number": lambda: drawn_lines(E_OF_THREE, 'observables = ["kappa_mean"]', without_number),
    "level but for rounding": lambda: drawn_lines(
        E_OF_NINE, change=set_to("turns_around", level), show=["turns_around"]
    ),
    "panel of a law": lambda: grid(panel="(2)"),
    "panel of a curve": lambda: drawn_lines("", sheet=sheet(panel="curve")),
    "panel of an axis": lambda: grid(panel="R"),
    "without a title": lambda: grid(titled=False),
    "two laws of one claim": lambda: two_laws_of_one_claim("(2)"),
    "one of two laws": lambda: two_laws_of_one_claim("(2) bends"),
    "observables": lambda: angles(show=["turns_around", "bends", "condition"]),
    "a push outside": lambda: one_rod.figure(StoredStudy(of_fig6("outside"))),
    "a push inside": lambda: one_rod.figure(StoredStudy(of_fig6("inside"))),
    "stored stations": lambda: drawn_lines("", change=without_study, stations=401),
    "laws of angles": with_laws_of_angles,
    "panel of an angle": lambda: with_laws_of_angles(sheet=sheet(panel="b")),
    "counts that are level": with_counts_that_are_level,
    "panel of an observable": lambda: angles(sheet=sheet(panel="turns_around")),
}


@cache
def four() -> xr.Dataset:
    """Four rods of growing stiffness at 201 stations, which are drawn as they are stored."""
    outputs = 'outputs = ["beta", "dbeta", "alpha", "z", "kappa", "contact"]\n'
    return in_memory.run(small.study(small.axis("E", [5e3, 1e4, 2e4, 4e4]), outputs).at_stations(201))


RODS: dict[str, Callable[[], Figure]] = {
    "curves": lambda: unrolled.figure(StoredStudy(four())),
    "ridge": lambda: along_rods.figure(StoredStudy(four())),
    "ridge of any array": lambda: along_rods.figure(StoredStudy(four()), show=["F1", "alpha"]),
    "one rod alone": lambda: along_rods.figure(StoredStudy(four()), at={"E": 1e4}, show=["beta", "push"]),
    "portraits": lambda: phase_portrait.figure(StoredStudy(four()), at={"E": 1e4}),
    "pipe": lambda: along_rods.pipe(StoredStudy(four())),
    "pipes as a map": lambda: along_rods.pipe(StoredStudy(away_from_buckling())),
    "states": lambda: along_rods.states(StoredStudy(small.study_dataset("capstan"))),
    "bars": lambda: figure_kinds.figure(StoredStudy(small.six()), "bars", x="R", show=["kappa_max"], at={"E": 2e4}),
}


@pytest.mark.parametrize(("family", "pictures"), [("maps", MAPS), ("lines", LINES), ("rods", RODS)])
def test_pictures_of_unusual_studies_can_be_read_and_show_what_is_stored(
    family: str, pictures: dict[str, Callable[[], Figure]]
) -> None:
    stored_figures.check(f"pictures_{family}", pictures)
