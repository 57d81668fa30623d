"""How long workspace solids take and how far off they are; run it by itself:

    PYTHONPATH=. python tests/benchmarks/bench_solids.py

Every line is measured in this run on this machine, round by round over all cases, so that what
is slow for a moment is slow for all: read the ratios rather than the milliseconds.
"""

from __future__ import annotations

import json
import time
from pathlib import Path
from statistics import median

from kinematics.facets.solids import RESOLUTIONS
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.workspace.workspace import limb_part, workspace
from kinematics.solids.files import KINDS, encode

ROOT = Path(__file__).resolve().parents[2]
ROUNDS = 7


def cases():
    stored = json.loads((ROOT / "tests/reference/volumes.json").read_text(encoding="utf-8"))
    for case in stored["cases"]:
        rows = zip(case["r"], case["s"], case["l"], case["rho_min"], case["rho_max"], strict=True)
        design = FiveRPURDesign(
            tuple(Limb(tuple(r), tuple(s), link, (a, b)) for r, s, link, a, b in rows)
        )
        signs = case["modes"]
        modes = None if signs is None else ("".join("+" if s > 0 else "-" for s in signs),)
        yield case, design, modes


def milliseconds(call):
    start = time.perf_counter()
    result = call()
    return result, 1e3 * (time.perf_counter() - start)


def main() -> None:
    listed = list(cases())
    _, cold = milliseconds(lambda: workspace(listed[0][1], 0.0, 0.0, None, "preview"))
    print(f"first preview, limb solids and imports of native code included: {cold:.0f} ms")
    for resolution in RESOLUTIONS[1:]:
        _, cold = milliseconds(lambda r=resolution: workspace(listed[0][1], 0.0, 0.0, None, r))
        print(f"first {resolution}, limb solids included: {cold:.0f} ms")

    times = {(n, r): [] for n in range(len(listed)) for r in RESOLUTIONS}
    built = {}
    for _ in range(ROUNDS):
        for n, (case, design, modes) in enumerate(listed):
            for resolution in RESOLUTIONS:
                built[n, resolution], took = milliseconds(
                    lambda d=design, c=case, m=modes, r=resolution: workspace(
                        d, c["phi"], c["theta"], m, r
                    )
                )
                times[n, resolution].append(took)

    print("\nmedian (least) ms; relative error, estimated error; triangles, pieces")
    for n, (case, _, modes) in enumerate(listed):
        print(
            f"{case['name']}, φ {case['phi']:.2f}, θ {case['theta']:.2f}, {(modes or ['all'])[0]}"
        )
        for resolution in RESOLUTIONS:
            solid, took = built[n, resolution], times[n, resolution]
            error = solid.volume / case["volume"] - 1
            estimate = solid.volume_error / case["volume"]
            print(
                f"  {resolution:8}{median(took):7.0f} ({min(took):.0f})"
                f"{error:+10.1e}{estimate:9.1e}{solid.triangles:8}{len(solid.pieces):3}"
            )

    print("\nratios of the sums of the least times")
    total = {r: sum(min(times[n, r]) for n in range(len(listed))) for r in RESOLUTIONS}
    for resolution in RESOLUTIONS:
        print(f"  {resolution}: {total[resolution] / total['preview']:.2f} of preview")
    wide = [n for n, (_, _, modes) in enumerate(listed) if modes is None]
    one = [n for n in range(len(listed)) if n not in wide]
    for resolution in RESOLUTIONS:
        each = [
            sum(min(times[n, resolution]) for n in chosen) / len(chosen) for chosen in (one, wide)
        ]
        print(f"  one working mode to all of them, {resolution}: {each[0] / each[1]:.2f}")

    solid = built[0, "normal"]
    _, cold = milliseconds(lambda: encode(solid.mesh, KINDS[0]))
    print(f"\nfiles of a normal solid; the first, imports included: {cold:.0f} ms")
    for kind in KINDS:
        data, took = milliseconds(lambda k=kind: encode(solid.mesh, k))
        print(f"  {kind}: {took:.0f} ms, {len(data) / 1e3:.0f} kB")
    _, took = milliseconds(lambda: limb_part(listed[0][1], 1, "whole", "normal"))
    _, again = milliseconds(lambda: limb_part(listed[0][1], 1, "whole", "normal"))
    print(f"\nvertex space, normal: {took:.0f} ms, asked again {again:.3f} ms")


if __name__ == "__main__":
    main()
