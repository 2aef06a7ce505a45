"""The formats of an export; a new format is a module with its `FORMAT` and its name in this table."""

from pathlib import Path

from solver.problem.errors import InputError, choices

from . import csv_table, gltf, pvd, step, surface_files, usd, vtp
from .base import Format

FORMATS = {
    suffix: module.FORMAT
    for module in (step, surface_files, gltf, usd, vtp, pvd, csv_table)
    for suffix in module.FORMAT.suffixes
}


def format_of(path: Path) -> Format:
    """The format of a file, by its suffix. Raises `InputError` with the choices."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(f"cannot export to {path.name!r}: choose a name that ends in {choices(FORMATS)}")
    return FORMATS[suffix]
