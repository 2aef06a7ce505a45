"""Angles may be text in Python as in a study and on the command line, read by the same rule; other fields may not."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from solver import Ends, InputError, Start
from solver.problem.declared_fields import ANGLES
from studies.grammar.axes import CYLINDER, ENDS, REPLACED, START, is_angle
from studies.grammar.axes import Base as StudyBase

WRITTEN = {
    "30deg": np.deg2rad(30),
    "-120 deg": np.deg2rad(-120),
    "0.25 turn": np.pi / 2,
    "30°": np.deg2rad(30),
    "pi/6": np.pi / 6,
    "2pi/3": 2 * np.pi / 3,
    "-π": -np.pi,
    "0.25": 0.25,
    "1e-3 rad": 1e-3,
}


def start(**given: Any) -> Start:
    return Start(**{"beta": 0.5, "dbeta": 0.5, "M3": 0.0, **given})


def ends(**given: Any) -> Ends:
    return Ends(**{"beta0": 0.5, "betaL": 0.5, **given})


@pytest.mark.parametrize("text", WRITTEN)
def test_every_angle_may_be_text_and_is_what_a_study_reads(text: str) -> None:
    for make in (start, ends):
        for name in ANGLES:
            if name.startswith("tilt") and abs(WRITTEN[text]) > np.pi / 2:
                with pytest.raises(InputError, match="from -pi/2 to pi/2"):
                    ends(**{name: text})
            elif name in {field.name for field in fields(make())}:
                given = getattr(make(**{name: text}), name)
                assert given == pytest.approx(WRITTEN[text], rel=1e-15)
                assert given == getattr(StudyBase.model_validate({name: text}), name)


def test_the_angles_are_those_of_a_study() -> None:
    assert set(ANGLES) == {name for name in (*START, *ENDS, *CYLINDER, *REPLACED) if is_angle(name)} - {
        "dbeta",
        "dgamma",
    }


def test_text_may_stand_among_the_values_of_an_array() -> None:
    wanted = [np.pi / 6, 0.2, np.pi / 2]
    for given in (
        ["30deg", 0.2, "pi/2"],
        np.array(["30deg", 0.2, "pi/2"], object),
        np.array(["30deg", "0.2", "90deg"]),
    ):
        np.testing.assert_allclose(start(beta=given).beta, wanted, rtol=1e-15)
    assert start(beta=[["1deg"], ["2deg"]]).beta.shape == (2, 1)
