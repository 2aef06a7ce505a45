"""Whether OpenGL works on this machine: tried in a child process, as VTK without OpenGL ends its process."""

import ctypes
import functools
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, files
from importlib.util import find_spec
from pathlib import Path

from ..run.atomic import Undone

MISSING = "scenes and files of surfaces need PyVista and trimesh: pip install 'rod-workbench[scene]'"
PACKAGES = "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)"
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"  # the environment variable by which VTK chooses its off-screen window
OSMESA = "vtkOSOpenGLRenderWindow"
SECONDS = 60
# A wheel with Mesa's OSMesa and the libraries that it needs. Nothing else of it is used, hence --no-deps.
WHEEL = "lavavu-osmesa"
PIP = f"pip install --no-deps {WHEEL}==1.9.10"
# each needs some of those before it
LOADED = ["pcre2", "selinux", "tinfo", "ffi", "zstd", "drm", "glapi", "LLVM", "OSMesa"]

# Draws a sphere off-screen and reads the pixels; with VTK alone, as importing pyvista takes three times as long.
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


def check() -> None:
    """Raise `Undone`, with what to install, where scenes cannot be drawn."""
    able, advice = probe()
    if not able:
        raise Undone(advice)


@functools.cache
def probe() -> tuple[bool, str]:
    """Whether scenes can be drawn, and if not a sentence with what to install; tried once a process.

    Tries the window that the environment names, or else EGL, the display and OSMesa, at last the OSMesa of a wheel. The
    one that works stays in the environment: call this before pyvista is imported.
    """
    return find_window(windows(), in_wheel()) if find_spec("pyvista") else (False, MISSING)


def find_window(
    names: Sequence[str], libraries: list[str], load: Callable[[list[str]], None] | None = None
) -> tuple[bool, str]:
    """Try windows of VTK by name, then OSMesa with libraries of a wheel, which `load` loads; returns as `probe`."""
    failures = []
    for window in names:
        works, failure = try_window({**os.environ, **({WINDOW: window} if window else {})})
        if works:
            if window:
                os.environ[WINDOW] = window
            return True, ""
        failures.append(failure)
    if libraries and WINDOW not in os.environ and try_window({**os.environ, WINDOW: OSMESA}, libraries)[0]:
        os.environ[WINDOW] = OSMESA
        (load or load_libraries)(libraries)
        return True, ""
    advice = f"on Debian or Ubuntu install {PACKAGES}, or anywhere on Linux {PIP}"
    return False, f"OpenGL does not work here ({failures[0]}), so scenes cannot be drawn; {advice}"


def in_wheel() -> list[str]:
    """The libraries of `WHEEL` in the order in which they must be loaded; empty where it is not installed."""
    try:
        named = [Path(str(file.locate())) for file in files(WHEEL) or [] if ".libs" in file.parts[0]]
    except PackageNotFoundError:
        return []
    known = {path.name.removeprefix("lib").partition("-")[0]: str(path) for path in named}
    return [known[name] for name in LOADED if name in known]


def load_libraries(libraries: list[str]) -> None:
    """Load libraries, as VTK does not find them in a wheel but uses loaded ones; silence its warnings about that."""
    for library in libraries:
        ctypes.CDLL(library, mode=ctypes.RTLD_GLOBAL)
    import pyvista as pv

    pv.vtk_verbosity("error")


def windows() -> list[str]:
    """The windows of VTK to try, best first; an empty name leaves the choice to VTK."""
    if WINDOW in os.environ:
        return [os.environ[WINDOW]]
    # The display comes after EGL: a display that is named but missing only gives warnings.
    return ["vtkEGLRenderWindow", "", OSMESA] if sys.platform == "linux" else [""]


def try_window(env: dict[str, str], libraries: list[str] | None = None) -> tuple[bool, str]:
    """Whether a child process draws in this environment, with these libraries loaded; else why not."""
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
