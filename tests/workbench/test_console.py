"""What the terminal shows: help under headings, examples, completion, lines that break at words, tables."""

import re
import shlex

import pytest
from rich.console import Console

from tests.workbench.command import exit_status
from workbench import cli
from workbench.commands import console, tables


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


def test_on_a_terminal_lines_break_between_words_and_a_name_stays_beside_its_value() -> None:
    text = (
        "largest error: 5.333e-09 at R = 0.75, E = 6829.35\n  at /a/long/path/that-is-longer-than-the/terminal.h5 end"
    )
    shown = console.at_words(text, Console(force_terminal=True, width=30))
    assert shown.split("\n") == [
        "largest error: 5.333e-09 at",
        "R = 0.75, E = 6829.35",
        "  at",
        "  /a/long/path/that-is-longer-than-the/terminal.h5",
        "  end",
    ]
    assert console.at_words(text, Console(force_terminal=False, width=30)) == text


def test_numbers_stand_at_the_right_of_their_column(capsys, monkeypatch) -> None:
    monkeypatch.setattr(console, "out", lambda: Console(width=60))
    tables.print_table(["name", "value"], [["a", "5"], ["b", "12.5"], ["c", ""], ["d", "-1e-09"]])
    lines = capsys.readouterr().out.splitlines()
    assert [line.rstrip() for line in lines] == ["name   value", "a          5", "b       12.5", "c", "d     -1e-09"]


def test_a_narrow_terminal_cuts_no_cell_and_drops_no_column(capsys, monkeypatch) -> None:
    monkeypatch.setattr(console, "out", lambda: Console(width=25))
    tables.print_table(["", "value"], [])  # a list may be empty
    assert capsys.readouterr().out.split() == ["value"]
    heads = ["", tables.heading("bending energy", "N cm"), "words", "stray"]
    tables.print_table(heads, [["1 *", 140.2331, "two words", 3.890574]])
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert lines == ["       bending", "        energy", "        (N cm)  words", "1 *    140.233  two words", "",
                     "       stray", "1 *  3.89057"]  # fmt: skip


def test_a_cell_of_several_lines_has_them_below_one_another_and_escapes_commands(capsys, monkeypatch) -> None:
    monkeypatch.setattr(console, "out", lambda: Console(width=60))
    tables.print_table(["study", "laws"], [["a", "one\ntwo\x1b[2J"], ["b", "three"]])
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert lines[1:] == ["a      one", "       two\\x1b[2J", "b      three"]


def test_progress_without_a_terminal_is_a_line_now_and_then(monkeypatch, capsys) -> None:
    clock = iter([0.0, 0.0, 3.0, 6.0, 6.0, 9.0])
    monkeypatch.setattr(console, "monotonic", lambda: next(clock))
    with console.progress(4, lines=True) as step:
        for text in "abcd":
            step(text)
    assert capsys.readouterr().err.splitlines() == ["1 of 4: a", "3 of 4: c"]
