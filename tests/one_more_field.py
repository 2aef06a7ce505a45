"""A process in which the cylinder has one more field, `taper`, declared in one row that nothing uses. Prints "as told".

It is run by `test_extending.py`, as a case's fields are read from their declarations when the modules are imported.
"""

import json
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[1]
ROW = """
    taper: Any = _field("ψ", "rad", "taper of the cylinder", _INCLINED, note="a trial")
"""
STUDY = """
title = "Cones"
units = { length = "cm", force = "N" }
stations = 11
observables = ["height"]
outputs = []
axes.taper.values = ["1deg", "2deg"]
base = { E = 1e4, nu = 0.25, a = 0.25, L = 5.0, R = 0.75, beta = 0.5, dbeta = 0.5, M3 = 0.0 }
"""
CASE = "solve --E 1e4 --nu 0.25 --a 0.25 --L 5 --R 0.75 --beta 0.5 --dbeta 0.5 --M3 0 --json --taper".split()  # noqa: SIM905


def declare() -> None:
    """Put the module of declarations, with the row, in the place of that of the file."""
    name, file = "solver.problem.declared_fields", ROOT / "solver" / "problem" / "declared_fields.py"
    spec = spec_from_file_location(name, file)
    assert spec is not None
    module: ModuleType = module_from_spec(spec)
    source = file.read_text(encoding="utf-8")
    before = "    contact: Literal["
    assert source.count(before) == 1
    sys.modules[name] = module
    exec(compile(source.replace(before, ROW + before), str(file), "exec"), vars(module))


def look(folder: Path) -> None:
    """Use the field everywhere."""
    import contextlib
    import io

    import xarray as xr

    from solver import Cylinder
    from studies import load
    from studies.language.study_schema import study_schema
    from workbench import cli

    assert Cylinder(0.75, taper="2deg").taper == Cylinder(0.75, taper=0.03490658503988659).taper
    study, file = folder / "cones.toml", folder / "cones.h5"
    study.write_text(STUDY)
    assert load(study).case().shape == (2,)
    assert study_schema()["$defs"]["Base"]["properties"]["taper"] == {
        "type": ["number", "string"], "minimum": 0, "maximum": 3.1415926535897967,
        "description": "taper of the cylinder [rad]; a trial",
    }  # fmt: skip

    def said_by(*words: str) -> tuple[int, str]:
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            try:
                cli.main([*words])
            except SystemExit as end:
                return int(end.code or 0), out.getvalue()
        raise AssertionError

    assert said_by("run", str(study), "--out", str(file))[0] == 0
    with xr.open_dataset(file) as ds:
        assert (ds["taper"].dims, ds["taper"].attrs["symbol"]) == (("taper",), "ψ")
    one = STUDY.replace('axes.taper.values = ["1deg", "2deg"]', "axes.E.values = [1e4, 2e4]")
    study.write_text(one.replace("E = 1e4,", 'taper = "180deg",'))
    assert said_by("run", str(study), "--out", str(folder / "one.h5"))[0] == 0
    with xr.open_dataset(folder / "one.h5") as ds:
        assert (ds["taper"].dims, float(ds["taper"])) == ((), 3.141592653589793)
    assert "Taper of the cylinder [rad]; a trial." in " ".join(said_by("solve", "--help")[1].split())
    status, shown = said_by(*CASE, "2deg")
    assert (status, json.loads(shown)["case"]["taper"]) == (0, 0.03490658503988659)
    status, shown = said_by(*CASE, "-2deg")
    assert status == 2
    assert "Cylinder.taper must be from 0 to pi" in shown
    study.write_text(STUDY.replace("2deg", "200deg"))
    assert "cones.toml, line 7: Cylinder.taper must be" in said_by("run", str(study))[1]
    print("as told")


if __name__ == "__main__":
    declare()
    look(Path(sys.argv[1]))
