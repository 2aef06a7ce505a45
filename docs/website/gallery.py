"""What the gallery shows of an example: the pictures and the turning scenes that the script wrote."""

import shutil
from pathlib import Path
from typing import Any

from sphinx_gallery.scrapers import figure_rst

FRAME = """
.. raw:: html

   <iframe src="../_static/{name}" title="A scene to turn" style="width: 100%; height: 640px; border: 0"></iframe>
"""


def written_files(block: Any, block_vars: dict[str, Any], gallery: dict[str, Any]) -> str:
    """The reStructuredText of the files that a block of a script wrote, which bear the name of the script."""
    script, text = Path(block_vars["src_file"]), ""
    for path in sorted(script.parent.glob(f"{script.stem}.*")):
        if path.suffix == ".png":
            place = Path(next(block_vars["image_path_iterator"]))
            shutil.move(path, place)
            text += figure_rst([str(place)], gallery["src_dir"])
        elif path.suffix == ".html":
            shutil.move(path, Path(gallery["src_dir"]) / "_static" / path.name)
            text += FRAME.format(name=path.name)
    return text
