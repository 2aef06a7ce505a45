"""What the terminal shows: help under headings, examples, completion, lines that break at words, tables."""

import re
import shlex
import sys
import threading
import time

import pytest

from solver import InputError
from tests.workbench.command import exit_status
from workbench import cli
from workbench.commands import console


def test_every_command_stands_under_one_heading_with_its_whole_sentence(call, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    shown = call("--help")[1]
    assert "..." not in shown.partition("Usage")[2].partition("\n")[2]
    for heading in cli.GROUPS:
        assert f"\n{heading}:\n" in shown


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_the_examples_of_a_command_are_at_the_end_of_its_help_and_have_known_options(name: str, call) -> None:
    shown = " ".join(call(name, "--help")[1].split())
    _, *examples = cli.COMMANDS[name]
    assert examples
    for example in examples:
        first, *words = shlex.split(example)
        assert first == name
        assert f"workbench {example}" in shown.partition("Examples:")[2]
        for word in words:
            if word.startswith("--"):
                assert re.search(rf"(^| ){re.escape(word)}( |,)", shown.partition("Examples:")[0]), word


@pytest.mark.parametrize("example", cli.COMMANDS["solve"][1:])
def test_the_examples_of_solve_run_as_they_are_printed(example: str, call) -> None:
    status, said, _ = call(*shlex.split(example))
    assert status == 0
    assert "\nsolved (" in said


def test_the_fields_of_a_case_stand_under_headings(call) -> None:
    shown = call("solve", "--help")[1]
    places = [
        shown.index(f"\n{heading}:\n") for heading in ("Options", "Rod and cylinder", "Start problem", "Ends problem")
    ]
    assert places == sorted(places)
    assert "--FZ NUMBER" in shown[places[-1] :]


def test_the_shell_completes_commands_and_options(capsys, monkeypatch) -> None:
    for line, place, expected in (("workbench eq", 1, ["equilibria"]), ("workbench plot --sha", 2, ["--shapes"])):
        monkeypatch.setenv("_WORKBENCH_COMPLETE", "complete_bash")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(place))
        exit_status(*line.split()[1:])
        assert capsys.readouterr().out.split() == expected


def test_a_command_that_computes_for_long_says_so_on_a_terminal(monkeypatch) -> None:
    said = threading.Event()

    def read(*_: object, **__: object) -> None:
        raise InputError("it was said" if said.wait(60) else "silence")

    monkeypatch.setattr(console, "PATIENCE", 0.0)
    monkeypatch.setattr(console, "SLOW", "still computing")
    monkeypatch.setattr(console, "warn", lambda sentence: sentence == "still computing" and said.set())
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr("studies.language.case_input.read_case", read)
    assert exit_status("solve") == 2
    assert said.is_set()


def test_progress_without_a_terminal_is_a_line_now_and_then_with_the_time_left(monkeypatch, capsys) -> None:
    now = 0.0
    for module in (console, time):
        monkeypatch.setattr(module, "monotonic", lambda: now)
    with console.progress(4, lines=True) as step:
        for text in "abcd":
            step(text)
            now += 3.0
        step("e", 100, 900)  # of another kind
        now += 50.0
        step("f", 300, 900)
    assert capsys.readouterr().err.splitlines() == [
        "1 of 4: a",
        "3 of 4, 0:00:06 left: c",
        "100 of 900: e",
        "300 of 900, 0:02:30 left: f",
    ]
