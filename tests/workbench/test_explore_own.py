"""The live page begins with a rod of one's own, from a file or from options, in its own units."""

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("workbench.web.live.server", reason="the extra explore is not installed", exc_type=ImportError)

from solver import equilibria, observe
from solver.problem.errors import InputError
from studies import load
from studies.language.case_input import with_fields
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.live import asked, served, unpacked
from tests.workbench.node import needs_node, run
from workbench.branches import equilibria_dataset
from workbench.branches.ends_study import ends_problem
from workbench.run import writing
from workbench.web.live import live_document, page_model, presets
from workbench.web.live.presets import PRESETS, Preset

PIPE = small.text(
    {"E": 2.06e8, "inner_radius": 0.0543, "nu": 0.3, "a": 0.0635, "L": 30.0, "R": 0.10795}
    | {"side": "inside", "beta0": "0 deg", "betaL": 0.0, "FZ": -200.0},
    units="m kN",
)
READ = small.text({"E": 5e3, "beta": "40 deg"}, reading="twist-first/tension/solid")
START = small.text(
    {"E": 1e3, "nu": 0.3, "a": 1.0, "L": 80.0, "R": 4.0, "beta": 0.3, "dbeta": 0.05, "M3": 0.0, "alpha": 0.2},
    units="mm mN",
)


def begun(folder: Path, text: str, **options: Any) -> Preset:
    path = folder / "mine.toml"
    path.write_text(text)
    found = presets.own_preset(path, options, {})
    assert found is not None
    return found


@pytest.mark.parametrize("text", [PIPE, READ, START])
def test_the_page_begins_with_the_case_of_the_file(tmp_path, text) -> None:
    own = begun(tmp_path, text)
    study, again = load(tmp_path / "mine.toml"), page_model.study_of(own.state)
    assert again.unit_system == study.unit_system
    assert again.title == own.title == study.title
    assert again.reading == study.reading
    assert asdict(again.case()) == asdict(study.case())
    assert "mine.toml" in own.source
    assert own.state["units"]["length"] in own.source


@pytest.mark.parametrize("text", [PIPE, READ, START])
def test_the_page_says_what_the_rod_does_as_the_first_slider_rises(tmp_path, text) -> None:
    own = begun(tmp_path, text)
    study = page_model.study_of(own.state)
    value = own.state["base"][own.handle]
    raised = own.state | {
        "base": own.state["base"] | {own.handle: value + 1e-4 * (abs(value) or own.spans[own.handle])}
    }
    before, after = (
        observe(page_model.shape(one).sol, [*presets.FOLLOWS]) for one in (study, page_model.study_of(raised))
    )
    changes = {name: float(after[name]) / size - 1 for name, value in before.items() if (size := float(value))}
    most = max(changes, key=lambda name: abs(changes[name]))
    assert own.sentence.endswith(f"a little, and {presets.FOLLOWS[most][changes[most] < 0]}.")


@needs_node
def test_every_slider_of_a_file_has_a_value(tmp_path) -> None:
    states = [begun(tmp_path, text).state for text in (PIPE, READ, START)]
    named = run("answer(given.map((state) => rod_case.fieldNames(state)));", states, ("rod_case",))
    for state, names in zip(states, named, strict=True):
        assert all(isinstance(state["base"][name], float) for name in names)


def test_the_equilibrium_that_a_file_names_is_the_one_that_is_drawn(tmp_path) -> None:
    text = PIPE.replace("30.0", "4.0").replace("-200.0", "-2000.0")
    plain = page_model.list_equilibria(page_model.study_of(begun(tmp_path, text).state))
    assert len(plain) > 1
    wanted = plain[1]
    named = f"{text}[equilibrium]\ndbeta0 = {wanted['dbeta0']!r}\nenergy = {wanted['energy']!r}\n"
    drawn = page_model.shape(page_model.study_of(begun(tmp_path, named).state))
    assert float(drawn.sol.dbeta[0]) == pytest.approx(wanted["dbeta0"], rel=1e-6)


def test_a_file_of_a_rod_that_may_leave_the_cylinder_opens_as_such(tmp_path) -> None:
    unilateral = PIPE.replace("[base]", '[base]\ncontact = "unilateral"\nradius0 = 0.0')
    let_go = begun(tmp_path, START.replace("units =", "let_go = true\nunits =")).state
    centred = begun(tmp_path, unilateral).state
    for state, own in ((let_go, {}), (centred, {"contact": "unilateral", "radius0": 0.0})):
        study = page_model.study_of(state)
        assert study.leaves
        assert own.items() <= state["base"].items()
    assert let_go["let_go"] is True
    with pytest.raises(InputError, match="a cylinder that holds them on"):
        live_document.text((begun(tmp_path, unilateral),), served=False)


def test_a_rod_of_options_is_in_their_units_and_says_what_was_assumed() -> None:
    options = {"E": 2e11, "nu": 0.3, "a": 0.001, "L": 1.0, "R": 0.01, "beta": 0.1, "dbeta": 0.0, "M3": 0.0}
    own = presets.own_preset(None, options, {"length": "m"})
    assert own is not None
    assert own.state["units"] == {"length": "m", "force": "N"}
    assert "forces in N. Not given, so assumed: solid, outside" in own.source
    assert page_model.study_of(own.state).case().rod.E == 2e11


