"""The kinds of scene: one table, which `scene` reads; a new kind is a row of it.

Before it stand the colours and the words of its rows.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.colors import Colormap

from solver.problem.errors import InputError, check_known
from studies.grammar.axes import SAMPLE

from ..figures import colours
from ..geometry.centreline import NEEDED, Array, Centreline
from ..stored.stored_study import StoredStudy
from ..words import labels, unit_habits

PUSH_RAMP = colours.push_ramp()
OFF_WALL = colours.LIGHTEST  # a rod without push

Extremes = tuple[float, float] | None  # the least and the largest value of all rods; None without rods


@dataclass(frozen=True, eq=False)
class Paint:
    """The colour of a tube: one for all, or by a value along it between `low` and `high`.

    stripe: the colour of a stripe that turns with the material; default: none. label: what the bar of its colours is
    called, the quantity with its unit; default: no bar. foot: where the bar begins; default: at `low`. extend: at which
    of its ends an arrow stands for values beyond, as of `Figure.colorbar`. strands: the colours of two strands and of
    base pairs, which are drawn in place of the tube.
    """

    colour: str = colours.NEUTRAL
    ramp: Colormap | None = None
    low: float = 0.0
    high: float = 1.0
    stripe: str = ""
    label: str = ""
    foot: float | None = None
    extend: str = "neither"
    strands: tuple[str, ...] = ()


def by_push(units: dict[str, str], extremes: Extremes) -> Paint:
    """By the cylinder's push, one scale for all rods, as far below 0 as above it and pale there."""
    low, end = colours.push_scale(*extremes) if extremes else (0.0, 0.0)
    if end == 0:
        return Paint()
    unit = labels.unit(unit_habits.unit_shown("push_max", units))
    return Paint(ramp=PUSH_RAMP, low=-end, high=end, label=colours.push_words(unit, low), foot=low)


def by_curvature(units: dict[str, str], extremes: Extremes) -> Paint:
    """By the curvature, one scale for all rods; where it hardly varies, from 0, so that this is seen."""
    low, high = extremes or (0.0, 0.0)
    if high == 0:
        return Paint()
    low *= low < colours.UNIFORM * high
    unit = labels.unit(unit_habits.unit_shown("kappa_max", units))
    return Paint(ramp=colours.ramp(), low=low, high=high, label=f"curvature κ [{unit}]")


def set_range(paint: Paint, chosen: tuple[float, float]) -> Paint:
    """The colours of a paint between two other values.

    Raises `InputError` for a scale of pushes that is not pale at 0.
    """
    low, high = chosen
    if paint.ramp is not PUSH_RAMP:
        return replace(paint, low=low, high=high)
    if low not in (0.0, -high):
        raise InputError(
            f"the colours of a push are pale at 0, so --color-range is 0,HIGH or -HIGH,HIGH, got {low:g},{high:g}"
        )
    return replace(paint, low=-high, high=high, foot=low)


ASKED = 6  # digits of a value with which --at finds its case again


@dataclass(frozen=True)
class Cell:
    """The words of a view.

    Attributes
    ----------
    caption, line
        Below it; the same in one line, below views that are wide; default: the caption.
    why_empty
        Why there is no rod.
    number, stable
        The number of an equilibrium, in a dot that is filled where it is stable; default: no dot.
    """

    caption: str = ""
    line: str = ""
    why_empty: str = ""
    number: int | None = None
    stable: bool = False


def value_cell(stored: StoredStudy, names: list[str], where: dict[str, int]) -> Cell:
    """A cell with the case's values along the axes below it; of one axis the number, whose unit stands above all."""
    if len(names) == 1:
        return Cell(headings(stored, names[0], [where])[1])
    return Cell("\n".join(values(stored, {name: where[name] for name in names})))


def equilibrium(stored: StoredStudy, names: list[str], where: dict[str, int]) -> Cell:
    """A cell with the number of an equilibrium, whether it is stable, and its energy."""
    case = stored.select(where)
    index = int(case["index"])
    words = "stable\n" if index == 0 else f"unstable\nin {index} way{'s' * (index > 1)}"
    energy = labels.values_alike(stored["energy"], stored["energy"].values)[where["equilibrium"]]
    line = f"{' '.join(words.split())}, {energy}"
    return Cell(f"{words}\n{energy}", line, number=int(case["equilibrium"]), stable=index == 0)


RELEASED = "let_go"  # the dimension of a rod that the cylinder holds on, and of the same rod let go
CASE, NOTE = "case_in_words", "note"  # attributes of the two; of their motion
LET_GO = "let-go"  # the kind of scene of the two
ENDS_HELD = "Let go, both ends keep the places, directions and rotations that they have on the cylinder."
SIDES_OF_RELEASE = ("held on the cylinder", "let go: the cylinder only pushes")


def release(stored: StoredStudy, names: list[str], where: dict[str, int]) -> Cell:
    """A cell that says whether the cylinder holds the rod on."""
    return Cell(SIDES_OF_RELEASE[where[RELEASED]])


def headings(stored: StoredStudy, name: str, cases: list[dict[str, int]]) -> list[str]:
    """The headings of a table: the quantity of an axis with its unit, and the value of each case without."""
    array = stored[name]
    each = labels.in_label_unit(array, array.values[[where[name] for where in cases]])
    return [labels.axis_label(array), *(labels.minus_signs(labels.number(float(value))) for value in each)]


def case_values(stored: StoredStudy, where: Mapping[str, int]) -> str:
    """The values of a case along all axes, in one line, with as many digits as --at needs."""
    return ", ".join(values(stored, where, ASKED))


