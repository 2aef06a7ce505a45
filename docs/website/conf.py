"""The settings of Sphinx. Nothing on the site comes from a network: no font, no script, no other project's index."""

import re
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # a checkout that is not installed

from workbench import __version__

project = "Rod workbench"
author = "The rod workbench authors"
release = version = __version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc", "sphinx_gallery.gen_gallery", "docs.website.mathml"]
html_math_renderer = "mathml"
root_doc = "index"
exclude_patterns = ["examples/*", "gallery/*.ipynb"]
html_theme = "furo"
html_title = f"Rod workbench {release}"
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
html_show_search_summary = False  # a browser may not read the pages of a site that is opened as a file
html_theme_options = {"source_repository": "", "source_branch": "", "source_directory": ""}
templates_path: list[str] = []
default_role = "literal"  # a single backquote in a docstring is code
smartquotes = False  # two hyphens are those of an option, and a straight quote is a derivative

myst_enable_extensions = ["html_image", "attrs_inline", "dollarmath"]
myst_heading_anchors = 4  # as a forge makes them
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True

autodoc_typehints = "none"  # the docstring says types, shapes and units
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_show_inherited_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "image_scrapers": ("docs.website.gallery.written_files",),
    "reset_modules": (),
    "abort_on_example_error": True,
    "capture_repr": (),
    "download_all_examples": False,
    "write_computation_times": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1000,
    "within_subsection_order": "FileNameSortKey",
    "plot_gallery": True,
    "thumbnail_size": (640, 448),
    "remove_config_comments": True,
}


def escape_docstring(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Escape asterisks and bars of a docstring outside code: there they are arithmetic, shapes and sizes."""
    for i, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.split(r"(``.*?``|`.*?`)", line)
            lines[i] = "".join(part if part.startswith("`") else re.sub(r"([*|])", r"\\\1", part) for part in parts)


def setup(app: Any) -> None:
    """Register what this file adds."""
    app.connect("autodoc-process-docstring", escape_docstring, priority=400)  # before numpydoc
