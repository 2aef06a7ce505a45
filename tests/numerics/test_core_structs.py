"""The structs that Python gives to the compiled core, against the C files that declare them."""

import subprocess
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.core import branch_calls, library
from solver.core.build import HERE, compilers
from solver.core.library import MissingCore, Structure, structure
from solver.observe import motions, self_contact  # noqa: F401  # they declare structs
from solver.orbits.marched_orbit import ORBIT

RECORDS = ("orbit", "rod.c", ORBIT), ("record", "branch_steps.c", branch_calls.RECORD)


def test_every_struct_lies_in_memory_as_the_compiler_lays_it_out(tmp_path: Path) -> None:
    """Each offset and size is asserted where the C file itself is compiled."""
    command = next(iter(compilers()), None)
    if command is None:
        pytest.skip("there is no C compiler")
    laid_out: list[tuple[str, str, int, dict[str, int]]] = []
    for one in Structure.__subclasses__():
        offsets = {name: getattr(one, name).offset for name in one._names}
        laid_out.append((one._file, one.__name__, library.ctypes.sizeof(one), offsets))
    for name, file, record in RECORDS:
        fields: Any = record.fields
        laid_out.append((file, name, record.itemsize, {field: fields[field][1] for field in fields}))
    assert len(laid_out) > 15
    for file, structs in groupby(sorted(laid_out, key=lambda row: row[0]), key=lambda row: row[0]):
        lines = ["#include <stddef.h>", f'#include "{HERE / file}"']
        for _, name, size, offsets in structs:
            lines.append(f'_Static_assert(sizeof({name}) == {size}, "{name}");')
            lines += [f'_Static_assert(offsetof({name}, {f}) == {at}, "{name}.{f}");' for f, at in offsets.items()]
        (tmp_path / "laid_out.c").write_text("\n".join(lines))
        asked = [*command, "-std=gnu11", "-DROLLED", "-fsyntax-only", str(tmp_path / "laid_out.c")]
        done = subprocess.run(asked, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[:2000]


@pytest.fixture
def alter(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Writes a header with other words, from which structs are then read."""

    def alter(old: str, new: str) -> None:
        text = (HERE / "variations.h").read_text()
        assert old in text
        (tmp_path / "altered.h").write_text(text.replace(old, new))

    monkeypatch.setattr(library, "HERE", tmp_path)
    library._text_of.cache_clear()
    yield alter
    library._text_of.cache_clear()


def test_the_core_reads_whole_numbers_with_gaps_between_them_as_its_own() -> None:
    at = library._Grid(3, np.arange(6)[::2], np.empty(0)).angles
    assert library.ctypes.cast(at, library.ctypes.POINTER(library.FLOAT))[:3] == [0.0, 2.0, 4.0]


def test_a_field_that_the_header_no_longer_has_is_refused_in_a_sentence(alter: Any) -> None:
    alter("*series, *gain;", "*rows, *gain;")
    renamed = structure("varied_orbits", "altered.h")
    with pytest.raises(MissingCore, match=r"the struct varied_orbits in altered.h has no field series; install"):
        renamed(series=np.ones(3), lanes=1)


def test_a_struct_or_a_kind_that_python_does_not_know_is_refused_in_a_sentence(alter: Any) -> None:
    alter("int64_t lanes;", "unsigned lanes;")
    with pytest.raises(MissingCore, match=r"the field lanes of struct varied_orbits in altered.h is not what Python"):
        structure("varied_orbits", "altered.h")
    with pytest.raises(MissingCore, match=r"altered.h has no struct moved_orbits"):
        structure("moved_orbits", "altered.h")
