"""When and with what numbers and files are made: the versions of Python and of the packages, and the machine."""

import json
import os
import platform
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("numpy", "scipy", "xarray", "h5netcdf", "h5py", "rod-workbench")  # on which numbers and files depend


@cache  # reading it takes a millisecond, and a process keeps the packages that it has imported
def version_of(package: str) -> str:
    """The installed version of a package, or that it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def versions() -> dict[str, str]:
    """Python and the packages that numbers and files depend on."""
    return {"python": platform.python_version(), **{package: version_of(package) for package in PACKAGES}}


def provenance(measured: bool = False) -> dict[str, str]:
    """When and with what a file is made, as attributes; measured: on which machine too."""
    machine = f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    attributes = {"created": datetime.now(UTC).isoformat(timespec="seconds"), "versions": json.dumps(versions())}
    return {"machine": machine, **attributes} if measured else attributes
