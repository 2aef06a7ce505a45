"""Sessions: commands and calls with what they print, as text files in the format of cram.

A line `  $ workbench ...` is a command, and `  $ cat > FILE <<END` writes the lines after `  > `; `  >>> ` is Python,
which goes on after `  ... `. Below stands what is printed, stdout before stderr and without empty lines, and `  [2]` is
the status with which a command ends, if that is not 0. Lines that are not indented are comments. `| grep WORDS` keeps
lines, `| grep -v WORDS` the others, `| grep -o WORDS` these words, and `| jq .a.b .c` what stands there in a JSON text.

`python -m tests.transcripts [NAME ...]` stores anew what differs: read the difference before you commit it. Words that
a test collects are stored as NAME.words, and marks of figures as NAME.marks; anew where STORE stands in the environment
of pytest.
"""

import contextlib
import difflib
import io
import json
import math
import os
import re
import shlex
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from solver import InputError

FOLDER = Path(__file__).parent / "transcripts"
NUMBER = re.compile(r"[-−]?(?:\d+\.\d*|\.\d+|\d+)(?:e[-+]?\d+)?")
NEAR = {"rel_tol": 1e-4, "abs_tol": 1e-6}  # the last printed digit and estimated errors differ between processors
POWER = re.compile(r"\d(\.\d+)?·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+")  # as an estimated error is printed
LONGEST = 600  # s of a command, on a machine with much else to do: one that serves a page would never end
GOES_ON = {"$ ": "> ", ">>> ": "... "}


class Step(NamedTuple):
    """A command or a call, the lines that follow it, and what it printed when it was stored."""

    prompt: str
    words: str
    given: list[str]
    printed: list[str]


def steps(session: str) -> Iterator[str | Step]:
    """Comments, and the commands and calls between them."""
    step = None
    for line in session.splitlines():
        prompt = next((prompt for prompt in GOES_ON if line.startswith(f"  {prompt}")), None)
        if step and not prompt and line.startswith("  "):
            more = GOES_ON[step.prompt].rstrip()
            if not step.printed and line[2:].startswith(more):
                step.given.append(line[2:].removeprefix(more).removeprefix(" "))
            else:
                step.printed.append(line[2:])
            continue
        if step:
            yield step
        step = Step(prompt, line[2 + len(prompt) :], [], []) if prompt else None
        if not step:
            yield line
    if step:
        yield step


def replayed(session: str) -> str:
    """The session as it runs now in this folder; a stored line stands where only the last digits differ."""
    lines, names = [], {"Path": Path}
    for step in steps(session):
        if isinstance(step, str):
            lines.append(step)
            continue
        now = called(step, names) if step.prompt == ">>> " else run(step.words, "\n".join(step.given) + "\n")
        if len(now) == len(step.printed):
            now = [old if is_same(old, new) else new for old, new in zip(step.printed, now, strict=True)]
        given = (GOES_ON[step.prompt] + line for line in step.given)
        lines += [f"  {line}".rstrip() for line in (step.prompt + step.words, *given, *now)]
    return "\n".join(lines) + "\n"


def is_same(old: str, new: str) -> bool:
    """Whether two lines have the same words, the same whole numbers and nearly the same others."""
    words = [" ".join(NUMBER.sub("0", line).split()) for line in (old, new)]
    pairs = zip(NUMBER.findall(old), NUMBER.findall(new), strict=False)
    return words[0] == words[1] and all(a == b or _is_near(a, b) for a, b in pairs)


def _is_near(old: str, new: str) -> bool:
    if old.isdecimal() and new.isdecimal():
        return False
    return math.isclose(float(old.replace("−", "-")), float(new.replace("−", "-")), **NEAR)


def differences(name: str, words: list[str]) -> list[str]:
    """The lines of these words that are not as stored: `- ` what was stored, `+ ` what there is now."""
    path, words = FOLDER / name, [POWER.sub("…", line) for line in words]
    if os.environ.get("STORE"):
        path.write_text("\n".join(words) + "\n", encoding="utf-8")
    old = path.read_text(encoding="utf-8").splitlines()
    if len(old) == len(words):
        words = [a if is_same(a, b) else b for a, b in zip(old, words, strict=True)]
    return [line for line in difflib.ndiff(old, words) if line[:2] in ("- ", "+ ")]


def called(step: Step, names: dict[str, Any]) -> list[str]:
    """What a call prints or the value it has, or the sentence of its refusal."""
    code = compile("\n".join((step.words, *step.given)), "session", "exec" if step.given else "single")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        try:
            exec(code, names)
        except InputError as refusal:
            print(f"refused: {refusal}")
    return out.getvalue().splitlines()


def run(command: str, given: str) -> list[str]:
    """What a command prints, and its status; a refusal is one sentence, prints nothing else and changes no file."""
    words = shlex.split(command)
    if words[:2] == ["cat", ">"]:
        Path(words[2]).write_text(given, encoding="utf-8")
        return []
    words, filters = words[1:], []
    if "|" in words:
        words, filters = words[: words.index("|")], words[words.index("|") + 1 :]
    before = _files()
    status, out, err = _ended(words)
    if status == 2:
        assert (out, err.count("\n"), err[:11]) == ("", 1, "workbench: "), f"{command}\n{out}{err}"
        assert _files() == before, f"{command} changed a file"
    lines = [line.rstrip() for line in (out + err).replace(os.getcwd(), "$PWD").splitlines() if line.strip()]
    assert all(line.replace("\N{NO-BREAK SPACE}", " ").isprintable() for line in lines), command
    if filters[:2] == ["grep", "-v"]:
        lines = [line for line in lines if not re.search(filters[2], line)]
    elif filters[:2] == ["grep", "-o"]:
        lines = [part.group() for line in lines for part in re.finditer(filters[2], line)]
    elif filters[:1] == ["grep"]:
        lines = [line for line in lines if re.search(filters[1], line)]
    elif filters:
        lines = [json.dumps(_at(json.loads(out), place), ensure_ascii=False) for place in filters[1:]]
    return [*lines, *([f"[{status}]"] if status else [])]


def _ended(words: list[str]) -> tuple[int, str, str]:
    """The status of a command, and what it wrote on stdout and on stderr."""
    from workbench import cli

    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        signal.signal(signal.SIGALRM, _end)
        signal.alarm(LONGEST)
        try:
            cli.main(words)
        except SystemExit as end:
            return int(end.code or 0), out.getvalue(), err.getvalue()
        finally:
            signal.alarm(0)
    raise AssertionError(f"{words} did not end with a status")


def _end(*_: object) -> None:
    raise TimeoutError(f"the command does not end within {LONGEST} s")


def _at(data: Any, place: str) -> Any:
    """What stands at a place such as .laws[0].verdict; a name of a list of objects is that of each."""
    for name, number in re.findall(r"\.(\w+)|\[(\d*)\]", place):
        if name:
            data = [row[name] for row in data] if isinstance(data, list) else data[name]
        elif number:
            data = data[int(number)]
    return data


def _files() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(Path().rglob("*")) if path.is_file()}


def store(path: Path) -> bool:
    """Run a session in an empty folder and store it; whether it differs from the stored one."""
    session = path.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        now = replayed(session)
    path.write_text(now, encoding="utf-8")
    return now != session


if __name__ == "__main__":
    for name in sys.argv[1:] or sorted(path.stem for path in FOLDER.glob("*.txt")):
        print(f"{name}: {'stored anew' if store(FOLDER / f'{name}.txt') else 'as it was'}")
