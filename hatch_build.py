"""The build hook: compiles the core of the solver into every wheel, also into that of an editable install.

A wheel also carries the documentation site, if `python -m docs.build` made it before.

Where no C compiler is found, the build asks for the package `ziglang`, if the package index has it. Where this fails
too, the installation ends with one sentence that says what is missing.
"""

import importlib.util
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ZIG = "ziglang==0.17.1"


def core_build() -> Any:
    """The module solver/core/build.py, without the packages that `import solver` needs."""
    path = Path(__file__).parent / "solver" / "core" / "build.py"
    spec = importlib.util.spec_from_file_location("core_build", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def within_reach(package: str) -> bool:
    """Whether pip finds the package. A dependency that nobody finds would end the installation.

    -I: this process sees the build's own environment, which has no pip; the installing one has it.
    """
    pip = [sys.executable, "-I", "-m", "pip"]
    if subprocess.run([*pip, "--version"], capture_output=True, check=False).returncode != 0:
        return True  # another program than pip installs; it has to find the package itself
    ask = [*pip, "install", "--dry-run", "--no-deps", "--ignore-installed", "--quiet", package]
    return subprocess.run(ask, capture_output=True, check=False).returncode == 0


class CoreHook(BuildHookInterface):  # type: ignore[type-arg]
    """Compiles the core before a wheel is made."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """The packages that the build needs beside hatchling."""
        core = core_build()
        if core.can_compile():
            return []
        return [ZIG] if within_reach(ZIG) else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the site, the library and the tag of the platform to the wheel."""
        site = Path(self.root) / "build" / "docs" / "html"
        if version != "editable" and (site / "index.html").is_file():
            build_data["force_include"][str(site)] = "workbench/web/docs"
        core = core_build()
        path, why = core.build()
        if path is None:
            sys.exit(f"rod-workbench needs a C compiler (gcc, clang) or the package {ZIG} to be built: {why}")
        build_data["artifacts"].append(str(path.relative_to(self.root)))
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
