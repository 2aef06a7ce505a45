"""Compile the core: all C files of this folder to one shared library beside them.

The build of the package runs this; in a checkout run `python -m solver.core` after a change of the C files. It
uses the C compiler of the machine, and if there is none, that of the package `ziglang`. It imports only the standard
library.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).resolve().parent
OFF = "ROD_WORKBENCH_NO_CORE"  # an environment variable; set to any text, the core is neither built nor loaded
# No operation is contracted or reordered, so that every compiler and every processor give the same bits.
FLAGS = ("-O3", "-std=gnu11", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")


def library_name() -> str:
    """The name of the shared library on this system."""
    return {"win32": "rod.dll", "darwin": "rod.dylib"}.get(sys.platform, "rod.so")


def digest() -> str:
    """A digest of the C files, by which the loader recognises a library that was compiled from others."""
    files = sorted([*HERE.glob("*.c"), *HERE.glob("*.h")])
    content = b"".join(path.name.encode() + path.read_bytes().replace(b"\r\n", b"\n") for path in files)
    return hashlib.blake2b(content, digest_size=8).hexdigest()


def compiler() -> list[str]:
    """The command of the machine's C compiler; empty where there is none."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        if name and shutil.which(name.split()[0]):
            return name.split()
    return []


def commands() -> list[list[str]]:
    """The compilers that are there, in the order in which they are tried."""
    found = [compiler()] if compiler() else []
    return [*found, [sys.executable, "-m", "ziglang", "cc", "-s"]] if find_spec("ziglang") else found


def arguments(target: Path, *more: str) -> list[str]:
    """What each compiler is given to write the library `target`."""
    unix = [] if sys.platform == "win32" else ["-fPIC", "-lm"]
    sources = [str(path) for path in sorted(HERE.glob("*.c"))]
    return [*FLAGS, f'-DROD_SOURCES="{digest()}"', "-shared", *more, "-o", str(target), *sources, *unix]


def build() -> tuple[Path | None, str]:
    """Compile the library; its path and an empty text, or None and what each compiler said."""
    target, told = HERE / library_name(), []
    aside = target.with_name(f".{os.getpid()}.{target.name}")
    for command in commands():
        done = subprocess.run([*command, *arguments(aside)], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            os.replace(aside, target)
            return target, ""
        told.append(f"{' '.join(command)}: {done.stderr.strip()[-500:]}")
        aside.unlink(missing_ok=True)
    return None, "; ".join(told) or "no C compiler was found"
