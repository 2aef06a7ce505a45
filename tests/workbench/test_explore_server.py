"""The live page's server: what it answers, and whom it does not."""

import copy
import io
import json
import os
import re
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("workbench.web.live.server", reason="the extra explore is not installed", exc_type=ImportError)

from solver import observe, solve
from solver.problem.errors import InputError
from tests.workbench import live_process
from tests.workbench.command import exit_status
from tests.workbench.live import STATES, asked, state, unpacked
from tests.workbench.waiting import until
from workbench.commands import explore
from workbench.web.live import page_model, server

ROOT = Path(__file__).parents[2]
TABLE_1, DNA, PIPE, CABLE = (STATES[name] for name in ("table1", "dna", "pipe", "cable"))


HEAVY = {"weight": 0.242, "inclination": 1.4, "friction": 0.2, "sliding": "axial-backward"}


def test_the_page_is_one_text_that_names_no_other_address_and_runs_only_its_own_scripts(port) -> None:
    answer = asked(port, "GET", "/")
    assert answer.status == 200
    policy = answer.headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "connect-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe-inline" not in policy
    assert "'unsafe-eval'" not in policy
    assert b"http://" not in answer.data
    assert b"https://" not in answer.data
    assert (
        asked(port, "POST", "/numbers", {"state": TABLE_1}).headers["Content-Security-Policy"].startswith("default-src")
    )


@pytest.mark.parametrize(
    "path", ["/../pyproject.toml", "/page.mjs/../explore_server.py", "/%2e%2e/x", "/etc/passwd", "/page/", "//x"]
)
def test_no_other_path_is_served(port, path) -> None:
    assert asked(port, "GET", path).status == 404


@pytest.mark.parametrize(
    "headers, status",
    [
        ({"Host": "evil.example"}, 403),  # a name that was made to point here
        ({"Host": "127.0.0.1:1"}, 403),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://127.0.0.1:1"}, 403),
        ({"Content-Type": "text/plain"}, 415),  # what another site's form can send without asking
        ({}, 200),
    ],
)
def test_only_the_page_itself_may_ask(port, headers, status) -> None:
    assert asked(port, "POST", "/numbers", {"state": TABLE_1}, headers).status == status


def test_the_pages_own_origin_and_localhost_may_ask(port) -> None:
    for name in ("127.0.0.1", "localhost", "[::1]"):
        own = {"Host": f"{name}:{port}", "Origin": f"http://{name}:{port}"}
        assert asked(port, "POST", "/numbers", {"state": TABLE_1}, own).status == 200


def test_a_shape_comes_with_its_stations(port) -> None:
    head, arrays = unpacked(asked(port, "POST", "/shape", {"state": CABLE}).data)
    assert head["outcome"] == "solved"
    assert set(arrays) == {"s", "beta", "dbeta", "alpha", "z"}
    assert arrays["s"][-1] == 5970.0
    assert arrays["beta"][-1] == pytest.approx(np.radians(89.0))


def test_a_pipe_with_weight_and_friction_is_solved_by_the_server(port) -> None:
    heavy = state("pipe", **HEAVY)
    head, arrays = unpacked(asked(port, "POST", "/shape", {"state": heavy}).data)
    sol = solve(page_model.study_of(heavy).case(), stations=arrays["s"].size)
    assert head["notes"][0].startswith("State: sinusoidal all along; ")
    assert all(note.startswith("Caution: ") for note in head["notes"][1:])
    assert [note for note in head["details"] if "at s = 0; −200 at s = L" in note]  # a minus sign, no hyphen
    for name, values in {"push": sol.push, "tension": sol.F3, "alpha": sol.alpha}.items():
        assert np.allclose(arrays[name], values, atol=1e-9 * np.abs(values).max())
    assert [arrays["axial"][i] for i in (0, -1)] == pytest.approx([observe(sol, ["FZ0"])["FZ0"], -200.0])
    rows = json.loads(asked(port, "POST", "/numbers", {"state": heavy}).data)["rows"]
    assert {row["name"]: row["value"] for row in rows}["push_max"] == pytest.approx(float(sol.push.max()), rel=1e-3)
    for path, other, sentence in (
        ("/shape", state("pipe", **HEAVY | {"L": 3e4}), "lengths, and the page computes at most 1500"),
        ("/shape", state("pipe", **HEAVY | {"friction": -1}), "Cylinder.friction must be at least 0"),
        ("/equilibria", heavy, "the page shows the equilibrium of workbench solve alone"),
    ):
        answer = asked(port, "POST", path, {"state": other})
        assert (answer.status, sentence in json.loads(answer.data)["refused"]) == (200, True)


