"""What a study says, and what follows from it alone: the fields of its file, the kind of problem, what varies.

`model.Study` adds the checks, which read this, and the cases.
"""

from math import prod
from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, PrivateAttr

from solver import Ends, InputError, Start
from solver.observe.observables import OBSERVABLES
from solver.problem.case import DIRECT, PAIRS
from solver.problem.errors import DEFAULT_TOLERANCE, choices

from ..grammar import axes as parts
from ..grammar.axes import CYLINDER, ENDS, ROD, SAMPLE, START, Axis, Base, Dimension, Misplaced, Units, Which
from ..laws.verdicts import Law
from .case_tables import Table
from .readings import TABLE_1, parse
from .refinement import Refine
from .samples import Sample

# The quantities that can be stored along the rod: names of `Solution`.
OUTPUTS = (
    "beta", "dbeta", "alpha", "z", "gamma", "position", "kappa",
    "F1", "F2", "F3", "FY", "contact", "M1", "M2", "h",
)  # fmt: skip

# The default observables of a study.
OBSERVED = ["turns", "wraps", "height", "kappa_max", "contact_size_mean", "attached"]

SOURCES = ("sample", "zip", "table")  # the tables of a study that give fields that vary together

MAX_STATIONS = 100_001


class StudyData(BaseModel):
    """The fields of a study, and what follows from them without a solution; `model.Study` checks them."""

    model_config = parts.STRICT

    name: str = Field("study", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$", max_length=200)
    title: parts.Line
    units: Units
    reading: str | None = None
    base: Base = Base()
    equilibrium: Which | None = None
    axes: dict[str, Axis] = {}
    sample: Sample | None = None
    zip: dict[str, Annotated[list[float], Field(fail_fast=True)]] | None = None
    table: Table | None = None
    refine: Refine | None = None
    expressions: dict[str, str] = {}
    observables: list[str] = OBSERVED
    outputs: list[str] = ["beta", "alpha", "z", "contact"]
    stations: int = Field(201, ge=2, le=MAX_STATIONS)
    tol: float = Field(DEFAULT_TOLERANCE, gt=0, lt=1)
    method: str = "auto"
    laws: list[Law] = []
    _text: str = PrivateAttr("")
    _samples: Dimension | None = PrivateAttr(None)

    @property
    def text(self) -> str:
        """The TOML text of the study, or an empty text."""
        return self._text

    @property
    def unit_system(self) -> dict[str, str]:
        """``{"length": "cm", "force": "N"}``."""
        return self.units.model_dump()

    @property
    def kind(self) -> type:
        """Start or Ends, from the names of the given fields."""
        sampled = self.sampled if self.refine is None else ()
        said = {*self.base.given, *sampled, *(name for name, axis in self.axes.items() if not axis.follow)}
        return Ends if said & (set(ENDS) - set(START)) else Start

    @property
    def held(self) -> tuple[str, ...]:
        """The given fields of Ends that replace a dead load or an end angle."""
        said = {*self.base.given, *self.varied}
        return tuple(partner for _, partner in PAIRS if partner in said)

    @property
    def reactions(self) -> tuple[str, ...]:
        """What is stored of held ends besides the loads: the index, and the end angles that are found."""
        angles = [field for field, partner in PAIRS[:2] if partner in self.held]
        return ("held_index", *angles) if self.held else ()

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the fields that base may hold."""
        if self.reading:
            return (*TABLE_1, "side")
        return (*ROD, *CYLINDER, *(START if self.kind is Start else ENDS))

    @property
    def grid(self) -> dict[str, Axis]:
        """The axes that are dimensions: all, but those of a refined study, whose cases are samples."""
        return self.axes if self.refine is None else {}

    @property
    def follow(self) -> Axis | None:
        """The axis along which the equilibrium of a start problem is followed, or None."""
        return next((axis for axis in self.axes.values() if axis.follow and axis.is_open), None)

    @property
    def followed(self) -> str | None:
        """The name of the axis along which equilibria are followed, or None."""
        return next((name for name, axis in self.axes.items() if axis.follow), None)

    @property
    def has_branches(self) -> bool:
        """Whether each case is labelled with its branch: ends problems over axes."""
        return bool(self.grid) and self.kind is Ends

    @property
    def sweeps(self) -> bool:
        """Whether the study is a sweep, whose cases continue from one another to tell their branches.

        With weight or friction each case continues from the straight rod, whatever its neighbours are.
        """
        return self.has_branches and not self.varies

    @property
    def varies(self) -> bool:
        """Whether loads vary along the rods: weight or friction is given or varied."""
        return any(self.base.given.get(name) or name in self.varied for name in ("weight", "friction"))

    @property
    def size(self) -> int:
        """Number of cases."""
        return max(self.samples_count, 1) * prod(axis.size for axis in self.grid.values())

    @property
    def samples_count(self) -> int:
        """Number of samples; 0 where nothing is sampled."""
        if self._samples is None and self.refine is not None:
            return prod(axis.size for axis in self.axes.values())
        known = self._samples or self.sample
        return 0 if known is None else known.size

    @property
    def sampled(self) -> tuple[str, ...]:
        """The fields of the samples, those of [sample], [zip] or [table], or the refined axes."""
        if self.refine is not None:
            return tuple(self.axes)
        known = self._samples or self.sample
        return () if known is None else tuple(known.fields)

    @property
    def varied(self) -> tuple[str, ...]:
        """The fields that vary: those of the samples, then the axes."""
        return (*self.sampled, *self.grid)

    @property
    def source(self) -> str:
        """The table of the study that gives the samples."""
        return next((name for name in SOURCES if getattr(self, name) is not None), SAMPLE)

    @property
    def samples_sentence(self) -> str:
        """Where the samples of a study come from, in one sentence; empty where there are none."""
        if not self.sampled or self.refine is not None:
            return ""
        count = f"{self.samples_count} sample{'s' * (self.samples_count != 1)} of {choices(self.sampled)}"
        if self.sample is not None:
            return f"{count}: {self.sample.sentence}"
        return f"{count}, from {self.table.file if self.table is not None else 'the lists of zip'}"

    @property
    def known_observables(self) -> tuple[str, ...]:
        """The observables that the rods of the study have: with EI and GJ in place of E there is no stress."""
        given = {*self.base.given, *self.varied}
        return tuple(name for name, row in OBSERVABLES.items() if row.needs != "E" or not given & {*DIRECT})

    @property
    def variation(self) -> str:
        """What varies, in words: ``the axes E, R``, ``samples of E, R``."""
        if self.refine is not None:
            return f"the refined axes {choices(self.axes)}"
        sampled = [f"samples of {choices(self.sampled)}"] if self.sampled else []
        return " and ".join([*sampled, *([f"the axes {choices(self.axes)}"] if self.axes else [])])

    def at_stations(self, stations: int) -> Self:
        """The same study with another number of stations. Raises `InputError`."""
        if not 2 <= stations <= MAX_STATIONS:
            raise InputError(f"stations must be from 2 to {MAX_STATIONS}, got {stations}")
        return self.with_values(stations=stations)

    def with_values(self, **values: Any) -> Self:
        """The same study with other values of some keys, which its text then has too (`study_text.dumps`)."""
        other = self.model_copy(update=values)
        other._text = ""
        return other

    def with_samples(self, samples: Dimension | None) -> Self:
        """The same study with other samples."""
        other = self.model_copy()
        other._samples = samples
        return other

    def meaning(self, field: str) -> str:
        """The meaning of a printed value under the reading of the study, in words; empty if it is the plain field."""
        return parse(self.reading).meaning(field) if self.reading else ""


def check_equilibrium(study: StudyData, several: str) -> None:
    """Raise `Misplaced` where a study of several cases, as the words say, names the equilibrium of one."""
    if study.equilibrium is not None and study.equilibrium.dbeta0 is not None:
        why = f"dbeta0 and energy name the equilibrium of one case, and {several}: give choose or index"
        raise Misplaced(why, "equilibrium", "dbeta0")
