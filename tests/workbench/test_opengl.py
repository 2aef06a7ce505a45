"""Whether this machine can draw is asked in a child process, and a machine that cannot still does the rest."""

import os
import subprocess
import sys

import pytest

from workbench.scene import opengl


@pytest.fixture(autouse=True)
def _forget(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(opengl.WINDOW, os.environ.get(opengl.WINDOW, ""))  # what the probe sets is taken back afterwards
    monkeypatch.delenv(opengl.WINDOW)
    opengl.probe.cache_clear()
    yield
    opengl.probe.cache_clear()


def child(monkeypatch: pytest.MonkeyPatch, code: str) -> None:
    monkeypatch.setattr(opengl, "COMMAND", (sys.executable, "-c", code))


@pytest.mark.parametrize(
    ("code", "parts"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)",
         ("signal 11", "libegl1 libgl1-mesa-dri", "libosmesa6 libx11-6")),
        ("raise ImportError('libXrender.so.1 is not there')", ("libXrender.so.1 is not there",)),
        ("print('empty')", ("empty",)),
    ],
)  # fmt: skip
def test_a_child_that_fails_means_no_opengl_and_is_quoted_with_what_to_install(monkeypatch, code, parts) -> None:
    child(monkeypatch, code)
    able, advice = opengl.probe()
    assert not able
    assert [part for part in parts if part not in advice] == []


def test_a_child_that_never_ends_is_not_waited_for(monkeypatch) -> None:
    def never(*args, **kwargs):
        raise subprocess.TimeoutExpired("child", opengl.SECONDS)

    monkeypatch.setattr(subprocess, "run", never)
    assert f"more than {opengl.SECONDS} s" in opengl.probe()[1]


def test_the_answer_is_asked_for_once(monkeypatch) -> None:
    child(monkeypatch, "print('drawn')")
    assert opengl.probe() == (True, "")
    child(monkeypatch, "raise SystemExit(1)")
    assert opengl.probe() == (True, "")


def test_the_first_kind_of_window_that_works_is_left_in_the_environment(monkeypatch) -> None:
    child(monkeypatch, f"import os; print('drawn' if os.environ['{opengl.WINDOW}'] == 'vtkSecond' else 'empty')")
    assert opengl.find_window(["vtkFirst", "vtkSecond", "vtkThird"], []) == (True, "")
    assert os.environ[opengl.WINDOW] == "vtkSecond"


def test_what_the_user_chose_is_the_only_one_tried(monkeypatch) -> None:
    monkeypatch.setenv(opengl.WINDOW, "vtkMine")
    child(monkeypatch, f"import os; print('drawn' if os.environ['{opengl.WINDOW}'] != 'vtkMine' else 'empty')")
    assert not opengl.probe()[0]


class File:
    """A file of an installed package."""

    def __init__(self, path: str) -> None:
        self.parts = tuple(path.split("/"))
        self.path = f"/here/{path}"

    def locate(self) -> str:
        return self.path


def test_the_libraries_of_the_wheel_are_loaded_each_after_what_it_needs(monkeypatch) -> None:
    libs = [f"some.libs/lib{name}-f6a8.so.1" for name in ("OSMesa", "zstd", "LLVM-17", "other", "glapi")]
    monkeypatch.setattr(opengl, "files", lambda name: [File(path) for path in (*libs, "some/OSMesa.py")])
    names = [path.rpartition("/lib")[2].partition("-")[0] for path in opengl.in_wheel()]
    assert names == ["zstd", "glapi", "LLVM", "OSMesa"]


def test_without_any_library_the_wheels_are_tried_and_kept_where_they_draw(monkeypatch) -> None:
    loaded: list[list[str]] = []
    child(monkeypatch, "import sys; print('drawn' if sys.argv[1:] == ['/here/libOSMesa.so'] else 'empty')")
    assert opengl.find_window(opengl.windows(), ["/here/libOSMesa.so"], loaded.append) == (True, "")
    assert os.environ[opengl.WINDOW] == opengl.OSMESA
    assert loaded == [["/here/libOSMesa.so"]]


def test_where_no_wheel_is_installed_it_is_named_among_what_to_install(monkeypatch) -> None:
    def none(name):
        raise opengl.PackageNotFoundError(name)

    monkeypatch.setattr(opengl, "files", none)
    child(monkeypatch, "print('empty')")
    assert opengl.in_wheel() == []
    assert opengl.PIP in opengl.probe()[1]


@pytest.mark.skipif(not opengl.in_wheel(), reason=f"the wheel with OSMesa is not here: {opengl.PIP}")
def test_the_wheel_draws() -> None:
    assert opengl.try_window({**os.environ, opengl.WINDOW: opengl.OSMESA}, opengl.in_wheel()) == (
        True,
        "a trial picture came out empty",
    )
