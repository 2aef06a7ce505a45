"""The one table of pictures: what each kind draws, by which options, and the kind that a dataset has by default.

What draws a kind is imported where it is drawn, because --help reads the table.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from solver.problem.errors import InputError, choices, no_such

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..stored.stored_study import StoredStudy
    from .sheet import Sheet

FEW = 3  # values of an axis, up to which a study of two axes is drawn as lines


@dataclass(frozen=True)
class FigureKind:
    """A kind of picture.

    path: the module in `workbench` and the function of its figure of a stored study and a sheet. options: its further
    keywords, and range where it draws the ranges of the sheet. shows: what it shows of a study, for --help. of: the
    data that it draws.
    """

    path: str
    options: tuple[str, ...] = ()
    shows: str = ""
    of: str = "study"

    def draw(self, stored: "StoredStudy", **options: Any) -> "Figure":
        """The picture of a dataset."""
        from studies import tenants

        module, _, name = f"workbench.{self.path}".rpartition(".")
        fig: Figure = getattr(tenants.module_of(module), name)(stored, **options)
        return fig


KINDS = {
    "map": FigureKind("figures.map_figure.figure", ("x", "y", "show", "at", "shapes"), "each observable over two axes"),
    "lines": FigureKind("figures.study_figure.figure", ("x", "show", "range"), "unrolled views, and observables "
        "along each axis with their laws"),
    "samples": FigureKind("figures.scatter.figure", ("show",), "each observable against each sampled field"),
    "rod": FigureKind("figures.one_rod.figure", ("at",), "one rod: its angle and its push along s, and its unrolled "
        "view"),
    "curves": FigureKind("figures.unrolled.figure", ("x", "at"), "unrolled views in the colours of the push"),
    "ridge": FigureKind("figures.along_rods.figure", ("x", "at", "show"), "β, κ, the push or other arrays along s"),
    "portrait": FigureKind("figures.phase_portrait.figure", ("x", "at"), "(β, β′) beside the potential G"),
    "states": FigureKind("figures.along_rods.states", ("x", "at"),
        "where rods with weight are straight, sinusoidal or helical"),
    "pipe": FigureKind("figures.along_rods.pipe", ("x", "at"), "the azimuth along s in the colours of the push, with "
        "these states"),
    "well": FigureKind("figures.well_tracks.figure", ("x", "at", "yield_stress"), "force, push, dogleg and stress of "
        "one pipe with the depth down, and weight on bit against slack-off"),
    "drawing": FigureKind("figures.drawing.figure", ("at",), "one rod on its cylinder from the side, at true scale, "
        "with its dimensions"),
    "section": FigureKind("figures.section.figure", ("at",), "the turns of a wound rod in a section through the axis, "
        "with the gaps between them"),
    "bars": FigureKind("figures.bars.of_cases", ("x", "at", "show"),
        "observables along an axis of at most twelve values"),
    "equilibria": FigureKind("figures.equilibria_figure.figure", ("show",), of="equilibria"),
    "loops": FigureKind("figures.equilibria_figure.loops", of="loops"),
    "branches": FigureKind("figures.bifurcation.figure", ("show", "range"), of="branches"),
    "folds": FigureKind("figures.region_figure.figure", ("show",), of="folds"),
    "trade": FigureKind("lab.trade_figure.figure", ("cost",), of="trade"),
    "extremes": FigureKind("lab.robustness.figure", of="extremes"),
    "fit": FigureKind("figures.fit_figure.figure", of="fit"),
    "indices": FigureKind("figures.bars.indices", of="indices"),
    "tornado": FigureKind("figures.bars.tornado", of="tornado"),
}  # fmt: skip
OF_STUDIES = {name: kind for name, kind in KINDS.items() if kind.of == "study"}


def figure(stored: "StoredStudy", kind: str | None = None, sheet: "Sheet | None" = None, **options: Any) -> "Figure":
    """The picture of a dataset of any kind; kind: a name of `KINDS`, by default as the dataset says.

    Raises `InputError` as of `kind_of` and of the figure.
    """

    name = kind or stored.kind.figure
    if name in ("", "study"):
        name = kind_of(stored, None, [option for option in options if option != "verdicts"])
    return KINDS[name].draw(stored, **options | ({} if sheet is None else {"sheet": sheet}))


def kind_of(stored: "StoredStudy", kind: str | None = None, given: Sequence[str] = ()) -> str:
    """The kind of picture of a study: the one that is asked for; default: a map over two axes, one rod, else lines,
    also along axes of `FEW` values.

    given: options; a study whose default kind does not have them is drawn in the first kind that does.

    Raises `InputError` for an unknown kind, and for an option that the kind does not have.
    """
    if kind is None:
        default = _default_kind(stored)
        kind = next(
            (candidate for candidate in (default, "lines", *OF_STUDIES) if set(given) <= set(KINDS[candidate].options)),
            default,
        )
    elif kind not in OF_STUDIES:
        raise no_such("kind of picture", kind, OF_STUDIES)
    for name in given:
        if name not in KINDS[kind].options:
            takers = choices(other for other, row in OF_STUDIES.items() if name in row.options)
            raise InputError(f"--{name.replace('_', '-')} is no option of --kind {kind}; choose --kind from {takers}")
    return kind


def _default_kind(stored: "StoredStudy") -> str:
    from studies.grammar.axes import SAMPLE

    from .map_cells import mappable

    if stored.is_refined and stored.varied:
        return "map" if len(stored.refinement.lattice.axes) > 1 else "lines"
    long = [axis for axis in mappable(stored) if stored.sizes[axis] > FEW]
    is_map = len(long) > 1 and SAMPLE not in stored.axes and stored.observables
    return "map" if is_map else kind_without_map(stored)


def kind_without_map(stored: "StoredStudy") -> str:
    """The kind of picture of a study that shows each of its cases: one rod, samples, or lines along its axes."""
    from studies.grammar.axes import SAMPLE

    if not stored.varied:
        return "rod"
    return "samples" if stored.varied == [SAMPLE] and stored.observables and not stored.is_refined else "lines"
