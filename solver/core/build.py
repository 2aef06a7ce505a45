"""Compile the core: all C files of this folder to one shared library beside them.

The build of the package runs this; in a checkout run `python -m solver.core` after a change of the C files. It
uses a C compiler of the machine, and if there is none that can do it, that of the package `ziglang`. It imports only
the standard library.
"""

import os
import sys
import zlib
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).resolve().parent
OTHER = "ROD_WORKBENCH_CORE"  # an environment variable: the path of another library to load, for tests
SANITIZED = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=undefined", "-DROLLED")
WASM = "rod.wasm"  # in the repository: not every installation can make it
WASM_SOURCES = (
    "rod.c", "weight_friction.c", "measures.c", "stations.c", "stretches.c", "peaks.c", "critical_points.c",
    "crossings.c", "tuning.c", "lanes.h", "weight_friction_lanes.h", "vectors.h", "widths.h", "measured.h",
    "densities.h", "stretches.h", "orbit_parts.h", "registers.h", "tuning.h",
)  # fmt: skip
WASM_CALLS = (
    "rod_march", "rod_loaded", "rod_densities", "rod_measure_stations", "rod_landmarks_of_stations", "rod_crossings",
    "rod_measured", "rod_sources", "rod_tuned", "malloc", "free",
)  # fmt: skip
# No operation is contracted or reordered, so that every compiler and every processor give the same bits.
FLAGS = ("-O3", "-std=gnu11", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-Wno-pass-failed")


def library_name() -> str:
    """The name of the shared library on this system."""
    return {"win32": "rod.dll", "darwin": "rod.dylib"}.get(sys.platform, "rod.so")


def digest(names: Sequence[str] = ()) -> str:
    """A digest of these C files, or of all, by which a library is recognised that was compiled from others."""
    files = [HERE / name for name in names] or sorted([*HERE.glob("*.c"), *HERE.glob("*.h")])
    content = b"".join(path.name.encode() + path.read_bytes().replace(b"\r\n", b"\n") for path in files)
    return f"rod-{zlib.crc32(content):08x}"


def digest_for_browsers() -> str:
    """The digest of the core for browsers, with the tuned constants with which it is compiled."""
    from .tuning import initializer  # it imports NumPy, which the build of the package does without

    return f"{digest(WASM_SOURCES)}-{zlib.crc32(initializer().encode()):08x}"


def compilers() -> list[list[str]]:
    """The commands of the machine's C compilers, in the order in which they are tried: that of CC first.

    On Windows only that of the variable CC: there GCC does not align the stack for AVX (its bug 54412), and Clang
    exports no function. The package `ziglang` does both.
    """
    import shutil  # the loader, which imports this module, has no need of it

    names = [os.environ.get("CC", ""), *(() if sys.platform == "win32" else ("cc", "gcc", "clang"))]
    commands = [name.split() for name in dict.fromkeys(names)]
    return [command for command in commands if command and shutil.which(command[0])]


def commands() -> list[list[str]]:
    """All compilers that are there, in the order in which they are tried."""
    zig = [[sys.executable, "-m", "ziglang", "cc", "-s"]] if find_spec("ziglang") else []
    return [*compilers(), *zig]


def digest_flag(digest: str) -> str:
    """The flag that makes the digest of the sources a part of the library."""
    return f'-DROD_SOURCES="{digest}"'


def arguments(target: Path, sources: Sequence[Path]) -> list[str]:
    """What each compiler is given to write the library `target`."""
    unix = [] if sys.platform == "win32" else ["-fPIC", "-lm"]
    return [*FLAGS, digest_flag(digest()), "-shared", "-o", str(target), *map(str, sources), *unix]


def failure(command: Sequence[str], target: Path, sources: Sequence[Path], *flags: str) -> str:
    """Compile a library, and return why that failed, in words; "" where the library is there."""
    import subprocess

    try:
        run = [*command, *arguments(target, sources), *flags]
        done = subprocess.run(run, capture_output=True, text=True, check=False, errors="replace")
    except OSError as error:
        return f"{' '.join(command)}: {error.strerror}"
    if done.returncode == 0 and target.is_file():
        return ""
    said = done.stderr.strip()[-500:] or done.stdout.strip()[-500:]
    return (
        f"{' '.join(command)}: {said or f'it ended with status {done.returncode}, said nothing and wrote no library'}"
    )


def can_compile() -> bool:
    """Whether a compiler of the machine makes a library of one line."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "one.c"), Path(folder, "one.so")
        source.write_text("int one(void) { return 1; }\n", encoding="ascii")
        return any(not failure(command, target, [source]) for command in compilers())


def build_for_browsers(target: Path = HERE / WASM) -> None:
    """Compile marches and measures to WebAssembly, by the package `ziglang`. Raises `RuntimeError` if that fails.

    The target is WASI and not freestanding, because the files need a C library. The result imports nothing.
    Made for speed, it would be three times as large and no faster.
    """
    import subprocess

    from .tuning import initializer

    kind = ["--target=wasm32-wasi", "-mexec-model=reactor", "-msimd128", "-Wl,--strip-all"]
    kind += [f"-Wl,--export={name}" for name in WASM_CALLS]
    sources = [str(HERE / name) for name in WASM_SOURCES if name.endswith(".c")]
    tuned = [f"-DROD_TUNING={initializer()}", digest_flag(digest_for_browsers())]
    options = [*kind, *FLAGS, "-Os", "-DROLLED", *tuned, "-o", str(target), *sources]
    command = [sys.executable, "-m", "ziglang", "cc", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)


def build(target: Path | None = None, *flags: str) -> tuple[Path | None, str]:
    """Compile the library; its path and an empty text, or None and what each compiler said.

    flags: after those of every library, so that the last optimization named is the one that counts.
    """
    target, messages = target or HERE / library_name(), []
    aside = target.with_name(f".{os.getpid()}.{target.name}")
    for command in commands():
        why = failure(command, aside, sorted(HERE.glob("*.c")), *flags)
        if not why:
            os.replace(aside, target)
            return target, ""
        messages.append(why)
        aside.unlink(missing_ok=True)
    return None, "; ".join(messages) or "no C compiler was found"
