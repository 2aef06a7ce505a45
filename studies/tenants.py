"""The tenants: packages that nothing else needs, so that each can be deleted, and how the rest asks for them."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from solver.problem.errors import InputError

TENANTS = {
    "studies.paper": "Table 1 of the paper, its readings and its studies",
    "workbench.paper": "the report on the paper",
    "workbench.lab": "the comparison of the methods",
}


def is_there(package: str) -> bool:
    """Whether a tenant, a key of `TENANTS`, was not deleted."""
    return find_spec(package) is not None


def module_of(name: str) -> ModuleType:
    """A module of a tenant by its full name, such as ``studies.paper.readings``.

    Raises `InputError` where the tenant was deleted.
    """
    package = ".".join(name.split(".")[:2])
    if not is_there(package):
        raise InputError(f"this needs {TENANTS[package]}, and the package {package} is not here")
    return import_module(name)
