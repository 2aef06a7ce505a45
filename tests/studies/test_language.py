"""The study language: what a TOML says is what is solved; what it must not say is refused in one sentence."""

import numpy as np
import pytest

from solver import Ends, InputError, Start
from solver.problem.angles import angle
from studies.language.loader import load, loads, names

UNITS = '[units]\nlength = "cm"\nforce = "N"\n'
HEAD = 'title = "t"\nreading = "force-first/tension/paper"\n' + UNITS  # lines 1 to 5
PLAIN = 'title = "t"\n' + UNITS  # lines 1 to 4
ROD = "[base]\nE = 1e4\nnu = 0.25\na = 0.25\nL = 20.0\nR = 0.75\n"
ENDS = ROD + "beta0 = 0.5\nbetaL = 0.5\n"


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


@pytest.mark.parametrize(
    "text, value",
    [
        ("0.5", 0.5), ("-30deg", -np.pi / 6), ("1.5e1 deg", np.pi / 12), ("90°", np.pi / 2), ("pi", np.pi),
        ("-pi/2", -np.pi / 2), ("3*pi/4", 3 * np.pi / 4), ("0.5pi", np.pi / 2), (" 2 π / 3 ", 2 * np.pi / 3),
        ("0.1rad", 0.1),
    ],
)  # fmt: skip
def test_an_angle_is_read_as_it_is_written(text: str, value: float) -> None:
    assert angle(text) == pytest.approx(value, rel=1e-15)  # rounding


@pytest.mark.parametrize("text", ["", "deg", "pi/0", "30 degrees", "pi/6/2", "1+pi", "pipi", "--pi"])
def test_what_is_no_angle_is_refused_with_the_forms(text: str) -> None:
    with pytest.raises(ValueError, match="is not an angle: give a number in rad, or a form like 30deg"):
        angle(text)


def test_angles_may_be_given_in_degrees_and_are_kept_in_radians() -> None:
    study = loads(HEAD + "[axes.beta]\nvalues = [30, 60]\nunit = 'deg'")
    np.testing.assert_allclose(study.coordinates()["beta"], [np.pi / 6, np.pi / 3], rtol=1e-15)  # rounding


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
    with pytest.raises(InputError, match="does not use Table 1"):
        loads(PLAIN + ROD + "beta = 0.5\ndbeta = 0.1\ndgamma = 0.2").under("shear")


