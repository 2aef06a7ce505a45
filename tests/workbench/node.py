"""The modules of the live page, run by Node."""

import atexit
import functools
import json
import shutil
import subprocess
from typing import Any

import pytest

from solver.core import build
from workbench.web.live import live_document

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="Node is not installed")

LOOP = f"""
import fs from "fs";
import {{ createRequire }} from "module";
import {{ createInterface }} from "readline";
const RodCore = createRequire({json.dumps((build.HERE / "rod.js").as_uri())})({json.dumps(str(build.HERE / "rod.js"))});
const core = await RodCore.load(fs.readFileSync({json.dumps(str(build.HERE / build.WASM))}));
const plain = (key, value) => ArrayBuffer.isView(value) ? Array.from(value) : Number.isNaN(value) ? "NaN" : value;
const Script = (async () => {{}}).constructor;
for await (const line of createInterface({{ input: process.stdin }})) {{
  const {{ script, given, modules }} = JSON.parse(line), said = {{}};
  try {{
    const parts = await Promise.all(Object.values(modules).map((url) => import(url)));
    const names = ["fs", "RodCore", "core", "given", "answer", ...Object.keys(modules)];
    await new Script(...names, script)(fs, RodCore, core, given, (value) => said.answer = value, ...parts);
  }} catch (error) {{ said.error = String(error.stack); }}
  console.log(JSON.stringify(said, plain));
}}
"""


@functools.cache
def _process() -> subprocess.Popen[str]:
    """Node, which answers one script after the other."""
    command = [str(NODE), "--input-type=module", "-e", LOOP]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    atexit.register(process.communicate)
    return process


def run(script: str, given: Any = None, modules: tuple[str, ...] = ()) -> Any:
    """What a script answers that may use the names that these modules export, `core`, and `given` (plain data)."""
    urls = {name: (live_document.PAGE / f"{name}.mjs").as_uri() for name in modules}
    process = _process()
    assert process.stdin is not None
    assert process.stdout is not None
    print(json.dumps({"script": script, "given": given, "modules": urls}), file=process.stdin, flush=True)
    said = json.loads(process.stdout.readline())
    assert "error" not in said, said["error"]
    return said["answer"]


def result_of(modules: str, body: str, given: Any = None) -> Any:
    """What the body of a function returns that may use the names that these modules export."""
    return run(f"answer((() => {{ {body} }})());", given, tuple(modules.split(", ")))
