"""Table 1 of the paper, and the twelve ways to read it.

The table prints the twist rate gamma0' and the normal force F10, which determine the same quantity and contradict each
other; it omits F20 and the sign of F30; and eq. (20) has another stiffness than a solid section. A reading therefore
states the source of the twist, tension or compression, and the stiffness.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from solver import Case, Cylinder, InputError, Rod, Start
from solver.problem.errors import choices, near

# Table 1, in cm and N; the length from the text below eq. (47). F1 is F10, F3 is F30; a prime is a leading d.
TABLE_1: dict[str, float] = {
    "E": 1.07e4,
    "nu": 0.25,
    "R": 0.75,
    "a": 0.25,
    "L": 20.0,
    "alpha": 0.0,
    "beta": float(np.pi / 6),
    "gamma": -0.1,
    "dbeta": 0.5,
    "dgamma": 0.5,
    "F1": 5.0,
    "F3": 10.0,
}

TWISTS = ("force-first", "twist-first", "shear")
LOADS = ("tension", "compression")
STIFFNESSES = ("paper", "solid")

DROPPED = {"force-first": "dgamma", "twist-first": "F1"}  # source of the twist -> the printed value without an effect

# The meaning of a printed value that is not simply the field of its name.
MEANING = {
    ("force-first", "dgamma"): "printed in Table 1, not used in this reading",
    ("twist-first", "F1"): "printed in Table 1, not used in this reading: it has no effect",
    ("shear", "F1"): "printed F10, taken as the in-surface shear F2",
    ("tension", "F3"): "printed F30, taken as tension",
    ("compression", "F3"): "printed F30, taken as compression",
}
WORDS = {
    "force-first": "twist from F₁₀",
    "twist-first": "twist from γ₀′",
    "shear": "twist from γ₀′, F₁₀ as shear",
    "tension": "F₃₀ as tension",
    "compression": "F₃₀ as compression",
    "paper": "stiffness of eq.\N{NO-BREAK SPACE}20",
    "solid": "stiffness of a solid rod",
}
# in tables: where the twist is from, and which stiffness
SYMBOLS = {"force-first": "F₁₀", "twist-first": "γ₀′", "shear": "γ₀′, F₁₀ shear", "paper": "eq. 20"}
STIFFNESSES_SAID = (
    "Stiffness: eq.\N{NO-BREAK SPACE}20, as the paper's equation (20) gives it; solid, of a solid section."
)


@dataclass(frozen=True)
class Reading:
    """One reading of the table.

    Parameters
    ----------
    twist : {"force-first", "twist-first", "shear"}
        F1 = F10, and gamma0' is dropped; gamma0', and F10 is dropped; or gamma0', and F10 is the in-surface shear F2.
    load : {"tension", "compression"}
        F3 = +F30, or F3 = -F30.
    stiffness : {"paper", "solid"}
        As of `solver.Rod`.

    Examples
    --------
    >>> from solver import observe, solve
    >>> from studies import Reading
    >>> reading = Reading("force-first", "tension", "paper")
    >>> print(reading.name, observe(solve(reading.case({"R": 1.0})), ["bends"])["bends"])
    force-first/tension/paper 5
    """

    twist: str = "force-first"
    load: str = "tension"
    stiffness: str = "paper"

    @property
    def name(self) -> str:
        """``force-first/tension/paper``."""
        return f"{self.twist}/{self.load}/{self.stiffness}"

    @property
    def words(self) -> str:
        """``twist from F₁₀, F₃₀ as tension, stiffness of eq. 20``."""
        return ", ".join(WORDS[word] for word in (self.twist, self.load, self.stiffness))

    @property
    def symbols(self) -> list[str]:
        """``["F₁₀", "tension", "eq. 20"]``: where the twist is from, what F₃₀ is, which stiffness."""
        return [SYMBOLS.get(word, word) for word in (self.twist, self.load, self.stiffness)]

    @property
    def table(self) -> dict[str, float]:
        """The values that the table prints, in cm, N and rad."""
        return TABLE_1

    @property
    def inert_field(self) -> str | None:
        """The printed value without an effect, or None."""
        return DROPPED.get(self.twist)

    def meaning(self, field: str) -> str:
        """The meaning of a printed value, in words; empty if it is the field of its name."""
        return MEANING.get((self.twist, field)) or MEANING.get((self.load, field)) or ""

    def case(self, printed: Mapping[str, Any] | None = None, side: str = "outside") -> Case:
        """The case of printed values, numbers or arrays that broadcast; default: those of Table 1.

        The shape of the case is that to which all values broadcast, those that the reading drops included. Raises
        `InputError` for a name that the table does not print, or a value that the solver refuses.
        """
        printed = dict(printed or {})
        for name in printed:
            if name not in TABLE_1:
                raise InputError(f"Table 1 prints no {name!r}{near(name, TABLE_1)}; choose from {choices(TABLE_1)}")
        p: dict[str, Any] = {**TABLE_1, **printed}
        sign = 1.0 if self.load == "tension" else -1.0
        given: dict[str, Any] = {"F3": sign * np.asarray(p["F3"])}
        if self.twist == "force-first":
            given["F1"] = p["F1"]
            dropped = np.shape(p["dgamma"])
        else:
            given["dgamma"] = p["dgamma"]
            given["F2"] = p["F1"] if self.twist == "shear" else 0.0
            dropped = () if self.twist == "shear" else np.shape(p["F1"])
        # keeps the axis of a value that the reading drops
        given["alpha"] = np.broadcast_to(p["alpha"], np.broadcast_shapes(dropped, np.shape(p["alpha"])))
        words: Any = self.stiffness, side  # checked by Rod and Cylinder
        return Case(
            Rod(p["E"], p["nu"], p["a"], p["L"], words[0]),
            Cylinder(p["R"], words[1]),
            Start(p["beta"], p["dbeta"], gamma=p["gamma"], **given),
        )


READINGS: dict[str, Reading] = {
    reading.name: reading for reading in (Reading(*parts) for parts in product(TWISTS, LOADS, STIFFNESSES))
}
DEFAULT = Reading()


def parse(text: str | None, default: Reading = DEFAULT) -> Reading:
    """The reading of a text such as ``force-first/tension/paper``; None, or a missing word, is that of the default.

    Raises `InputError` for an unknown word, or two words for the same choice.
    """
    if text is None:
        return default
    parts = {"twist": default.twist, "load": default.load, "stiffness": default.stiffness}
    said: dict[str, str] = {}
    for word in text.split("/"):
        for part, words in (("twist", TWISTS), ("load", LOADS), ("stiffness", STIFFNESSES)):
            if word in words and part not in said:
                said[part] = word
                break
        else:
            ways = " / ".join("|".join(words) for words in (TWISTS, LOADS, STIFFNESSES))
            raise InputError(f"no reading {text!r}; choose one word, or one from each of {ways}")
    return Reading(**{**parts, **said})
