"""Pages of one HTML text that load nothing: a template, filled in with its style, its scripts and its data."""

import base64
import hashlib
import json
from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined

from ..words.escaping import finite


@cache
def read(package: str, *names: str) -> str:
    """The text of a file of a package."""
    return files(package).joinpath(*names).read_text(encoding="utf-8")


def fill(template: str, finalize: Callable[[Any], Any] | None = None, **values: Any) -> str:
    """The text of a template, filled in; finalize: applied to each value that it prints."""
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, finalize=finalize
    )
    return environment.from_string(template).render(**values)


def page(
    template: str,
    style: str,
    scripts: Mapping[str, str],
    data: Any,
    served: bool = False,
    finalize: Callable[[Any], Any] | None = None,
    **values: Any,
) -> str:
    """A page, whose policy lets the browser run these scripts alone.

    scripts: name in the template -> text. served: whether the page may ask its own server. data: plain data, as JSON
    that may stand inside a script element.
    """
    allowed = " ".join(map(_digest, scripts.values()))
    server = "'self'" if served else "'none'"
    policy = (
        f"default-src 'none'; script-src {allowed} 'wasm-unsafe-eval'; style-src {_digest(style)}; "
        f"img-src data: blob:; connect-src {server}; base-uri 'none'; form-action 'none'"
    )
    plain = json.dumps(finite(data), ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    return fill(template, finalize, policy=policy, style=style, data=plain, **scripts, **values)


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
