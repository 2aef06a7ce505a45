"""The fidelities draft, standard, fine and exact: a tolerance, a number of stations, and what is computed."""

from dataclasses import dataclass

from solver import Rod
from solver.free.free_rods import FREE_TOLERANCE
from solver.observe.observables import OBSERVABLES, observables_of
from solver.problem.errors import DEFAULT_TOLERANCE, check_known
from studies import Study
from studies.language.study import OFF_WALL

SHAPE = ("beta", "alpha", "z", "radius", "contact")
FORCES = ("F1", "F2", "F3", "M1", "M2")


@dataclass(frozen=True)
class Fidelity:
    """A fidelity.

    tol: the tolerance. free: that of rods that may leave the cylinder, of their places over the length. stations: along
    the rod; None keeps the study's own. computes: "shape" (angle, azimuth, height and contact, and of the observables
    those that a law needs), "asked" (what the study names) or "all" (every array along the rod and every observable).
    """

    name: str
    tol: float
    free: float
    stations: int | None
    computes: str

    def of(self, study: Study) -> Study:
        """The study at this fidelity."""
        changes: dict[str, object] = {"tol": self.tol_of(study.leaves)}
        if self.stations is not None:
            changes["stations"] = self.stations
        if self.computes == "shape":
            changes |= {"outputs": [name for name in study.outputs if name in SHAPE], "observables": []}
        if self.computes == "all":
            known = [name for name in study.known_observables if study.leaves or not OBSERVABLES[name].free]
            changes |= {"outputs": [*study.known_outputs], "observables": known}
        return study.with_values(**changes)

    def tol_of(self, leaves: bool) -> float:
        """The tolerance; leaves: whether rods may leave the cylinder."""
        return self.free if leaves else self.tol

    def along(self, leaves: bool) -> tuple[str, ...]:
        """What `solve` prints along the rod."""
        off = OFF_WALL if leaves else ()
        return ("s", "beta", "dbeta", "alpha", "z", *off, "contact", *(FORCES if self.computes == "all" else ()))

    def observables(self, rod: Rod, leaves: bool) -> tuple[str, ...]:
        """What `solve` prints of the rod as a whole."""
        return () if self.computes == "shape" else observables_of(rod, leaves)


FIDELITIES: dict[str, Fidelity] = {
    row.name: row
    for row in (
        Fidelity("draft", 1e-3, 1e-3, 51, "shape"),
        Fidelity("standard", DEFAULT_TOLERANCE, FREE_TOLERANCE, None, "asked"),
        Fidelity("fine", 1e-11, 1e-5, 801, "all"),
        Fidelity("exact", 1e-13, 1e-6, 1601, "all"),
    )
}


def fidelity(name: str) -> Fidelity:
    """The fidelity of that name; `InputError` with the choices for another."""
    check_known("fidelity", name, FIDELITIES)
    return FIDELITIES[name]