AXIS = HEAD + "[axes.E]\n"
LAW = AXIS + "values = [1e4, 2e4]\n[[laws]]\nclaim = 'a'\nsource = 's'\n"  # [[laws]] is line 8
REFUSED = {
    "a title too long for the file": (f'title = "{"x" * 10_001}"', "the text has 10001 characters; the limit is 10000"),
    "a misspelt key": ("titel = 'x'\n" + HEAD, "line 1: no key 'titel', did you mean 'title'; choose from"),
    "a misspelt key of an axis": (AXIS + "form = 1\nto = 2\ncount = 3", "line 7: no key 'form' in axes.E, did"),
    "an unknown field": (
        HEAD + "[base]\nyoung = 1",
        "line 7: no key 'young' in base, did you mean 'E'; choose from E, nu, a, L",
    ),
    "a field the table does not print": (HEAD + "[base]\nF2 = 1.0", "line 7: Table 1 prints no 'F2'; choose from"),
    "a unit that is none": (HEAD.replace('"cm"', '"parsec"'), "line 4: 'parsec' is not a unit of length; choose"),
    "a force as the length": (HEAD.replace('"cm"', '"N"'), "line 4: 'N' is not a unit of length"),
    "an axis in another unit": (AXIS + "values = [1]\nunit = 'GPa'", "line 8: E is in N/cm\\^2, got unit 'GPa'"),
    "an axis without values": (AXIS + "values = []", "line 7: the axis is empty: give at least one value"),
    "a count of nothing": (AXIS + "from = 1\nto = 2\ncount = 0", "line 9: the axis is empty: .* got 0"),
    "a value twice": (AXIS + "values = [1, 2, 1]", "line 7: the value 1.0 is given twice"),
    "not a number": (AXIS + "values = [1, nan]", r"line 7: axes.E.values\[2\] must be a finite number, got nan"),
    "a NaN in the base case": (HEAD + "[base]\nR = nan", "line 7: base.R must be a finite number, got nan"),
    "text for a number": (AXIS + "from = 'a'\nto = 2\ncount = 3", "line 7: axes.E.from must be a valid number"),
    "half a count": (AXIS + "from = 1\nto = 2\ncount = 2.5", "line 9: axes.E.count must be a valid integer"),
    "two ways at once": (AXIS + "values = [1]\ncount = 3", "line 8: values and count exclude each other"),
    "half a range": (AXIS + "from = 1\ncount = 3", "line 6: the axis has no to: give values, or from, to and"),
    "a geometric axis through 0": (AXIS + "from = 0\nto = 2\ncount = 3\nspacing = 'geometric'", "not 0, got 0"),
    "an unknown spacing": (AXIS + "from = 1\nto = 2\ncount = 3\nspacing = 'log'", "'linear' or 'geometric', got 'log'"),
    "an axis that is no field": (
        HEAD + "[axes.young]\nvalues = [1]",
        "line 6: no axis 'young', did you mean 'E'; choose from E",
    ),
    "an axis of words": (HEAD + "[axes.side]\nvalues = [1]", "line 6: no axis 'side'; choose from"),
    "an axis with a path in it": (HEAD + '[axes."../E"]\nvalues = [1]', "line 6: no axis '../E'; choose from"),
    "a grid without end": (
        AXIS + "from = 1\nto = 2\ncount = 1000000\n[axes.R]\nfrom = 1\nto = 2\ncount = 1000000",
        "line 6: the grid has 1000000000000 cases, more than the limit of 1000000000",
    ),
    "an axis without end": (
        AXIS + "from = 1\nto = 2\ncount = 10000001",
        "10000001 values, more than the limit of 10000000",
    ),
    "a name with a path in it": ("name = '../x'\n" + HEAD, "line 1: name must be letters, digits, - and _ only"),
    "a name with a slash": ("name = 'a/b'\n" + HEAD, "line 1: name must be"),
    "an unknown reading": (HEAD.replace("tension", "torsion"), "line 2: no reading 'force-first/torsion/paper'"),
    "an unknown observable": (
        'observables = ["turn"]\n' + HEAD,
        "line 1: no observable 'turn', did you mean 'turns'; choose from turns",
    ),
    "an unknown output": ('outputs = ["x"]\n' + HEAD, "line 1: no output 'x'; choose from beta"),
    "one station": ("stations = 1\n" + HEAD, "line 1: stations must be greater than or equal to 2, got 1"),
    "a tolerance of nothing": ("tol = 0.0\n" + HEAD, "line 1: tol must be greater than 0, got 0.0"),
    "no title": (UNITS, "the study needs the key 'title'"),
    "no units": ('title = "t"', "the study needs the key 'units'"),
    "a table as a number": ("axes = 3\n" + HEAD, "line 1: axes must be a table, got 3"),
    "a law without observable": (LAW + "axis = 'E'\ndirection = 'falls'", r"line 8: laws\[1\] needs the key 'obs"),
    "a law on no axis": (
        LAW + "axis = 'R'\nobservable = 'turns'\ndirection = 'falls'",
        "line 11: no axis 'R'; choose from E",
    ),
    "a law in no direction": (
        LAW + "axis = 'E'\nobservable = 'turns'\ndirection = 'up'",
        "no direction 'up'; choose from rises",
    ),
    "a law on no observable": (LAW + "axis = 'E'\nobservable = 'x'\ndirection = 'falls'", "line 12: no observable 'x'"),
    "a law at no other axis": (
        LAW + "axis = 'E'\nobservable = 'turns'\ndirection = 'falls'\nat = { E = 1.0 }",
        "line 14: no other axis 'E'; there is none",
    ),
    "E below zero": (HEAD + "[base]\nE = -1.0", "line 7: Rod.E must be positive and finite, got -1.0"),
    "E below zero on its axis": (AXIS + "values = [1, -2]", "line 6: Rod.E must be positive and finite, got -2.0"),
    "a half case": (PLAIN + "[base]\nE = 1.0\nbeta = 1.0", "Rod needs nu, a, L; got E"),
    "F1 and dgamma": (
        PLAIN + ROD + "beta = 0.5\ndbeta = 0.1\nF1 = 1.0\ndgamma = 0.2",
        "exactly one of F1, dgamma and M3, got F1=1.0, dgamma=0.2, M3=None",
    ),
    "a start's field among ends": (PLAIN + ROD + "beta0 = 0.5\nF1 = 1.0", "line 12: a study of Ends has no field 'F1'"),
    "no room inside": (HEAD + "[base]\nR = 0.2\nside = 'inside'", "R must be larger than Rod.a = 0.25"),
    "following another axis": (
        AXIS + "follow = true\nto = 60\ncount = 9",
        "over a start problem, follow needs one axis, of betaL, FZ, MZ, M3, got E",
    ),
    "following a field of the start": (
        HEAD + "[axes.F1]\nfollow = true\nto = 60\ncount = 9",
        "a start problem has only one solution at each F1, which is not followed: remove follow",
    ),
    "following with weight": (
        PLAIN + ENDS + "[axes.weight]\nfollow = true\nfrom = 1\nto = 2\ncount = 3",
        "with weight or friction each case continues from the straight rod, not from the one before it: remove follow",
    ),
    "following two axes": (
        PLAIN + ENDS + "[axes.FZ]\nfollow = true\nfrom = 1\nto = 2\ncount = 3\n"
        "[axes.MZ]\nfollow = true\nfrom = 1\nto = 2\ncount = 3",
        "line 19: one axis may be followed, got FZ, MZ",
    ),
    "following text": (
        PLAIN + ENDS + "[axes.side]\nfollow = true\nfrom = 1\nto = 2\ncount = 3",
        "no axis 'side'; choose from",
    ),
    "following one value": (
        PLAIN + ENDS + "[axes.FZ]\nfollow = true\nvalues = [1.0]",
        "a followed axis needs at least 2 values, got 1",
    ),
    "following back and forth": (
        PLAIN + ENDS + "[axes.FZ]\nfollow = true\nvalues = [1.0, 3.0, 2.0]",
        "the values of a followed axis must rise or fall",
    ),
    "following from nowhere": (
        PLAIN + ENDS + "[axes.FZ]\nfollow = true\nto = 2\ncount = 3",
        "a followed axis over an ends problem begins at its first value: give FZ from, to and count, or values",
    ),
    "following two loads from a start": (
        HEAD + "[axes.FZ]\nfollow = true\nto = 2\ncount = 3\n[axes.E]\nvalues = [1e4, 2e4]",
        "over a start problem, follow needs one axis, of betaL, FZ, MZ, M3, got E, FZ",
    ),
    "following from somewhere": (
        HEAD + "[axes.betaL]\nfollow = true\nfrom = 1\nto = 2\ncount = 9",
        "line 8: a followed axis starts at the value of the base case",
    ),
    "an angle that is none": (
        HEAD + "[base]\nbeta = '30 degree'",
        "line 7: '30 degree' is not an angle: give a number",
    ),
    "an angle that is none on an axis": (
        HEAD + "[axes.beta]\nvalues = [0.1, 'much']",
        "line 7: 'much' is not an angle: give a number",
    ),
    "an angle with two units": (
        HEAD + "[axes.beta]\nvalues = ['30deg']\nunit = 'deg'",
        "line 8: '30deg' has its own unit: remove the key unit",
    ),
    "text that is not an angle's": (AXIS + "values = ['pi']", "values.1. must be a valid number, got 'pi'"),
    "a field that stands still and varies": (
        HEAD + "[base]\nE = 1e4\n[axes.E]\nvalues = [1e4, 2e4]",
        "line 8: E is given in base and as an axis: remove one of them",
    ),
    "the push as an output": (
        'outputs = ["beta", "push"]\n' + HEAD,
        "line 1: no output 'push', did you mean 'contact': it is positive outward, .* ds.rod.push .*from beta",
    ),
    "no TOML": ("title = ", "study is not valid TOML: Invalid value"),
    "a key given twice": (
        "stations = 5\n[base]\nE = 1\nE = 2\nnu = 3\n",
        r"Cannot overwrite a value \(at line 4, column \d+\): line 4 gives the key E again",
    ),
    "a key given twice at the end": ("stations = 5\n\nstations = 6\n", "line 3 gives the key stations again"),
}


