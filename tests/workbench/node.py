"""The modules of the live page, run by Node."""

import json
import shutil
import subprocess
from typing import Any

import pytest

from solver.core import build
from workbench.web.live import live_document

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="Node is not installed")

START = f"""
import fs from "fs";
import {{ createRequire }} from "module";
const RodCore = createRequire({json.dumps((build.HERE / "rod.js").as_uri())})({json.dumps(str(build.HERE / "rod.js"))});
const core = await RodCore.load(fs.readFileSync({json.dumps(str(build.HERE / build.WASM))}));
const given = JSON.parse(fs.readFileSync(0, "utf8"));
const plain = (key, value) => ArrayBuffer.isView(value) ? Array.from(value) : Number.isNaN(value) ? "NaN" : value;
const answer = (value) => console.log(JSON.stringify(value, plain));
"""


def run(script: str, given: Any = None, modules: tuple[str, ...] = ()) -> Any:
    """What a script answers that may use the names that these modules export, `core`, and `given` (plain data)."""
    imports = "".join(
        f"const {name} = await import({json.dumps((live_document.PAGE / f'{name}.mjs').as_uri())});\n"
        for name in modules
    )
    command = [str(NODE), "--input-type=module", "-e", START + imports + script]
    done = subprocess.run(command, input=json.dumps(given), capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
