"""The study language: what a TOML says is what is solved; what it must not say is refused in one sentence."""

import numpy as np
import pytest

from solver import Ends, InputError, Start
from solver.problem.field_values import angle
from studies.language.loader import load, loads, names

UNITS = '[units]\nlength = "cm"\nforce = "N"\n'
HEAD = 'title = "t"\nreading = "force-first/tension/paper"\n' + UNITS  # lines 1 to 5
PLAIN = 'title = "t"\n' + UNITS  # lines 1 to 4
ROD = "[base]\nE = 1e4\nnu = 0.25\na = 0.25\nL = 20.0\nR = 0.75\n"


def test_linear_geometric_and_listed_axes_give_their_values() -> None:
    study = loads(
        HEAD + "[axes.E]\nfrom = 5e3\nto = 4e4\ncount = 4\nspacing = 'geometric'\n"
        "[axes.R]\nfrom = 0.5\nto = 1.5\ncount = 3\n[axes.L]\nvalues = [10, 20.5]"
    )
    axes = study.coordinates()
    np.testing.assert_allclose(axes["E"], [5e3, 1e4, 2e4, 4e4], rtol=1e-14)  # rounding of the powers
    np.testing.assert_array_equal(axes["R"], [0.5, 1.0, 1.5])
    np.testing.assert_array_equal(axes["L"], [10.0, 20.5])


def test_several_axes_make_a_grid_in_their_order() -> None:
    case = loads(HEAD + "[axes.R]\nvalues = [1, 2]\n[axes.E]\nvalues = [1e4, 2e4, 3e4]").case()
    assert case.shape == (2, 3)
    assert np.shape(case.cylinder.R) == (2, 1)
    assert np.shape(case.rod.E) == (1, 3)


def test_angles_may_be_written_as_degrees_or_as_parts_of_pi_wherever_there_is_one() -> None:
    rest = ROD + "dbeta = 0.1\nF1 = 1.0\n"
    given = loads(PLAIN + rest + "beta = 'pi/6'\nalpha = '-90deg'\ngamma = '2pi/3'").case().given
    assert (given.beta, given.alpha, given.gamma) == (np.pi / 6, -np.pi / 2, 2 * np.pi / 3)
    listed = loads(HEAD + "[axes.beta]\nvalues = ['15deg', 'pi/4', 1]").coordinates()["beta"]
    np.testing.assert_array_equal(listed, [np.radians(15), np.pi / 4, 1.0])
    spread = loads(PLAIN + ROD + "beta0 = '30 deg'\n[axes.betaL]\nfrom = '-pi'\nto = '180deg'\ncount = 3")
    np.testing.assert_array_equal(spread.coordinates()["betaL"], [-np.pi, 0, np.pi])
    followed = loads(HEAD + "[axes.betaL]\nfollow = true\nto = '60deg'\ncount = 3").follow
    assert followed is not None
    assert followed.limit == np.radians(60)
    text = "[axes.E]\nvalues = [1e4, 2e4]\n[axes.beta]\nvalues = ['30deg', '60deg']\n[[laws]]\nclaim = 'a'\n"
    law = "observable = 'turns'\naxis = 'E'\ndirection = 'falls'\nsource = 's'\nat = { beta = '60deg' }"
    assert loads(HEAD + text + law).laws[0].at == {"beta": np.radians(60)}


@pytest.mark.parametrize("text", ["", "deg", "pi/0", "30 degrees", "pi/6/2", "1+pi", "pipi", "--pi"])
def test_what_is_no_angle_is_refused_with_the_forms(text: str) -> None:
    with pytest.raises(ValueError, match="is not an angle: give a number in rad, or a form like 30deg"):
        angle(text)


def test_what_base_leaves_out_comes_from_table_1_when_there_is_a_reading() -> None:
    case = loads(HEAD + "[base]\nE = 2e4").case()
    assert (case.rod.E, case.rod.L, case.cylinder.R) == (2e4, 20.0, 0.75)


def test_without_a_reading_base_names_the_fields_of_the_case() -> None:
    start = loads(PLAIN + ROD + "beta = 0.5\ndbeta = 0.1\ndgamma = 0.2\nF2 = 1.0").case().given
    assert isinstance(start, Start)
    assert (start.dgamma, start.F2, start.F1) == (0.2, 1.0, None)
    untwisted = loads(PLAIN + ROD + "beta = 0.5\ndbeta = 0.0\nM3 = 0.0").case().given
    assert isinstance(untwisted, Start)
    assert (untwisted.M3, untwisted.dgamma, untwisted.F1) == (0.0, None, None)
    ends = loads(PLAIN + ROD + "beta0 = 0.5\nFZ = -8.0\n[axes.betaL]\nvalues = [0.5, 0.6]").case()
    assert isinstance(ends.given, Ends)
    assert ends.shape == (2,)


def test_what_the_laws_judge_is_computed_without_being_asked_for_twice() -> None:
    law = '[[laws]]\nclaim = "a"\nobservable = "turns"\naxis = "E"\ndirection = "falls"\nsource = "s"\n'
    axis = "[axes.E]\nvalues = [1e4, 2e4]\n"
    study = loads('observables = ["wraps"]\n' + HEAD + axis + law + 'also = ["wraps"]')
    assert study.wanted == ["wraps", "turns"]


def test_another_reading_keeps_everything_else() -> None:
    study = loads(HEAD + "[axes.E]\nvalues = [1e4]")
    other = study.under("compression")
    assert other.reading == "force-first/compression/paper"
    assert (other.axes, other.text) == (study.axes, study.text)


NO_TOML = {  # in words of Python's, which differ between its versions
    "title = ": "study is not valid TOML: Invalid value",
    "stations = 5\n[base]\nE = 1\nE = 2\nnu = 3\n": r"\(at line 4, column \d+\): line 4 gives the key E again",
    "stations = 5\n\nstations = 6\n": "line 3 gives the key stations again",
}


@pytest.mark.parametrize("text", NO_TOML)
def test_what_is_no_toml_is_refused_with_the_place(text: str) -> None:
    with pytest.raises(InputError, match=NO_TOML[text]):
        loads(text)


def test_a_file_gives_its_study_a_name_that_a_file_may_have(tmp_path) -> None:
    path = tmp_path / "my study (2).toml"
    path.write_text(HEAD)
    assert load(path).name == "my_study_2_"


def test_every_shipped_study_can_be_loaded_and_names_itself() -> None:
    assert [load(name).name for name in names()] == names()
