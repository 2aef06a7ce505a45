"""The reference of the Python interface: a page for each public name, filled by Sphinx from the docstrings."""

import inspect
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

import solver
import studies

# package -> its public names, each a path that is imported as it stands; in the order of the page
PUBLIC: dict[str, tuple[str, ...]] = {
    "solver": tuple(f"solver.{name}" for name in solver.__all__),
    "studies": (*(f"studies.{name}" for name in studies.__all__), "studies.language.loader.loads"),
    "workbench": (
        "workbench.stored.stored_study.StoredStudy",
        "workbench.notebook.Plot",
        "workbench.notebook.NotebookScene",
        "workbench.run.in_memory.run",
        "workbench.run.run_and_resume.run_to_file",
        "workbench.export.stored_rod.export",
        "workbench.export.file_format.ExportOptions",
    ),
}
SAID = {
    "solver": "The mechanics and the numerics. It needs NumPy and SciPy only.",
    "studies": "Studies and their laws.",
    "workbench": "Datasets, figures and files of studies. ``import workbench.accessor`` gives datasets ``ds.rod``.",
}
CONSTANTS = {
    "studies.READINGS": "The twelve readings of Table 1 by their names.",
    "studies.TABLE_1": "The values that Table 1 prints, in cm, N and rad.",
}


def object_at(path: str) -> object:
    """The object of a public name."""
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


def sentence(path: str) -> str:
    """The first paragraph of the docstring of a public name; of a constant its line in `CONSTANTS`."""
    if path in CONSTANTS:
        return CONSTANTS[path]
    paragraph = (inspect.getdoc(object_at(path)) or "").split("\n\n")[0]
    return " ".join(paragraph.split())


def write(folder: Path) -> None:
    """Write the page of each public name and the page that lists them."""
    pages = folder / "reference" / "api"
    pages.mkdir(parents=True)
    lines = [*_title("Reference: Python"), "Every public name, from its docstring.", ""]
    for package, paths in PUBLIC.items():
        lines += [*_title(package, "-"), SAID[package], "", ".. list-table::", "   :widths: 30 70", ""]
        for path in paths:
            (pages / f"{path}.rst").write_text(page(path), encoding="utf-8")
            said = sentence(path).replace("*", r"\*").replace("`", "``").replace("````", "``")
            lines += [f"   * - :doc:`{path} <api/{path}>`", f"     - {said}"]
        lines.append("")
    lines += [".. toctree::", "   :hidden:", ""]
    lines += [f"   {path} <api/{path}>" for paths in PUBLIC.values() for path in paths]
    (folder / "reference" / "python.rst").write_text("\n".join(lines) + "\n", encoding="utf-8")


def page(path: str) -> str:
    """The source of the page of one public name."""
    thing = object_at(path)
    name = path.rpartition(".")[2]
    if inspect.isclass(thing):
        body = [f".. autoclass:: {path}", "   :members:", "   :exclude-members: model_config"]
        if any(
            base.__module__.partition(".")[0] in PUBLIC and not base.__name__.startswith("_")
            for base in thing.__bases__
        ):
            body.append("   :inherited-members: BaseModel")  # what a user reads of a solution is that of its shape
    elif callable(thing):
        body = [f".. autofunction:: {path}"]
    else:
        assert isinstance(thing, Mapping)
        body = [f".. py:data:: {path}", "", f"   {CONSTANTS[path]}", "", *_items(thing)]
    return "\n".join([*_title(name), *body, ""])


def _items(values: Mapping[str, object]) -> list[str]:
    """The items of a constant as a list; a value that is no number is named by its key alone."""
    numbers = (f": {value:g}" if isinstance(value, float) else "" for value in values.values())
    return [f"   - ``{key}``{number}" for key, number in zip(values, numbers, strict=True)]


def _title(text: str, mark: str = "=") -> list[str]:
    return [text, mark * len(text), ""]
