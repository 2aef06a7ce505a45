"""The notebook of the examples, from the page of the tutorial: `python -m docs.notebook` writes it."""

import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PAGE, NOTEBOOK = ROOT / "docs" / "tutorial" / "a-notebook.md", ROOT / "examples" / "a_notebook.ipynb"
HEAD = re.compile(r"\A---\n.*?\n---\n", re.DOTALL)
CELL = re.compile(r"```\{code-cell\} python\n(.*?)```", re.DOTALL)
INSTALL = "This notebook needs the workbench in the Python that runs it: see [Install](../docs/how-to/install.md)."


def notebook(text: str) -> str:
    """A page in MyST form as a notebook without results."""
    text = HEAD.sub("", text).replace("](../how-to", "](../docs/how-to")
    text = text.replace("](reproduce", "](../docs/tutorial/reproduce")
    text = re.sub(r"This page is a notebook.*?\n\n", f"{INSTALL}\n\n", text, count=1, flags=re.DOTALL)
    pieces = CELL.split(text)  # words, code, words, ...
    cells = [_cell(piece.strip(), k, bool(k % 2)) for k, piece in enumerate(pieces) if piece.strip()]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    found = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def _cell(text: str, k: int, is_code: bool) -> dict[str, Any]:
    cell: dict[str, Any] = {"cell_type": "code" if is_code else "markdown", "id": f"cell-{k}", "metadata": {}}
    cell |= {"execution_count": None, "outputs": []} if is_code else {}
    return cell | {"source": text.splitlines(keepends=True)}


if __name__ == "__main__":
    NOTEBOOK.write_text(notebook(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