def test_a_rod_that_may_leave_the_cylinder_continues_from_the_one_before_and_its_numbers_are_those_shown(port) -> None:
    """The second shape is not sought anew; another page begins afresh, and finds the shape of the solver."""
    mine, other = ({"X-Page": name} for name in ("mine", "other"))

    def shape_of(headers: dict[str, str], **asked_for: object) -> tuple[dict, dict]:
        return unpacked(asked(port, "POST", "/shape", asked_for, headers).data)

    let_go, moved = (state(E=E) | {"let_go": True} for E in (1.07e4, 1.1e4))
    head, arrays = shape_of(mine, state=let_go, lost=False)
    assert "found from the shape that was let go" in head["outcome"]
    assert arrays["gap"].max() > 5.0  # cm: the rod of Table 1 springs off
    assert np.allclose(np.hypot(arrays["x"], arrays["y"]) - 1.0, arrays["gap"], atol=1e-9)
    head, arrays = shape_of(mine, state=moved, lost=True)
    assert "found from the seed" in head["outcome"]
    rows = json.loads(asked(port, "POST", "/numbers", {"state": moved}, mine).data)["rows"]
    numbers = {row["name"]: row["value"] for row in rows}
    assert numbers["gap_max"] == pytest.approx(head["numbers"]["gap_max"], rel=1e-12)
    assert asked(port, "POST", "/download", {"state": moved, "kind": "glb"}, mine).data.startswith(b"glTF")
    anew, _ = shape_of(other, state=moved, lost=True)
    assert "found from the shape that was let go" in anew["outcome"]


@pytest.mark.slow
def test_a_step_file_of_a_rod_off_the_wall_is_as_exact_as_its_places_are_known(port) -> None:
    let_go = state() | {"let_go": True}
    assert asked(port, "POST", "/download", {"state": let_go, "kind": "step"}).data.startswith(b"ISO-10303-21")


def test_beside_a_cylinder_that_only_pushes_the_loads_of_the_ends_stay(port) -> None:
    pipe = state("pipe", L=30.0, contact="unilateral")
    head, arrays = unpacked(asked(port, "POST", "/shape", {"state": pipe}).data)
    sol = solve(page_model.study_of(pipe).case(), page_model.OFF_WALL_TOL, stations=arrays["s"])
    np.testing.assert_allclose(arrays["push"], sol.push, atol=1e-9 * sol.push.max())
    np.testing.assert_allclose(head["contacts"], sol.contacts, rtol=1e-9)
    assert head["notes"][0].startswith("The rod lies on ")
    for changes, sentence in (
        ({"L": 3e4}, "lengths, and the page computes at most 1500"),
        ({"friction": 0.2}, "friction"),
    ):
        told = json.loads(asked(port, "POST", "/shape", {"state": state("pipe", **changes, contact="unilateral")}).data)
        assert sentence in told["refused"]


