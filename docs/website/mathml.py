"""Equations of the pages as MathML, which browsers draw themselves: no script, nothing from a network."""

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert


def setup(app: Any) -> dict[str, bool]:
    """Register the writer of equations."""
    app.add_html_math_renderer("mathml", (_write_inline, None), (_write_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _write_inline(writer: Any, node: Any) -> None:
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _write_block(writer: Any, node: Any) -> None:
    text = re.sub(r"\\tag\{(.*?)\}", r"\\qquad\\text{(\1)}", node.astext())  # its number stands behind it
    writer.body.append(f'<div class="mathml">{convert(text, display="block")}</div>')
    raise nodes.SkipNode