def values(stored: StoredStudy, where: Mapping[str, int], digits: int = 4) -> list[str]:
    """The value of a case along each of these axes, with its unit; an equilibrium's number is none.

    The number of a sample is followed by the values of its fields.
    """
    each = []
    for axis, i in where.items():
        names = [] if axis in UNNAMED else [axis]
        if axis == SAMPLE:
            names += stored.sampled
        each += [stored.equations({name: i}, digits) for name in names]
    return each


CURVE = frozenset(NEEDED)
UNNAMED = ("equilibrium", RELEASED)  # dimensions that are no field


@dataclass(frozen=True)
class SceneKind:
    """A kind of scene.

    Attributes
    ----------
    cells
        What stands on the page: one rod, each case of an axis in a cell of its own, or all cases of an axis in one.
    reads
        Variables of the dataset that it opens, beside the case's outcome, caution and arc length. Nothing else is read.
    value, quantity
        What the colour shows along a rod at s, (k,); nothing else is computed there. Default: one colour a rod. The
        quantity that has its unit.
    paint
        The colours of all rods, from the units and the extremes of the value; for "together" each rod has
        the colour of its value on the axis instead.
    legend
        Colours that the bar does not explain, each with its meaning.
    cell
        The words of the cell of a case, from the dataset, the axes named below it and the case's indices.
    of_equilibria
        Whether it shows stored equilibria alone.
    most
        Cells of one axis that are shown.
    notes
        Sentences beside the legend.
    caption
        Sentences of the caption.
    numbers
        What is said in numbers of the rod of a scene of one, from its curve and its case.
    """

    name: str
    cells: Literal["one", "each", "together"]
    reads: frozenset[str] = CURVE
    value: Callable[[Centreline, Array], Array] | None = None
    quantity: str = ""
    paint: Callable[[dict[str, str], Extremes], Paint] = lambda units, extremes: Paint()
    legend: tuple[tuple[str, str], ...] = ()
    cell: Callable[[StoredStudy, list[str], dict[str, int]], Cell] = value_cell
    of_equilibria: bool = False
    most: int = 9
    notes: tuple[str, ...] = ()
    caption: tuple[str, ...] = ()
    numbers: Callable[[Centreline, StoredStudy], list[str]] = lambda line, case: []

    def value_in(self, units: dict[str, str]) -> Callable[[Centreline, Array], Array] | None:
        """The value in the unit in which it is stated, None for one colour."""
        if (value := self.value) is None:
            return None
        size = unit_habits.size_shown(self.quantity, units)
        return lambda line, s: size * value(line, s)


PAIRS, RISE = 10.5, 0.34  # base pairs of DNA in a turn of its strands; nm from one to the next


def push_in_numbers(line: Centreline, case: StoredStudy) -> list[str]:
    """The least and the largest push of the cylinder, or the one that it has all along, and the loads of the case."""
    units = case.units
    push = line.push(np.linspace(line.s[0], line.s[-1], 4 * line.s.size))
    unit = labels.unit(unit_habits.unit_shown("push_max", units))
    push *= unit_habits.size_shown("push_max", units)
    low, high = (labels.minus_signs(labels.number(float(end), 3)) for end in (push.min(), push.max()))
    tension = float(case["F3"]) if "F3" in case else case.study.base.F3 or 0.0
    given = ("tension", "F3", tension), ("torque", "M3", float(case["M3"]))
    each = [(what, unit_habits.value_with_unit(name, size, units, 3)) for what, name, size in given if size]
    loads = labels.minus_signs(" and ".join(f"{size} {what}" for what, size in each))
    said = f"{low} {unit} everywhere" if low == high else f"{low} to {high} {unit}"
    return [f"the push{f' at {loads}' * bool(loads)}: {said}"]


STRANDS = tuple(zip(colours.STRANDS, ("one strand", "the other strand", "base pairs"), strict=True))
DRAWN = (
    f"computed: the centreline, its twist and the push; drawn: strands of {PAIRS} base pairs of {RISE} nm a turn, "
    "which turn with the material"
)
PUSH: dict[str, Any] = {"value": lambda line, s: line.push(s), "quantity": "push_max", "paint": by_push}
TABLE = (
    SceneKind("plain", "one"),
    SceneKind("contact", "one", **PUSH),
    SceneKind("curvature", "one", value=lambda line, s: line.kappa(s), quantity="kappa_max", paint=by_curvature),
    SceneKind("twist", "one", CURVE | {"gamma"}, legend=((colours.STRIPE, "a stripe of the material"),),
         paint=lambda *_: Paint(colours.UNPAINTED, stripe=colours.STRIPE)),
    SceneKind("double-helix", "one", CURVE | {"gamma"}, paint=lambda *_: Paint(strands=colours.STRANDS), legend=STRANDS,
         notes=(DRAWN,), numbers=push_in_numbers),
    SceneKind("ghosts", "together", most=3),
    SceneKind("grid", "each", **PUSH),
    SceneKind("equilibria", "each", CURVE | {"energy", "index"}, **PUSH,
         cell=equilibrium, of_equilibria=True, most=18, notes=("below each rod its energy",)),
    SceneKind(LET_GO, "each", **PUSH, cell=release, caption=(ENDS_HELD,)),
)  # fmt: skip
KINDS = {kind.name: kind for kind in TABLE}


def kind_of(name: str) -> SceneKind:
    """The kind of that name. Raises `InputError` with the choices."""
    check_known("kind of scene", name, KINDS)
    return KINDS[name]


def default_kind(stored: StoredStudy) -> str:
    """The kind by which a dataset is drawn unless another is asked for."""
    return "equilibria" if stored.axes == ["equilibrium"] else "contact"