def test_what_cannot_be_is_answered_with_a_sentence_and_the_field(port) -> None:
    answer = asked(port, "POST", "/shape", {"state": state(E=-1)})
    assert answer.status == 200  # a browser writes any other status in its console
    assert json.loads(answer.data) == {"refused": "Rod.E must be positive and finite, got -1", "field": "E"}


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("changes", [{"a": 5e-324}, {"a": 1e308}, {"E": 1e308}, {"L": 1e300}])
def test_what_no_number_can_hold_is_answered_and_the_server_goes_on(port, changes) -> None:
    answer = asked(port, "POST", "/shape", {"state": state(**changes)})
    assert answer.status == 200
    told = json.loads(answer.data)
    if "refused" in told:
        assert told["refused"]
    else:  # and what is drawn is finite
        assert all(np.isfinite(np.array(row, dtype=float)).all() for row in told["arrays"].values())


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[]",
        b"3",
        b"\xff\xfe",
        b"[" * 50_000,
        b'{"state": {"base": {"E": 1e999}}}',
        b"9" * 5000,
        b'{"state": NaN}',
    ],
)
@pytest.mark.parametrize("path", ["/shape", "/download"])
def test_nonsense_is_refused_and_the_server_goes_on(port, path, body) -> None:
    answer = asked(port, "POST", path, body)
    assert answer.status in (200, 400)
    assert json.loads(answer.data)["refused"]
    assert asked(port, "GET", "/").status == 200


def test_a_request_without_end_is_refused(port) -> None:
    assert asked(port, "POST", "/shape", b" " * (server.LARGEST + 1)).status == 413


def test_two_who_ask_at_once_get_each_their_own(port) -> None:
    def beta(one: dict) -> np.ndarray:
        return unpacked(asked(port, "POST", "/shape", {"state": one}).data)[1]["beta"]

    states = [state(name, L=STATES[name]["base"]["L"] * k) for k in (1.0, 1.1, 1.2) for name in ("table1", "dna")]
    states += [CABLE, CABLE]
    alone = [beta(one) for one in states]
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(beta, states))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_rod_is_solved_once_for_its_shape_and_its_numbers(port, monkeypatch) -> None:
    asked(port, "POST", "/shape", {"state": TABLE_1})
    monkeypatch.setattr(page_model, "shape", live_process.broken)
    told = json.loads(asked(port, "POST", "/numbers", {"state": TABLE_1}).data)
    assert {row["name"]: row["value"] for row in told["rows"]}["overlaps"] == 1
    assert asked(port, "POST", "/numbers", {"state": state(L=21.25)}).status == 500


def test_only_so_many_shapes_are_remembered() -> None:
    shapes = server.LiveRods()
    names = [str(k) for k in range(server.REMEMBERED + 5)]
    for name in names:
        shapes.keep(name, name)
    assert [shapes.find(name) for name in names] == [None] * 5 + names[5:]


def test_the_equilibria_are_listed_lowest_energy_first(port) -> None:
    moved = state("cable", FZ=174.52)  # no longer exactly the load of a helix
    rows = json.loads(asked(port, "POST", "/equilibria", {"state": moved}).data)["rows"]
    assert len(rows) == 5
    assert all(len(row["line"]["z"]) == len(row["line"]["around"]) > 100 for row in rows)  # their small pictures
    energies = np.array([row["energy"] for row in rows])
    assert (np.diff(energies) > -1e-12 * np.abs(energies).max()).all()


def test_downloads_are_files_that_are_read(port) -> None:
    answer = asked(port, "POST", "/download", {"state": CABLE, "kind": "csv"})
    table = np.genfromtxt(io.BytesIO(answer.data), delimiter=",", names=True)
    assert table["beta_rad"][0] == pytest.approx(np.radians(89))
    assert asked(port, "POST", "/download", {"state": TABLE_1, "kind": "glb"}).data[:4] == b"glTF"
    refused = asked(port, "POST", "/download", {"state": TABLE_1, "kind": "step"})
    assert "refused" in json.loads(refused.data)  # or that Open Cascade is missing
    assert b"--" not in refused.data  # the command's options are none of the page's
    for kind in ("/etc/passwd", "../x.csv", None, {"a": 1}):
        assert "refused" in json.loads(asked(port, "POST", "/download", {"state": TABLE_1, "kind": kind}).data)


