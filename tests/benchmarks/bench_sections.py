"""How long exact sections, volumes and maps take, beside OpenCASCADE's boolean; run it by itself:

    PYTHONPATH=. python tests/benchmarks/bench_sections.py [--without-opencascade]

OpenCASCADE needs cadquery (the extra `bench`, about 2 GB) and takes a minute; without it that line
is left out. Everything is measured in this run: read the ratios rather than the milliseconds.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median

import numpy as np
from bench_solids import cases

from kinematics.designs.files import load_design
from kinematics.facets.map_sweeps import map_request, sweep
from kinematics.mechanisms.five_rpur.inscribed.largest import box, sphere
from kinematics.mechanisms.five_rpur.sections import integrate
from kinematics.mechanisms.five_rpur.slicing import cutter
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from tests.kinematics.mechanisms.five_rpur.machines import section, section_range, volume

ROUNDS = 9


def seconds(call, rounds=ROUNDS):
    """The median time of some calls, and the last result."""
    taken = []
    for _ in range(rounds):
        start = time.perf_counter()
        result = call()
        taken.append(time.perf_counter() - start)
    return median(taken), result


def volumes() -> float:
    print("\nvolumes (median of rounds; without pieces), their stated and their true errors")
    print(
        f"{'design':18} {'modes':6} {'wanted':>7} {'ms':>7} {'sections':>8} "
        f"{'stated':>8} {'true':>8}"
    )
    first = 0.0
    for case, design, modes in cases():
        exact = integrate(Cutter(design, case["phi"], case["theta"], modes), 1e-10).moments[0]
        for relative in (1e-4, 1e-6):
            took, found = seconds(
                lambda d=design, c=case, m=modes, r=relative: integrate(
                    Cutter(d, c["phi"], c["theta"], m), r
                )
            )
            value = found.moments[0]
            print(
                f"{case['name']:18} {(modes or ('all',))[0]:6} {relative:7.0e} {1e3 * took:7.1f} "
                f"{found.sections:8} {found.error / value:8.1e} {abs(value / exact - 1):8.1e}"
            )
            if relative == 1e-6 and not first:
                first = took
    return first


def sections() -> None:
    design = load_design("rpur-table1")
    low, high = section_range(design, 0.0, 0.0)
    places = np.linspace(low, high, 200)
    took, _ = seconds(lambda: [section(design, 0.0, 0.0, x) for x in places])
    print(f"\none section with loops, edges and moments: {1e6 * took / len(places):.0f} µs")
    cutter = Cutter(design, 0.0, 0.0, None)
    took, _ = seconds(lambda: cutter.cut(places))
    print(f"one section's area alone, in a batch:      {1e6 * took / len(places):.0f} µs")
    took, found = seconds(lambda: volume(design, 0.0, 0.0))
    print(f"volume to 1e-6 with its {len(found.pieces)} pieces:         {1e3 * took:.1f} ms")
    for name, call in (
        ("largest ball", lambda: sphere(design, 0.0, 0.0)),
        ("largest box", lambda: box(design, 0.0, 0.0)),
    ):
        took, _ = seconds(call, rounds=3)
        print(f"{name + ':':42} {1e3 * took:.0f} ms")


def maps() -> None:
    cores = os.cpu_count() or 1
    axis = np.radians(np.linspace(-90.0, 90.0, 37))
    request = map_request(load_design("rpur-table1"), axis, axis, relative=1e-4)
    with ProcessPoolExecutor(cores, get_context("spawn"), initializer=cutter.prepare) as pool:
        list(pool.map(abs, range(cores)))
        start = time.perf_counter()
        found = sweep(request, pool)
        took = time.perf_counter() - start
    print(f"\nmap of 37 x 37 volumes to 1e-4 on {cores} cores: {took:.1f} s, {found.done.all()}")


def opencascade(ours: float) -> None:
    if "--without-opencascade" in sys.argv or importlib.util.find_spec("OCP") is None:
        print("\nOpenCASCADE is left out: it needs the extra `bench` (cadquery).")
        return
    from opencascade import workspace_volume

    start = time.perf_counter()
    value = workspace_volume(load_design("rpur-table1"), 0.0, 0.0)
    took = time.perf_counter() - start
    print(f"\nOpenCASCADE, Table 1 at 0: {value:.0f} mm3 in {took:.1f} s")
    print(f"ours to 1e-6: {1e3 * ours:.1f} ms, {took / ours:.0f} times faster")


def main() -> None:
    start = time.perf_counter()
    assert cutter.prepare(), "numba is missing: plain Python is not measured"
    print(f"kernel compiled or loaded in {time.perf_counter() - start:.1f} s")
    ours = volumes()
    sections()
    maps()
    opencascade(ours)


if __name__ == "__main__":
    main()
