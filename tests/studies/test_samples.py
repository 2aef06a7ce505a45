"""Samples, paired lists and tables of cases: values follow the stated distributions, and invalid input is refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from solver import InputError
from studies.language.loader import load, loads
from studies.language.samples import REACH

HEAD = 'title = "s"\nreading = "force-first/tension/paper"\n[units]\nlength = "cm"\nforce = "N"\n'


SOBOL = """
[sample]
size = 64
seed = 3
[sample.E]
distribution = "log-uniform"
from = 5e3
to = 4e4
[sample.R]
from = 0.5
to = 1.5
[sample.beta]
distribution = "normal"
mean = "30deg"
std = 0.1
"""


def samples_of(text: str, head: str = HEAD) -> dict[str, np.ndarray]:
    return loads(head + text).variation.dimensions.fields


def one(field: str, keys: str, method: str = "sobol", size: int = 4096) -> np.ndarray:
    """The values of one sampled field."""
    return samples_of(f'[sample]\nmethod = "{method}"\nsize = {size}\nseed = 1\n[sample.{field}]\n{keys}')[field]


DISTRIBUTIONS = {
    "uniform": ("from = 1.0\nto = 3.0", stats.uniform(1.0, 2.0)),
    "log-uniform": ('distribution = "log-uniform"\nfrom = 1.0\nto = 100.0', stats.loguniform(1.0, 100.0)),
    "normal": ('distribution = "normal"\nmean = 5.0\nstd = 0.5', stats.norm(5.0, 0.5)),
    "truncated": (
        'distribution = "normal"\nmean = 5.0\nstd = 2.0\nfrom = 4.0\nto = 6.5',
        stats.truncnorm(-0.5, 0.75, 5.0, 2.0),
    ),
    "one end": ('distribution = "normal"\nmean = 5.0\nstd = 2.0\nfrom = 11.0', stats.truncnorm(3.0, REACH, 5.0, 2.0)),
}


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_the_values_follow_the_stated_distribution(name: str, method: str) -> None:
    keys, expected = DISTRIBUTIONS[name]
    values = one("F1", keys, method)
    # Kolmogorov's distance: 1/n for one value in each share of 1/n; 1.95/sqrt(n) is exceeded once in a thousand times
    limit = 1.95 / 64 if method == "random" else 2 / 4096
    assert stats.kstest(values, expected.cdf).statistic < limit


def test_a_log_uniform_range_may_be_negative_as_a_whole() -> None:
    values = one("F3", 'distribution = "log-uniform"\nfrom = -100.0\nto = -1.0')
    assert stats.kstest(-values, stats.loguniform(1.0, 100.0).cdf).statistic < 2 / 4096
    assert (values.min() >= -100) & (values.max() <= -1)


def test_degrees_are_stored_in_rad() -> None:
    normal = 'distribution = "normal"\nmean = 30.0\nstd = 2.0\nunit = "deg"'
    assert stats.kstest(np.rad2deg(one("beta", normal)), stats.norm(30.0, 2.0).cdf).statistic < 2 / 4096
    values = one("beta", 'from = "10deg"\nto = "pi/6"')
    np.testing.assert_allclose([values.min(), values.max()], [np.pi / 18, np.pi / 6], atol=1e-4)  # 1/4096 of the range


def test_a_latin_hypercube_has_one_value_in_each_share_of_every_field() -> None:
    text = SOBOL.replace("size = 64", 'size = 50\nmethod = "latin-hypercube"')
    values = samples_of(text)
    shares = stats.uniform(0.5, 1.0).cdf(values["R"]), stats.loguniform(5e3, 4e4).cdf(values["E"])
    for share in shares:
        assert sorted(np.floor(50 * share).astype(int)) == list(range(50))


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
def test_a_seed_always_gives_the_same_samples_and_another_seed_others(method: str) -> None:
    text = SOBOL.replace("size = 64", f'size = 64\nmethod = "{method}"')
    first, again, other = (samples_of(t)["E"] for t in (text, text, text.replace("seed = 3", "seed = 4")))
    np.testing.assert_array_equal(first, again)
    assert not np.isin(other, first).any()


@pytest.mark.parametrize("method", ["sobol", "random"])
@pytest.mark.parametrize("size", [65, 100, 128])
def test_more_samples_begin_with_those_of_fewer(method: str, size: int) -> None:
    text = SOBOL.replace("size = 64", f'size = 64\nmethod = "{method}"')
    few, many = samples_of(text), samples_of(text.replace("size = 64", f"size = {size}"))
    for name, values in few.items():
        np.testing.assert_array_equal(many[name][:64], values)


# tables of cases


def tabled(folder: Path, table: str, more: str = "", name: str = "cases.csv") -> dict[str, np.ndarray]:
    (folder / name).write_text(table, encoding="utf-8")
    (folder / "s.toml").write_text(HEAD + f"[table]\nfile = '{name}'\n{more}")
    return load(folder / "s.toml").variation.dimensions.fields


def test_a_table_may_be_parquet(tmp_path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")

    def read(columns: dict[str, list[object]]) -> dict[str, np.ndarray]:
        parquet.write_table(pyarrow.table(columns), tmp_path / "c.parquet")
        (tmp_path / "s.toml").write_text(HEAD + "[table]\nfile = 'c.parquet'\n")
        return load(tmp_path / "s.toml").variation.dimensions.fields

    assert {name: row.tolist() for name, row in read({"E": [1e4, 2e4], "R": [1, 2]}).items()} == {
        "E": [1e4, 2e4], "R": [1.0, 2.0],
    }  # fmt: skip
    with pytest.raises(InputError, match=r"c\.parquet, row 2: R is empty or not finite; give each row a number"):
        read({"E": [1e4, 2e4], "R": [1, None]})
    with pytest.raises(InputError, match=r"c\.parquet: the column E must hold numbers, got object"):
        read({"E": ["a", "b"]})
    (tmp_path / "c.parquet").write_text("no Parquet")
    with pytest.raises(InputError, match=r"c\.parquet cannot be read as Parquet"):
        load(tmp_path / "s.toml")


def test_a_parquet_file_without_pyarrow_is_told_what_to_install(tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"pip install 'rod-workbench\[parquet\]', or store the table as CSV"):
        tabled(tmp_path, "", name="c.parquet")


@pytest.mark.parametrize("text", ['from = "30deg"\nto = "90 deg"', 'from = 30\nto = 90\nunit = "deg"'])
def test_the_sentence_of_a_sampled_angle_is_in_degrees_however_it_is_given(text: str) -> None:
    study = loads(f"{HEAD}[sample]\nsize = 4\n[sample.beta]\n{text}")
    assert study.sample is not None
    assert study.sample.sentence.endswith("beta uniform from 30 deg to 90 deg")


def test_studies_of_one_text_are_equal_before_and_after_their_samples_are_drawn() -> None:
    first, second = (loads(f"{HEAD}[sample]\nsize = 4\n[sample.beta]\nfrom = 0.5\nto = 1.0\n") for _ in range(2))
    assert first == second
    assert first.variation.samples == second.variation.samples
    assert first == second
