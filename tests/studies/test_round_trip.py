"""The study language by its properties: what is valid goes round, what is not is told in one sentence."""

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solver import InputError
from studies import Study
from studies.language.loader import axis_table, dumps, load, loads, study_files
from tests.slow import slow_but
from tests.studies import strategies

HEAD = "title = 't'\nreading = 'force-first/tension/paper'\nunits = { length = 'cm', force = 'N' }\n"
FEW = 60
COUNTS = slow_but((FEW, 5000), FEW)
# made-up numbers may look as if they are meant in other units
pytestmark = pytest.mark.filterwarnings("ignore::solver.problem.notices.UnitWarning")
ALWAYS = settings().suppress_health_check  # the profile's, which a test's own would replace


def goes_through_toml_and_back(said: dict[str, Any]) -> None:
    study = loads(tomli_w.dumps(said))
    text = dumps(study)
    again = loads(text, default_name="another")
    assert again.model_dump() == study.model_dump()
    assert again.model_fields_set == study.model_fields_set | {"name"}
    assert dumps(again) == text
    for name, values in study.variation.dimensions.fields.items():
        np.testing.assert_array_equal(again.variation.dimensions.fields[name], values)


@pytest.mark.parametrize("examples", COUNTS)
def test_a_study_goes_through_toml_and_back(examples: int) -> None:
    settings(max_examples=examples)(given(strategies.studies())(goes_through_toml_and_back))()


def a_study_or_a_sentence(read: Callable[[], Study]) -> None:
    """What is read is a study with a case, or refused in one printable sentence of a length that can be read."""
    said = ""
    try:
        study = read()
        assert study.variation.dimensions.fields is not None
        dumps(study)
    except InputError as refusal:
        said = str(refusal)
    assert said.isprintable()
    assert len(said) < 1000


def without_none(value: Any) -> Any:
    """TOML has no null."""
    if isinstance(value, dict):
        return {key: without_none(one) for key, one in value.items() if one is not None}
    return [without_none(one) for one in value if one is not None] if isinstance(value, list) else value


@pytest.mark.parametrize("examples", COUNTS)
def test_a_study_that_says_something_wrong_is_refused_in_one_sentence(examples: int) -> None:
    def check(said: dict[str, Any]) -> None:
        a_study_or_a_sentence(lambda: loads(tomli_w.dumps(without_none(said))))

    settings(max_examples=examples)(given(strategies.mutated())(check))()


HOSTILE = {
    "a bomb of brackets": "values = " + "[" * 100_000,
    "a bomb of tables": "a = " + "{a=" * 5000 + "1" + "}" * 5000,
    "a key of ten thousand parts": ".".join("a" * 10_000) + " = 1",
    "a header of ten thousand parts": "[" + ".".join("a" * 10_000) + "]",
    "spaces after a bracket": HEAD + "[axes.E]\nvalues = [\n[" + " " * 20_000 + "\n]]",
    "a number of ten thousand digits": "tol = " + "9" * 10_000,
    "two thousand unknown keys": "\n".join(f"k{i} = 1" for i in range(2000)),
    "two thousand laws": HEAD + "[[laws]]\n" * 2000,
    "a hundred thousand words for numbers": HEAD + "[axes.E]\nvalues = [" + "'a'," * 100_000 + "]",
    "a value twice at the end of many": HEAD + f"[axes.E]\nvalues = {[*range(1, 50_001), 1]}",
    "a million million cases": HEAD + "[axes.E]\nfrom = 1\nto = 2\ncount = 1000000000000",
    "a key twice": HEAD + 'title = "again"',
    "a name that climbs": 'name = "../../x"\n' + HEAD,
    "code for a title": HEAD.replace("'t'", "\"__import__('os').abort()\"") + "[axes.E]\nvalues = []",
    "a NUL": "title = 'a\x00b'",
    "a title that clears the terminal": 'title = "\\u001b[2J"\n' + HEAD.partition("\n")[2],
    "values that overflow": HEAD + "[axes.dgamma]\nfrom = -1.7e308\nto = 1.7e308\ncount = 3",
    "values that are rounded to one": HEAD + "[axes.E]\nfrom = 1.0\nto = 1.0000000000000002\ncount = 9",
    "a key that clears the terminal": HEAD + '[axes."\\u001b[2J"]\nfrom = "a"\nto = 2\ncount = 3',
    "an output twice": 'outputs = ["beta", "beta"]\n' + HEAD,
}


