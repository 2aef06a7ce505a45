"""Does OpenGL work on this machine? Asked in a child process, as VTK without OpenGL ends its process."""

import ctypes
import functools
import os
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

PACKAGES = "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"  # what VTK reads to choose how it draws off-screen
OSMESA = "vtkOSOpenGLRenderWindow"
SECONDS = 60
# A wheel that carries Mesa's OSMesa and what it needs, of which nothing else is used: so without its dependencies.
WHEEL = "lavavu-osmesa"
PIP = f"pip install --no-deps {WHEEL}==1.9.10"
LOADED = [
    "pcre2",
    "selinux",
    "tinfo",
    "ffi",
    "zstd",
    "drm",
    "glapi",
    "LLVM",
    "OSMesa",
]  # each needs some of those before it

# Draws a sphere off-screen and looks at the pixels; VTK alone, as importing pyvista takes three times as long.
CHILD = """
import ctypes, sys
for library in sys.argv[1:]:
    ctypes.CDLL(library, mode=ctypes.RTLD_GLOBAL)
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow
source, mapper, actor, renderer = vtkSphereSource(), vtkPolyDataMapper(), vtkActor(), vtkRenderer()
mapper.SetInputConnection(source.GetOutputPort())
actor.SetMapper(mapper)
renderer.AddActor(actor)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(32, 32)
window.AddRenderer(renderer)
window.Render()
pixels = vtkUnsignedCharArray()
window.GetPixelData(0, 0, 31, 31, 0, pixels, 0)
print("drawn" if pixels.GetRange(0)[1] > pixels.GetRange(0)[0] else "empty")
"""
COMMAND = (sys.executable, "-c", CHILD)


@functools.cache
def probe() -> tuple[bool, str]:
    """Whether scenes can be drawn, and if not a sentence that says what to install; asked once a process.

    Tries what the environment asks for, or else EGL, the display and OSMesa, at last the OSMesa of a wheel, and leaves
    in the environment the choice that works: call it before pyvista is imported.
    """
    failures = []
    for window in _windows():
        env = {**os.environ, **({WINDOW: window} if window else {})}
        works, said = _try(env)
        if works:
            if window:
                os.environ[WINDOW] = window
            return True, ""
        failures.append(said)
    libraries = in_wheel()
    if libraries and WINDOW not in os.environ and _try({**os.environ, WINDOW: OSMESA}, libraries)[0]:
        os.environ[WINDOW] = OSMESA
        _load(libraries)
        return True, ""
    advice = f"on Debian or Ubuntu install {PACKAGES}, or anywhere on Linux {PIP}"
    return False, f"OpenGL does not work here ({failures[0]}), so no scenes are drawn; {advice}"


def in_wheel() -> list[str]:
    """The libraries of `WHEEL` in the order in which they are loaded; empty where it is not installed."""
    try:
        named = [Path(str(file.locate())) for file in files(WHEEL) or [] if ".libs" in file.parts[0]]
    except PackageNotFoundError:
        return []
    known = {path.name.removeprefix("lib").partition("-")[0]: str(path) for path in named}
    return [known[name] for name in LOADED if name in known]


def _load(libraries: list[str]) -> None:
    """VTK does not find a library in a wheel, but uses what is loaded; that it did not find it is not repeated."""
    for library in libraries:
        ctypes.CDLL(library, mode=ctypes.RTLD_GLOBAL)
    import pyvista as pv

    pv.vtk_verbosity("error")


def _windows() -> list[str]:
    """The kinds of window to try, best first; an empty one leaves the choice to VTK."""
    if WINDOW in os.environ:
        return [os.environ[WINDOW]]
    # The display comes after EGL: a display that is named but not there only costs warnings.
    return ["vtkEGLRenderWindow", "", OSMESA] if sys.platform == "linux" else [""]


def _try(env: dict[str, str], libraries: list[str] | None = None) -> tuple[bool, str]:
    command = [*COMMAND, *(libraries or [])]
    try:
        child = subprocess.run(command, env=env, capture_output=True, text=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return False, f"a trial picture took more than {SECONDS} s"
    except OSError as error:
        return False, f"a trial could not be started: {error.strerror}"
    if child.returncode < 0:
        return False, f"a trial picture ended with signal {-child.returncode}"
    if child.returncode > 0:
        return False, (child.stderr.strip().splitlines() or [f"status {child.returncode}"])[-1]
    return "drawn" in child.stdout, "a trial picture came out empty"
