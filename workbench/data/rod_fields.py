"""The stiffness of the rods of a file, from the fields that the file stores."""

from typing import TYPE_CHECKING, Any

from solver.problem.rod import GIVEN, STIFFNESS, fourth_powers

if TYPE_CHECKING:
    import xarray as xr

SECTIONS = (*STIFFNESS, GIVEN)  # the words of the attribute stiffness


def of_stiffness(ds: "xr.Dataset") -> tuple[str, ...]:
    """The fields that determine the bending stiffness of the rods of a dataset."""
    if "EI" in ds.variables:
        return ("EI",)
    return ("E", "a", "inner_radius") if "inner_radius" in ds.variables else ("E", "a")


def bending_stiffness(word: str, number: Any) -> Any:
    """A [force length^2]. word: the attribute stiffness. number: what gives a field by its name, as a dataset does."""
    if word == GIVEN:
        return number["EI"]
    return STIFFNESS[word] * number["E"] * fourth_powers(number["a"], number.get("inner_radius"))


def torsional_stiffness(word: str, number: Any) -> Any:
    """C [force length^2]; parameters as of `bending_stiffness`."""
    return number["GJ"] if word == GIVEN else bending_stiffness(word, number) / (1 + number["nu"])
