"""The kernel compiled and in plain Python: the same numbers, and nobody waits for a compiler."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from kinematics.designs import load_design
from kinematics.five_rpur.maps import map_cells
from kinematics.five_rpur.section import section
from kinematics.five_rpur.slicing import acceleration, kernel
from kinematics.five_rpur.volume import volume

MEASURED = """
import json, sys
from kinematics.designs import load_design
from kinematics.five_rpur.section import section
from kinematics.five_rpur.slicing import acceleration
from kinematics.five_rpur.volume import volume
design = load_design("rpur-table1")
cuts = [section(design, 0.3, -0.2, x) for x in (-150.0, 40.0, 210.0)]
exact = volume(design, 0.3, -0.2, ["+-+-+"], relative=1e-2)
print(json.dumps({
    "areas": [cut.area for cut in cuts],
    "sweeps": [cut.sweep.tolist() for cut in cuts],
    "volume": exact.value, "pieces": exact.pieces,
    "compiled": acceleration.is_compiled(), "numba": "numba" in sys.modules,
}))
"""


def run(code, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=150,
    )
    return json.loads(done.stdout)


@pytest.mark.usefixtures("compiled")
def test_plain_python_gives_the_same():
    plain = run(MEASURED, NUMBA_DISABLE_JIT="1")
    assert not plain["compiled"]
    design = load_design("rpur-table1")
    cuts = [section(design, 0.3, -0.2, x) for x in (-150.0, 40.0, 210.0)]
    exact = volume(design, 0.3, -0.2, ["+-+-+"], relative=1e-2)
    assert acceleration.is_compiled()
    assert plain["areas"] == pytest.approx([cut.area for cut in cuts], rel=1e-12)
    for told, cut in zip(plain["sweeps"], cuts, strict=True):
        assert told == pytest.approx(cut.sweep.tolist(), abs=1e-9)
    assert plain["volume"] == pytest.approx(exact.value, rel=1e-12)
    assert plain["pieces"] == pytest.approx(exact.pieces, rel=1e-12)


def test_a_section_never_waits_for_the_compiler(tmp_path):
    code = """
import json, sys
from kinematics.designs import load_design
from kinematics.five_rpur.section import section
cut = section(load_design("rpur-table1"), 0.0, 0.0, 50.0)
print(json.dumps({"area": cut.area, "numba": "numba" in sys.modules}))
"""
    told = run(code, XDG_CACHE_HOME=str(tmp_path))
    assert told["area"] == pytest.approx(46_318.5898, rel=1e-8)
    assert not told["numba"]


@pytest.mark.usefixtures("compiled")
def test_nothing_is_compiled_a_second_time_in_ordinary_use():
    design = load_design("rpur-table2")
    section(design, 0.1, 0.2, 30.0, ["+++++", "-----"])
    volume(design, 0.1, 0.2, relative=1e-3)
    volume(design, 0.1, 0.2, ["+++++"], relative=1e-3, between=(0.0, 50.0))
    map_cells(design, [[0.0, 0.0, 0.0, 0.1, 0.2]], ("+++++",), ("volume", "pieces", "stroke"))
    for function in (kernel.measure, kernel.outline, kernel.describe, kernel.trace, kernel.strokes):
        assert len(function.signatures) == 1, function
