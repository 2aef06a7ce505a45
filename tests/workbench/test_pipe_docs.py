"""docs/how-to/is-my-pipe-buckled.md: its commands print what the page shows."""

import re
import shlex
from pathlib import Path

import pytest

from tests.workbench import doc_pages
from workbench import cli

PAGE = doc_pages.read(Path(__file__).parents[2] / "docs" / "how-to" / "is-my-pipe-buckled.md")
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]
SOLVED = [line for line in COMMANDS if line.startswith("workbench solve")]
SHOWN = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize(("line", "shown"), list(zip(SOLVED, SHOWN, strict=True)), ids=("90deg", "60deg"))
def test_the_page_of_the_pipe_shows_what_its_command_prints(line: str, shown: str, capsys) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(line.removeprefix("workbench ")))
    assert end.value.code == 0
    assert capsys.readouterr().out.split()[-len(shown.split()) :] == shown.split()


def test_the_python_of_the_page_gives_what_it_says(capsys) -> None:
    (python,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(re.sub(r"^  ", "", python, flags=re.MULTILINE), "is-my-pipe-buckled.md", "exec"), {})
    assert capsys.readouterr().out.startswith("222.")


@pytest.mark.slow
def test_the_study_of_the_page_runs_and_its_states_are_drawn(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (text,) = re.findall(r"```toml\n# pipe_states\.toml\n(.*?)```", PAGE, re.DOTALL)
    Path("pipe_states.toml").write_text(text, encoding="utf-8")
    for line in COMMANDS:
        if "pipe_states" in line:
            with pytest.raises(SystemExit) as end:
                cli.main(shlex.split(line.removeprefix("workbench ")))
            assert end.value.code == 0
    assert Path("pipe_states.png").stat().st_size > 10_000