@pytest.mark.slow
def test_a_step_file_is_downloaded(port) -> None:
    pytest.importorskip("OCP", reason="Open Cascade is not installed: pip install '.[cad]'", exc_type=ImportError)
    assert asked(port, "POST", "/download", {"state": CABLE, "kind": "step"}).data.startswith(b"ISO-10303-21")


# searches


def titled(path: Path) -> dict:
    return copy.deepcopy(CABLE) | {"title": str(path)}


def processes(path: Path, count: int) -> list[int]:
    """Those that have told themselves in the file, once there are so many."""
    until(lambda: path.exists() and len(path.read_text().split()) >= count)
    return [int(line) for line in path.read_text().split()]


def left(port: int, path: str, state: dict) -> HTTPConnection:
    """A request whose answer nobody has read yet."""
    connection = HTTPConnection("127.0.0.1", port)
    connection.request("POST", path, json.dumps({"state": state}), {"Content-Type": "application/json"})
    return connection


def has_ended(pid: int) -> bool:
    """Whether a process has ended and the server knows: until then it counts among the searches."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def test_a_search_ends_when_its_client_leaves(port, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(page_model, "list_equilibria", live_process.endless)
    client = left(port, "/equilibria", titled(tmp_path / "told"))
    (pid,) = processes(tmp_path / "told", 1)
    assert pid != os.getpid()
    client.close()
    until(lambda: has_ended(pid))


def test_endless_searches_delay_no_slider_and_only_so_many_run_or_wait(port, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(page_model, "list_equilibria", live_process.endless)
    clients = [left(port, "/equilibria", titled(tmp_path / "told")) for _ in range(server.SHARE)]
    running = processes(tmp_path / "told", server.AT_ONCE)
    for k in range(5):
        assert unpacked(asked(port, "POST", "/shape", {"state": state(L=20.0 + k)}).data)[0]["outcome"] == "solved"
    refused = asked(port, "POST", "/equilibria", {"state": CABLE})
    assert json.loads(refused.data)["refused"] == server.MANY
    assert processes(tmp_path / "told", 1) == running
    for client in clients:
        client.close()
    until(lambda: all(map(has_ended, running)))
    monkeypatch.undo()
    assert asked(port, "POST", "/equilibria", {"state": CABLE}).status == 200


@pytest.mark.parametrize(
    "other",
    [
        {"headers": {"X-Page": "another"}},
        pytest.param({"source": "127.0.0.2"}, marks=pytest.mark.skipif(sys.platform != "linux", reason="one address")),
    ],
)
def test_the_endless_searches_of_one_client_keep_no_other_from_its_own(port, monkeypatch, tmp_path, other) -> None:
    """Another page on the same machine, or another machine, has its share at once; so have many, in turn."""
    monkeypatch.setattr(page_model, "list_equilibria", live_process.endless_or_listed)
    clients = [left(port, "/equilibria", titled(tmp_path / "told")) for _ in range(server.SHARE)]
    running = processes(tmp_path / "told", server.AT_ONCE)
    for _ in range(3):
        assert json.loads(asked(port, "POST", "/equilibria", {"state": CABLE}, **other).data) == {"rows": []}
    with ThreadPoolExecutor(server.SHARE) as pool:
        answers = pool.map(lambda _: asked(port, "POST", "/equilibria", {"state": CABLE}, **other), range(server.SHARE))
        assert [json.loads(answer.data) for answer in answers] == [{"rows": []}] * server.SHARE
    assert processes(tmp_path / "told", 1) == running
    for client in clients:
        client.close()
    until(lambda: all(map(has_ended, running)))


@pytest.mark.parametrize("charset", ["zzz", "hex", "utf-16", ""])
def test_a_request_is_read_as_utf_8_whatever_charset_it_claims(port, charset) -> None:
    headers = {"Content-Type": f"application/json; charset={charset}"}
    answer = asked(port, "POST", "/shape", {"state": TABLE_1 | {"title": "Länge"}}, headers)
    assert answer.status == 200
    assert unpacked(answer.data)[0]["outcome"] == "solved"


@pytest.mark.parametrize(
    "path, where", [("/equilibria", "list_equilibria"), ("/shape", "stations"), ("/numbers", "numbers")]
)
def test_a_fault_of_the_solver_is_a_sentence_and_no_traceback(port, monkeypatch, caplog, path, where) -> None:
    monkeypatch.setattr(page_model, where, live_process.broken)
    answer = asked(port, "POST", path, {"state": TABLE_1 if path != "/equilibria" else CABLE})
    assert answer.status == 500
    assert json.loads(answer.data) == {"refused": server.FAULT, "field": ""}
    assert asked(port, "GET", "/").status == 200
    assert f"{path} failed: " in caplog.text
    assert "Traceback" not in caplog.text
    assert "\x1b[2J" not in caplog.text


def test_a_search_that_takes_too_much_memory_is_refused(port, monkeypatch) -> None:
    monkeypatch.setattr(page_model, "list_equilibria", live_process.greedy)
    answer = asked(port, "POST", "/equilibria", {"state": CABLE})
    assert json.loads(answer.data)["refused"] == server.TOO_LARGE


def slid(moves: int) -> tuple[float, float]:
    """The memory of a server [MB] after a quarter of the moves, and after all; now and then a client leaves early."""
    with live_process.explored() as (port, process):
        for k in range(moves):
            name = "cable" if k % 10 == 9 else ("table1", "dna")[k % 2]  # the page itself follows the others
            moved = state(name, L=STATES[name]["base"]["L"] * (1 + 0.1 * np.sin(0.02 * k)))
            answer = asked(port, "POST", "/shape", {"state": moved})
            assert answer.status == 200, answer.data
            if k % 7 == 0:
                asked(port, "POST", "/numbers", {"state": moved})
            if k % 50 == 3:
                left(port, "/equilibria", moved).close()
            if k == moves // 4:
                before = live_process.megabytes(process.pid)
        return before, live_process.megabytes(process.pid)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is read in /proc")
def test_the_memory_of_the_server_stays_bounded_over_ten_thousand_moves() -> None:
    before, after = slid(10_000)
    assert after < 500
    assert after - before < 10


# the command


def test_it_listens_to_this_machine_alone_unless_told() -> None:
    listener = explore.open_socket("127.0.0.1", 0)
    assert listener.getsockname()[0] == "127.0.0.1"
    port = listener.getsockname()[1]
    with pytest.raises(InputError, match=f"cannot listen on 127.0.0.1:{port}: Address already in use"):
        explore.open_socket("127.0.0.1", port)
    listener.close()
    assert explore.host_names("127.0.0.1", 80, []) >= {"127.0.0.1", "127.0.0.1:80", "localhost"}
    assert explore.host_names("lab", 81, ["x.example", "y.example:9"]) == {"lab:81", "x.example:81", "y.example:9"}


@pytest.mark.skipif(os.name == "nt", reason="signals are sent otherwise there")
@pytest.mark.slow
def test_the_command_says_where_the_page_is_and_ends_quietly_when_interrupted() -> None:
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); from workbench import cli; cli.main()"
    )
    command = [sys.executable, "-c", code, "explore", "--port", "0"]
    with subprocess.Popen(command, cwd=ROOT, stdout=-1, stderr=-1, text=True) as process:
        port = int(re.search(r"http://127\.0\.0\.1:(\d+)/", process.stdout.readline())[1])
        assert asked(port, "GET", "/").status == 200  # it listens already; who asks too early waits
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=600)
    assert (process.returncode, said) == (0, "")


def test_without_the_extra_one_sentence_says_what_to_install(monkeypatch, capsys) -> None:
    monkeypatch.delitem(sys.modules, "workbench.web.live.server", raising=False)
    monkeypatch.setitem(sys.modules, "aiohttp", None)
    monkeypatch.delattr("workbench.web.live.server", raising=False)
    assert exit_status("explore") == 2
    assert "rod-workbench[explore]" in capsys.readouterr().err