@pytest.mark.parametrize("text, sentence", REFUSED.values(), ids=REFUSED)
def test_a_study_is_refused_for(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as refusal:
        loads(text)
    assert "\n" not in str(refusal.value)


def test_an_unknown_study_is_refused_with_the_nearest_and_the_choices() -> None:
    with pytest.raises(InputError, match="'fig7_1', did you mean 'fig7_1_modulus'; choose from capstan, fig6, "):
        load("fig7_1")


def test_a_stored_file_is_no_study_and_the_commands_that_read_it_are_named() -> None:
    with pytest.raises(InputError, match=r"no study 'modulus.h5': a file .h5 holds .* check, summary, plot, .*read it"):
        load("modulus.h5")


def test_a_study_that_cannot_be_read_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="No such file"):
        load(tmp_path / "absent.toml")
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(InputError, match="cannot read the study"):
        load(tmp_path / "folder.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not a text file"):
        load(tmp_path / "bytes.toml")


def test_a_file_gives_its_study_a_name_that_a_file_may_have(tmp_path) -> None:
    path = tmp_path / "my study (2).toml"
    path.write_text(HEAD)
    assert load(path).name == "my_study_2_"


def test_every_shipped_study_can_be_loaded_and_names_itself() -> None:
    assert [load(name).name for name in names()] == names()