def test_the_same_rod_in_other_units_has_the_same_sliders() -> None:
    lengths = {"m": 1.0, "mm": 1e3}
    spans = {}
    for unit, k in lengths.items():
        options = {"E": 2e11 / k**2, "nu": 0.3, "a": 0.001 * k, "L": k, "R": 0.01 * k, "beta": 0.1, "dbeta": 0.0,
                   "M3": 0.0}  # fmt: skip
        own = presets.own_preset(None, options, {"length": unit})
        assert own is not None
        spans[unit] = own.spans
    assert set(spans["m"]) == {"dbeta", "M3", "F2", "F3"}
    for name, power in {"dbeta": -1, "M3": 1, "F2": 0, "F3": 0}.items():
        assert spans["mm"][name] == pytest.approx(spans["m"][name] * 1e3**power, rel=1e-12)


def test_of_a_study_with_axes_one_case_is_shown_and_named(tmp_path) -> None:
    """Of Fig. 7 (1) that nearest to Table 1; the study and its stored file give the same rod."""
    stored = writing.write(small.study_dataset("fig7_1_modulus"), tmp_path / "modulus.h5")
    shown = [presets.own_preset(file, {}, {}) for file in (Path("fig7_1_modulus"), stored)]
    assert [one.state for one in shown if one] == [shown[0].state] * 2
    assert "From fig7_1_modulus, the case at E = 10905.1, one of 9." in shown[0].source
    assert "From modulus.h5, the case at E = 10905.1, one of 9." in shown[1].source
    assert shown[0].handle == "E"  # has the first slider
    assert shown[0].spans["E"] == (5e3, 4e4)
    drawn = page_model.study_of(shown[0].state).case()
    assert float(drawn.rod.E) == pytest.approx(10905.1, abs=0.1)


def test_of_a_list_of_equilibria_the_lowest_is_shown_and_named(tmp_path) -> None:
    study = load("fig7_4_end_angle")
    case = with_fields(ends_problem(study), {"L": 8.0})
    found = equilibria(case)
    stored = writing.write(equilibria_dataset.as_dataset(study, case, found), tmp_path / "all.h5")
    own = presets.own_preset(stored, {}, {})
    assert own is not None
    assert f"the equilibrium of the lowest energy, one of {len(found)}" in own.source
    drawn = page_model.shape(page_model.study_of(own.state))
    assert float(drawn.sol.case.rod.L) == 8.0
    assert float(drawn.sol.dbeta[0]) == pytest.approx(found[0].dbeta0, rel=1e-6)


HELD = small.text(
    {"E": 325.95, "nu": 0.25, "a": 0.25, "R": 0.75, "L": 5.0, "beta0": 0.5, "betaL": 0.5, "height": 2.0}, title="held"
)


def test_a_rod_with_a_held_height_is_shown_under_the_loads_that_hold_it(tmp_path) -> None:
    own = begun(tmp_path, HELD)
    assert "under the loads that hold its height" in own.source
    drawn = page_model.shape(page_model.study_of(own.state)).sol
    assert float(drawn.z[-1] - drawn.z[0]) == pytest.approx(2.0, abs=1e-6)


def test_of_branches_and_of_a_map_a_rod_in_the_middle_is_shown_and_named(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rod.toml").write_text(HELD.replace("height = 2.0", "FZ = -0.5"))
    for axis, out, place in (
        (["FZ=-1:0:3"], "branches.h5", "in the middle: FZ = -0.5"),
        (["height=1:3:3"], "held.h5", "in the middle: height = 2"),
        (["FZ=-1:0", "betaL=20deg:40deg"], "map.h5", "in the middle: FZ = "),
    ):
        command = "folds" if out == "map.h5" else "equilibria"
        options = [part for text in axis for part in ("--axis", text)] + ["--lattice", 2] * (command == "folds")
        assert exit_status(command, "rod.toml", *options, "--out", out) == 0
        own = presets.own_preset(Path(out), {}, {})
        assert own is not None
        assert place in own.source
        assert page_model.shape(page_model.study_of(own.state)).sol.solved


def test_nothing_given_begins_with_table_1() -> None:
    assert presets.own_preset(None, {}, {}) is None


def offered(text: str) -> dict[str, Any]:
    """The data that a page begins with."""
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1])


def test_the_server_offers_the_own_rod_first_and_draws_it(tmp_path) -> None:
    own = begun(tmp_path, START)
    with served([own, *PRESETS]) as port:
        data = offered(asked(port, "GET", "/").data.decode())
        assert data["served"] is True
        assert data["presets"][0] == json.loads(json.dumps(asdict(own)))
        assert [one["name"] for one in data["presets"][1:]] == [preset.name for preset in PRESETS]
        head, arrays = unpacked(asked(port, "POST", "/shape", {"state": data["presets"][0]["state"]}).data)
    assert head["outcome"] == "solved"
    assert arrays["s"][-1] == 80.0


def test_the_page_is_saved_as_one_file_that_names_no_address_and_begins_with_the_own_rod(tmp_path, capsys) -> None:
    (tmp_path / "mine.toml").write_text(PIPE)
    assert exit_status("explore", tmp_path / "mine.toml", "--L", "20", "--save", tmp_path / "rod.html") == 0
    text = (tmp_path / "rod.html").read_text(encoding="utf-8")
    assert "http://" not in text
    assert "https://" not in text
    assert "connect-src 'none'" in text
    assert len(text) < 400_000
    data = offered(text)
    assert data["served"] is False
    assert data["presets"][0]["state"]["base"]["L"] == 20.0
    assert abs(data["presets"][0]["shape"]["beta"][0]) < 1e-12  # between two ends the page follows from a solved shape
    assert "opens in a browser without a server" in capsys.readouterr().out