# Those that are refused before they take time or memory say so.
SOON = {
    "a bomb of brackets": "nested too deeply",
    "a key of ten thousand parts": "has a key of more than 20 parts",
    "a header of ten thousand parts": "has a key of more than 20 parts",
    "two thousand unknown keys": "has a table of 2000 entries",
    "two thousand laws": "has a table of 2000 entries",
    "a million million cases": "1000000000000 values, more than the limit",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_study_is_refused_at_once_and_in_one_sentence(name: str) -> None:
    with pytest.raises(InputError, match=SOON.get(name)) as refusal:
        loads(HOSTILE[name])
    assert str(refusal.value).isprintable()
    assert len(str(refusal.value)) < 1000


PIECES = st.one_of(st.binary(max_size=8), st.sampled_from([b"=", b"[", b"\n", b'"""', b"\xff", b"\x00"]))


@settings(max_examples=FEW, suppress_health_check=[*ALWAYS, HealthCheck.function_scoped_fixture])  # one file, anew
@given(strategies.studies(), st.data())
def test_any_bytes_in_a_file_are_a_study_or_refused(tmp_path, said: dict[str, Any], data: st.DataObject) -> None:
    content = bytearray(tomli_w.dumps(said).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content)))
        content[at : at + data.draw(st.integers(0, 8))] = data.draw(PIECES)
    (tmp_path / "it.toml").write_bytes(content)
    a_study_or_a_sentence(lambda: load(tmp_path / "it.toml"))


def test_a_byte_order_mark_is_no_part_of_a_study(tmp_path) -> None:
    text = study_files()["fig6"].read_text(encoding="utf-8")
    (tmp_path / "marked.toml").write_text(text, encoding="utf-8-sig")
    marked, plain = load(tmp_path / "marked.toml"), load("fig6")
    assert marked.model_dump(exclude={"name"}) == plain.model_dump(exclude={"name"})
    with pytest.raises(InputError, match=r"line 1: no key 'tittle'"):
        loads("\ufefftittle = 'x'")


def test_files_that_are_no_texts_are_refused_without_waiting(tmp_path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "loop.toml").symlink_to(tmp_path / "loop.toml")
    (tmp_path / "huge.toml").touch()
    os.truncate(tmp_path / "huge.toml", 10**12)  # a hole: no disk is used
    refused = {"pipe.toml": "not a regular file", "loop.toml": "Too many levels", "huge.toml": "1000000000000 bytes"}
    for name, sentence in refused.items():
        with pytest.raises(InputError, match=sentence):
            load(tmp_path / name)
    with pytest.raises(InputError, match="is not a file name"):
        load("a\0b.toml")


def test_an_axis_is_told_to_the_last_bit() -> None:
    assert axis_table(np.linspace(0.1, 0.7, 7)) == {"from": 0.1, "to": 0.7, "count": 7}
    geometric = np.geomspace(5e3, 4e4, 9)
    assert axis_table(geometric) == {"from": 5e3, "to": 4e4, "count": 9, "spacing": "geometric"}
    assert axis_table(np.nextafter(geometric, 0))["values"] == np.nextafter(geometric, 0).tolist()
    assert axis_table(np.array([1.0, 2.0])) == {"values": [1.0, 2.0]}


NO_TOML = {  # in words of Python's, which differ between its versions
    "title = ": "study is not valid TOML: Invalid value",
    "stations = 5\n[base]\nE = 1\nE = 2\nnu = 3\n": r"\(at line 4, column \d+\): line 4 gives the key E again",
    "stations = 5\n\nstations = 6\n": "line 3 gives the key stations again",
}


@pytest.mark.parametrize("text", NO_TOML)
def test_what_is_no_toml_is_refused_with_the_place(text: str) -> None:
    with pytest.raises(InputError, match=NO_TOML[text]):
        loads(text)
