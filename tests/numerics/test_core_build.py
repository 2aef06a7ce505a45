"""The sources of the compiled core can be compiled for every system for which there are wheels."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from solver.core import build

SYSTEMS = ("x86_64-windows-gnu", "aarch64-macos", "x86_64-macos", "aarch64-linux-gnu", "x86_64-linux-gnu.2.28")


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="the package ziglang is not installed")
@pytest.mark.parametrize("system", SYSTEMS)
def test_the_core_compiles_for(tmp_path: Path, system: str) -> None:
    for source in sorted(build.HERE.glob("*.c")):
        out = ["-O0", "-c", str(source), "-o", str(tmp_path / "one.o")]
        command = [sys.executable, "-m", "ziglang", "cc", "-target", system, *build.FLAGS, *out]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr


@pytest.mark.parametrize("system, found", (("linux", [["gcc"]]), ("darwin", [["gcc"]]), ("win32", [])))
def test_on_windows_only_the_compiler_that_the_user_names_is_taken(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, system: str, found: list[list[str]]
) -> None:
    for name in ("gcc", "gcc.exe", "mycc"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr("shutil.which", lambda name: name if (tmp_path / name).exists() else None)
    monkeypatch.setattr("sys.platform", system)
    assert build.compilers() == found
    monkeypatch.setenv("CC", "mycc -m64")
    assert build.compilers() == [["mycc", "-m64"], *found]


def test_a_compiler_that_fails_is_quoted_and_leaves_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fails = [sys.executable, "-c", "import sys; print('on stdout'); sys.exit('no such machine')"]
    monkeypatch.setattr(build, "commands", lambda: [fails, fails])
    library, why = build.build(tmp_path / "core.so")
    assert library is None
    assert why.count(": no such machine") == 2
    assert list(tmp_path.iterdir()) == []


def test_the_next_compiler_is_tried_and_each_that_fails_says_why(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """CC may name a program that fails without a word, that writes nothing, or that cannot be run."""
    native = build.compilers()
    (tmp_path / "none").write_text("no program", encoding="ascii")
    (tmp_path / "none").chmod(0o755)
    for broken, why in (("false", "status 1"), ("true", "status 0"), (str(tmp_path / "none"), "Exec format error")):
        monkeypatch.setenv("CC", broken)
        monkeypatch.setattr(build, "FLAGS", ("-O0", "-std=gnu11"))
        if native and broken == "false":  # a whole build takes a second
            monkeypatch.setattr(build, "commands", lambda: build.compilers())
            assert build.build(tmp_path / "core.so") == (tmp_path / "core.so", "")
            assert build.can_compile()
        monkeypatch.setattr(build, "compilers", lambda broken=broken: [[broken]])
        monkeypatch.setattr(build, "commands", lambda broken=broken: [[broken]])
        library, said = build.build(tmp_path / "core.so")
        assert library is None
        assert said.startswith(f"{broken}: ")
        assert why in said
        assert not build.can_compile()
        monkeypatch.undo()
