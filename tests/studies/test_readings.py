"""Table 1 and what each reading makes of it."""

import numpy as np
import pytest

from solver import InputError, Start
from studies.language.loader import loads
from studies.paper.readings import READINGS, TABLE_1, Reading, parse


def start(reading: Reading, **printed: object) -> Start:
    given = reading.case(printed).given
    assert isinstance(given, Start)
    return given


@pytest.mark.parametrize("reading", READINGS.values(), ids=READINGS)
def test_a_reading_uses_what_it_names_and_drops_the_rest(reading: Reading) -> None:
    case, given = reading.case(), start(reading)
    assert case.rod.stiffness == reading.stiffness
    assert (given.F3 > 0) == (reading.load == "tension")
    assert abs(given.F3) == 10.0
    assert (given.F1, given.dgamma, given.F2) == {
        "force-first": (5.0, None, 0.0),
        "twist-first": (None, 0.5, 0.0),
        "shear": (None, 0.5, 5.0),
    }[reading.twist]


def test_a_dropped_value_keeps_its_axis_and_changes_nothing() -> None:
    case = parse("twist-first").case({"F1": np.array([[2.5], [10.0]]), "F3": np.array([[5.0, 10.0, 20.0]])})
    assert case.shape == (2, 3)
    FZ, MZ, M3 = (np.broadcast_to(load, case.shape) for load in case.loads)
    assert all((load[0] == load[1]).all() for load in (FZ, MZ, M3))
    assert "no effect" in parse("twist-first").meaning("F1")


@pytest.mark.parametrize("length, force, missing", [
    ("m", "N", "E, R, a, L, dbeta, dgamma"),
    ("cm", "kN", "E, F1, F3"),
    ("mm", "kN", "E, R, a, L, dbeta, dgamma, F1, F3"),
])  # fmt: skip
def test_no_number_of_table_1_is_taken_in_another_unit(length: str, force: str, missing: str) -> None:
    text = f'title = "other units"\nreading = "force-first"\nunits = {{ length = "{length}", force = "{force}" }}\n'
    with pytest.raises(InputError, match=f"the numbers of Table 1 are in cm and N: .* must give {missing} itself"):
        loads(text)
    given = ", ".join(f"{name} = {TABLE_1[name]}" for name in missing.split(", "))
    assert loads(f"{text}base = {{ {given} }}\n").case().rod.a == TABLE_1["a"]
