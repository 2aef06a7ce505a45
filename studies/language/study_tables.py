"""The tables [table] and [refine] of a study."""

from pydantic import BaseModel, Field, model_validator

from solver.problem.errors import choices

from ..grammar.axes import MAX_COUNT, STRICT, Line, Misplaced

OUTCOME = "outcome"  # watched: whether a case is solved
FINEST = 1e-9  # least tolerance


class Table(BaseModel):
    """A table of cases. file: .csv or .parquet, in the folder of the study; columns: those read; default: all."""

    model_config = STRICT

    file: Line
    columns: list[str] | None = None


class Refine(BaseModel):
    """The refinement of a study whose axes are the coarse grid.

    watch: observables, expressions and "outcome". laws: claims of laws whose verdict is watched from line to line.
    steps: of those watched that are real numbers, the change that counts. tolerance: the largest step, as a share of
    its axis, to which a boundary is located; or points: as by so many evenly spaced values of an axis. budget: the most
    cases, those of the coarse grid among them.
    """

    model_config = STRICT

    watch: list[str] = []
    laws: list[str] = []
    steps: dict[str, float] = {}
    tolerance: float | None = None
    points: int | None = None
    budget: int = Field(10_000, le=MAX_COUNT)

    @model_validator(mode="after")
    def _complete(self) -> "Refine":
        if not (self.watch or self.laws):
            raise Misplaced(f"watch is empty: name at least one observable, or {OUTCOME!r}", "watch")
        for key, names in (("watch", self.watch), ("laws", self.laws)):
            if twice := [name for name in names if names.count(name) > 1]:
                raise Misplaced(f"{twice[0]!r} is watched twice", key)
        for name, step in self.steps.items():
            if name not in self.watch:
                raise Misplaced(f"{name!r} is not watched; watch names {choices(self.watch)}", "steps", name)
            if not step > 0:
                raise Misplaced(f"the step of {name} must be positive, got {step:g}", "steps", name)
        if (self.tolerance is None) == (self.points is None):
            both = "" if self.points is None else ", and gives both"
            raise ValueError(f"refine needs one of the two keys tolerance and points{both}")
        if self.tolerance is not None and not FINEST <= self.tolerance < 1:
            why = f"tolerance is a share of the axis from {FINEST:g} to below 1, got {self.tolerance:g}"
            raise Misplaced(why, "tolerance")
        if self.points is not None and not 2 <= self.points <= 1 / FINEST:
            raise Misplaced(f"points must be from 2 to {1 / FINEST:.0f}, got {self.points}", "points")
        return self

    @property
    def share(self) -> float:
        """The tolerance as a share of an axis."""
        return self.tolerance if self.tolerance is not None else 1 / ((self.points or 2) - 1)
