"""How long aspects, singular curves, the nearest singularity and the free ball take:

    PYTHONPATH=. python tests/benchmarks/bench_aspects.py

The floors: aspects with their surface at normal resolution 500 ms, a preview 80 ms. The best of
many and the median, as the machine may be busy.
"""

from __future__ import annotations

import time
from statistics import median

from kinematics.designs.files import load_design
from kinematics.facets.solids import RESOLUTIONS
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.singularities.aspects import aspects
from kinematics.mechanisms.five_rpur.singularities.ball import singularity_free_ball
from kinematics.mechanisms.five_rpur.singularities.curves import Loci
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity
from kinematics.mechanisms.five_rpur.workspace.workspace import workspace

ROUNDS = 9
CASES = [("+++++", 0.2, 0.1), ("-----", 0.3, -0.4), ("+++++", 0.0, 0.0), ("+-+-+", 0.0, 0.0)]


def measured(title, call):
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        result = call()
        times.append(1e3 * (time.perf_counter() - start))
    print(f"{title:44} best {min(times):7.1f} ms, median {median(times):7.1f} ms")
    return result


def main() -> None:
    design = load_design("rpur-table1")
    for mode, phi, theta in CASES:
        where = f"{mode} φ {phi:g} θ {theta:g}"
        for resolution in RESOLUTIONS:
            aspects(design, phi, theta, mode, resolution)  # limb solids are kept
            measured(
                f"workspace {where} {resolution}",
                lambda r=resolution, a=(phi, theta, (mode,)): workspace(design, *a, r),
            )
            built = measured(
                f"aspects   {where} {resolution}",
                lambda r=resolution, a=(phi, theta, mode): aspects(design, *a, r),
            )
        print(
            f"  {len(built.pieces)} pieces, {built.triangles} triangles, "
            f"{int(built.on_locus.sum())} on the locus, residual {built.locus_residual:.0e} mm "
            f"but for {built.locus_unplaced}"
        )
        pose = (80.0, 100.0, 300.0, phi, theta)
        for spec in Loci.loci:
            measured(
                f"curves    {where} {spec.key}",
                lambda k=spec.key, p=pose, m=mode: machine_of(design).singularities.locus(k, p, m),
            )
        measured(f"nearest   {where}", lambda p=pose, m=mode: nearest_singularity(design, p, m))
        measured(
            f"free ball {where}",
            lambda a=(phi, theta, mode): singularity_free_ball(design, *a),
        )


if __name__ == "__main__":
    main()
