"""`bohemia`: the page, and the same answers without a browser.

Angles are degrees here and nowhere below. Numbers go to stdout (with --json one object and nothing
else), progress and warnings to stderr. Exit code 0: done, 1: it could not be computed,
2: bad input. Whatever is slow to import is imported by the command that needs it.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from difflib import get_close_matches
from math import isfinite, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from app import tables
from app.modes import matching
from kinematics.errors import BohemiaError, ComputationError, InputError

if TYPE_CHECKING:
    from kinematics.mechanism import Coordinate, Design, Mechanism
    from kinematics.solutions import Posture

DEFAULT_DESIGN = "rpur-table1"

# Their values may begin with a minus sign, which argparse takes for an option.
SIGNED_OPTIONS = frozenset({"--pose", "--joints", "--phi", "--theta", "--modes"})

# Beyond this a typed number is a slip, and squares of it no longer hold a mm.
LARGEST = 1e9


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal without φ shows ? and goes on
            stream.reconfigure(errors="replace")
    try:
        arguments = _parse(list(sys.argv[1:] if argv is None else argv))
        arguments.command(arguments)
        sys.stdout.flush()
    except InputError as error:
        return _fail(error, 2)
    except BohemiaError as error:
        return _fail(error, 1)
    except BrokenPipeError:  # the reader, as `head`, had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def _fail(error: BohemiaError, code: int) -> int:
    print(f"bohemia: {' '.join(str(error).split())}", file=sys.stderr)
    return code


# --- arguments -----------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    """Mistakes become one sentence instead of a usage listing."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


class _Version(argparse.Action):
    """Looks the version up only when it is asked for: that takes longer than --help."""

    def __init__(self, **options: Any) -> None:
        super().__init__(nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            found = version("bohemia")
        except PackageNotFoundError:
            found = "(not installed)"
        print(f"bohemia {found}")
        parser.exit()


def _parser() -> tuple[argparse.ArgumentParser, tuple[str, ...]]:
    """The parser, and the names of its commands."""
    parser = _Parser(
        prog="bohemia",
        description="An instrument for people who design parallel mechanisms. "
        "Without a command it serves the page.",
        epilog="Lengths are mm, angles degrees. DESIGN is a preset (see bohemia designs) or the "
        "path of a design file.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, title="commands")

    def command(name: str, run: Any, summary: str) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=summary, description=summary, allow_abbrev=False)
        added.set_defaults(command=run)
        return added

    serve = command("serve", _serve, "The page, in the browser.")
    serve.add_argument(
        "design", metavar="DESIGN", nargs="?", help=f"what to open (default {DEFAULT_DESIGN})"
    )
    serve.add_argument("--host", default="127.0.0.1", help="address to listen on (%(default)s)")
    serve.add_argument("--port", type=_port, default=8080, help="port to listen on (%(default)s)")
    serve.add_argument("--session", type=Path, metavar="FILE", help="keep the review in this file")
    serve.add_argument("--no-browser", action="store_true", help="do not open a browser")

    designs = command("designs", _designs, "The presets.")
    _add_json(designs)

    ik = command("ik", _ik, "Inverse kinematics: every working mode of a pose.")
    _add_design(ik)
    ik.add_argument("--pose", required=True, metavar="x,y,z,phi,theta", help="mm and degrees")
    _add_json(ik)

    fk = command("fk", _fk, "Forward kinematics: every assembly mode of given actuators.")
    fk.epilog = (
        "JSON has no infinity: a condition of null is a singularity, a gap_mm of null an only "
        "solution."
    )
    _add_design(fk)
    fk.add_argument(
        "--joints", required=True, metavar="rho1,...", help="actuated joints, mm (angles: degrees)"
    )
    fk.add_argument(
        "--within-stroke", action="store_true", help="only solutions within the strokes"
    )
    fk.add_argument(
        "--mixed-modes",
        action="store_true",
        help="for simplified designs: also solutions in which the two limbs of an arrangement "
        "stand in different working modes, which takes longer",
    )
    _add_json(fk)

    workspace = command("workspace", _workspace, "The constant-orientation workspace as a solid.")
    _add_design(workspace)
    _add_orientation(workspace)
    workspace.add_argument(
        "--modes",
        default="all",
        metavar="MODES",
        help="working modes, one sign a limb, as +-+++; several with commas, ? for either sign "
        "(default all)",
    )
    _add_solid(workspace)

    vertex_space = command(
        "vertex-space", _vertex_space, "One limb's vertex space or a part of it."
    )
    _add_design(vertex_space)
    vertex_space.add_argument("--limb", required=True, metavar="i", help="the limb, from 1")
    vertex_space.add_argument(
        "--part",
        default="whole",
        metavar="PART",
        help="whole, plus, minus, body, H1, H2 or H3 (default %(default)s)",
    )
    _add_orientation(vertex_space)
    _add_solid(vertex_space)
    return parser, tuple(commands.choices)


def _add_design(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", help="a preset or a design file")


def _add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_orientation(parser: argparse.ArgumentParser) -> None:
    for name in ("phi", "theta"):
        parser.add_argument(
            f"--{name}", type=_angle, default=0.0, metavar="DEG", help="degrees (default 0)"
        )


def _add_solid(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolution",
        choices=("preview", "normal", "fine"),
        default="normal",
        help="how fine the mesh is; the volume's error is printed (default %(default)s)",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write .stl, .3mf, .ply, .glb or .obj"
    )
    _add_json(parser)


def _parse(argv: list[str]) -> argparse.Namespace:
    parser, commands = _parser()
    first = argv[0] if argv else ""
    if not first or (first.startswith("-") and first not in {"-h", "--help", "--version"}):
        argv = ["serve", *argv]
    elif not first.startswith("-") and first not in commands:
        near = get_close_matches(first, commands, n=1)
        hint = f"did you mean {near[0]!r}" if near else f"there are {', '.join(commands)}"
        raise InputError(f"there is no command {first!r}; {hint}")
    return parser.parse_args(_joined(argv))


def _joined(argv: list[str]) -> list[str]:
    """`--pose -10,…` as `--pose=-10,…`, the form in which argparse accepts it."""
    joined: list[str] = []
    words = iter(argv)
    for word in words:
        value = next(words, None) if word in SIGNED_OPTIONS else None
        joined.append(word if value is None else f"{word}={value}")
    return joined


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port from 0 to 65535")
    return int(text)


def _angle(text: str) -> float:
    try:
        return _number(text, "the angle in degrees")
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _number(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{name} must be a number, got {text.strip()!r}") from None
    if not isfinite(value):
        raise InputError(f"{name} must be a finite number, got {text.strip()}")
    if abs(value) > LARGEST:
        raise InputError(f"{name} must lie within ±{LARGEST:.0e}, got {text.strip()}")
    return value


def _numbers(option: str, text: str, axes: Sequence[Coordinate]) -> list[float]:
    """The numbers as typed, mm and degrees, one for each coordinate."""
    words = text.split(",")
    wanted = ", ".join(f"{axis.symbol} ({tables.unit(axis)})" for axis in axes)
    if len(words) != len(axes):
        raise InputError(
            f"{option} needs {len(axes)} numbers with commas between them, {wanted}; "
            f"got {len(words)}"
        )
    return [
        _number(word, f"{option}: {axis.symbol}") for word, axis in zip(words, axes, strict=True)
    ]


def _modes(text: str, known: tuple[str, ...]) -> tuple[str, ...] | None:
    """The working modes asked for, in the mechanism's order; None for all of them."""
    if text.strip().lower() == "all":
        return None
    try:
        chosen = matching(text, known)
    except InputError as error:
        raise InputError(f"--modes: {error}, or 'all'") from None
    return None if len(chosen) == len(known) else chosen


# --- commands ------------------------------------------------------------------------------


def _serve(arguments: argparse.Namespace) -> None:
    design, _ = _load(arguments.design or DEFAULT_DESIGN)
    from app.server import run

    if arguments.design and arguments.session is not None and arguments.session.exists():
        print(
            f"bohemia: warning: {arguments.session} holds a review, which is opened instead of "
            f"{arguments.design}",
            file=sys.stderr,
        )
    with suppress(KeyboardInterrupt):  # the usual way to stop a server
        run(
            design,
            host=arguments.host,
            port=arguments.port,
            session=arguments.session,
            open_browser=not arguments.no_browser,
        )


def _designs(arguments: argparse.Namespace) -> None:
    from kinematics.designs import presets

    found = presets()
    if arguments.json:
        keys = ("name", "mechanism", "title", "source")
        _print_json({"designs": [{key: getattr(preset, key) for key in keys} for preset in found]})
        return
    rows = [(preset.name, preset.mechanism, preset.title, preset.source) for preset in found]
    print(tables.table(("name", "mechanism", "title", "source"), rows))


def _ik(arguments: argparse.Namespace) -> None:
    design, mechanism = _load(arguments.design)
    axes = mechanism.pose_coordinates(design)
    typed = _numbers("--pose", arguments.pose, axes)
    pose = [tables.inner(value, axis) for value, axis in zip(typed, axes, strict=True)]
    postures = [mechanism.posture(design, pose, mode) for mode in mechanism.modes]
    closing = [posture for posture in postures if posture.closes]
    reachable = any(posture.reachable for posture in postures)
    nearest = min(postures, key=_miss)
    reasons = [] if reachable else [reason.text for reason in nearest.reasons]
    _warn(design, mechanism)
    joints = mechanism.joint_coordinates(design)
    if not arguments.json:
        _print_head(design, f"Pose {tables.with_units(typed, axes)}")
        print(tables.inverse_text(closing, nearest, joints, reachable))
        return
    transform = mechanism.transform(design, pose).tolist()
    _print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "pose": {tables.key(axis): value for axis, value in zip(axes, typed, strict=True)},
            "transform": transform,
            "reachable": reachable,
            "reasons": reasons,
            "solutions": [
                {
                    "working_mode": posture.mode,
                    "joints": tables.outer(posture.joints, joints),
                    "within_stroke": posture.reachable,
                    "reasons": [reason.text for reason in posture.reasons],
                    "residual": posture.residual,
                    "transform": transform,
                }
                for posture in closing
            ],
        }
    )


def _miss(posture: Posture) -> tuple[int, float]:
    """How badly a pose is missed: by limbs that cannot close, then by mm beyond a bound."""
    unclosed = sum(not isfinite(joint) for joint in posture.joints)
    return unclosed, max((reason.amount for reason in posture.reasons), default=0.0)


def _fk(arguments: argparse.Namespace) -> None:
    design, mechanism = _load(arguments.design)
    actuators = mechanism.joint_coordinates(design)
    typed = _numbers("--joints", arguments.joints, actuators)
    joints = [tables.inner(value, axis) for value, axis in zip(typed, actuators, strict=True)]
    with _progress("All assembly modes"):
        (found,) = mechanism.forward(design, [joints], mixed_modes=arguments.mixed_modes)
    _warn(design, mechanism)
    for value, axis in zip(joints, actuators, strict=True):
        if not axis.lower <= value <= axis.upper:
            print(f"bohemia: warning: {tables.beyond_stroke(value, axis)}", file=sys.stderr)
    axes = mechanism.pose_coordinates(design)
    order = mechanism.modes.index
    shown = sorted(
        (n for n in range(len(found)) if found.within_stroke[n] or not arguments.within_stroke),
        key=lambda n: (not found.within_stroke[n], order(found.modes[n]), *found.poses[n]),
    )
    if not arguments.json:
        _print_head(design, f"Joints {tables.with_units(typed, actuators)}")
        print(tables.forward_text(found, shown, axes))
        return
    transforms = mechanism.transform(design, found.poses).tolist()

    def pose(values: Sequence[float]) -> dict[str, float]:
        return dict(zip(map(tables.key, axes), tables.outer(values, axes), strict=True))

    _print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "joints": typed,
            "solutions": [
                {
                    "identity": found.identities[n],
                    "pose": pose(found.poses[n]),
                    "working_mode": found.modes[n],
                    "joints": typed,
                    "within_stroke": bool(found.within_stroke[n]),
                    "residual": float(found.residual[n]),
                    "condition": _finite(found.condition[n]),
                    "determinant": _finite(found.determinant[n]),
                    "multiplicity": int(found.multiplicity[n]),
                    "gap_mm": _finite(found.gap[n]),
                    "transform": transforms[n],
                }
                for n in shown
            ],
            "real_count": len(found),
            "complex_count": found.complex_count,
            "expected_count": found.expected_count,
            "complete": found.complete,
            "method": found.method,
            "seconds": found.seconds,
            "notes": found.notes,
            "self_motions": [
                {
                    "pose": pose(motion.pose),
                    "working_mode": motion.mode,
                    "direction": pose(motion.direction),
                    "text": motion.text,
                }
                for motion in found.self_motions
            ],
        }
    )


def _workspace(arguments: argparse.Namespace) -> None:
    design, mechanism = _load(arguments.design)
    modes = _modes(arguments.modes, mechanism.modes)
    _solid(arguments, design, mechanism, "workspace", modes)


def _vertex_space(arguments: argparse.Namespace) -> None:
    design, mechanism = _load(arguments.design)
    limbs: dict[str, dict[str, str]] = {}
    for spec in mechanism.solids(design):
        if spec.limb is not None:
            part = spec.key.partition("/")[2]
            limbs.setdefault(str(spec.limb), {})[part.lower()] = spec.key
    if not limbs:
        raise InputError(f"{design.name}: a {mechanism.title} has no vertex spaces")
    parts = limbs.get(arguments.limb.strip())
    if parts is None:
        raise InputError(f"--limb must be one of {', '.join(limbs)}, got {arguments.limb!r}")
    key = parts.get(arguments.part.strip().lower())
    if key is None:
        known = ", ".join(key.partition("/")[2] for key in parts.values())
        raise InputError(f"--part must be one of {known}, got {arguments.part!r}")
    _solid(arguments, design, mechanism, key, None)


def _solid(
    arguments: argparse.Namespace,
    design: Design,
    mechanism: Mechanism,
    key: str,
    modes: tuple[str, ...] | None,
) -> None:
    """Build one solid, write it if a file is wanted, and print what it is."""
    from app import exporting

    spec = next((spec for spec in mechanism.solids(design) if spec.key == key), None)
    if spec is None:
        raise InputError(f"{design.name}: a {mechanism.title} has no {key} solid")
    path: Path | None = arguments.output
    kind = None if path is None else _checked(path, exporting.format_of(path))
    typed = {"phi": arguments.phi, "theta": arguments.theta}
    pose = [radians(typed.get(axis.key, 0.0)) for axis in mechanism.pose_coordinates(design)]
    request = mechanism.solid_request(design, key, pose, modes, arguments.resolution)
    with _progress(f"{spec.title}, {arguments.resolution}"):
        built = mechanism.build_solid(request)
    _warn(design, mechanism)
    if path is not None and kind is not None:
        if built.triangles == 0:
            raise ComputationError(f"{spec.title} is empty, so {str(path)!r} was not written")
        data = exporting.solid_bytes(built, mechanism.solid_placement(design, key, pose), kind)
        _write(path, data)
    if not arguments.json:
        _print_head(design)
        where = f"at φ = {arguments.phi:g}°, θ = {arguments.theta:g}°, {arguments.resolution}"
        file = None if path is None else str(path)
        print(tables.solid_text(built, spec.title, where, modes if spec.uses_modes else (), file))
        return
    _print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "solid": key,
            "phi_deg": arguments.phi,
            "theta_deg": arguments.theta,
            **({"modes": "all" if modes is None else modes} if spec.uses_modes else {}),
            "resolution": arguments.resolution,
            "volume_mm3": built.volume,
            "volume_error_mm3": built.volume_error,
            "pieces": len(built.pieces),
            "piece_volumes_mm3": [piece.volume for piece in built.pieces],
            "triangles": built.triangles,
            "watertight": built.watertight,
            "file": None if path is None else str(path),
        }
    )


# --- in and out ----------------------------------------------------------------------------


def _load(name: str) -> tuple[Design, Mechanism]:
    from kinematics.designs import load_design
    from kinematics.mechanism import mechanism

    design = load_design(name)
    return design, mechanism(design.mechanism)


def _warn(design: Design, mechanism: Mechanism) -> None:
    """Say on stderr what is wrong with a design that is valid all the same."""
    for finding in mechanism.findings(design):
        if finding.severity == "warning":
            print(f"bohemia: warning: {finding.title}: {finding.text}", file=sys.stderr)


@contextmanager
def _progress(what: str) -> Iterator[None]:
    """Name the work on stderr while it lasts, if a person is looking."""
    shown = sys.stderr.isatty()
    if shown:
        print(f"{what} …", end="", file=sys.stderr, flush=True)
    try:
        yield
    finally:
        if shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def _checked(path: Path, kind: str) -> str:
    """Refuse, before any work, a file that cannot be written."""
    if path.is_dir():
        raise InputError(f"cannot write {str(path)!r}: it is a folder")
    if not path.parent.is_dir():
        raise InputError(f"cannot write {str(path)!r}: there is no folder {str(path.parent)!r}")
    return kind


def _write(path: Path, data: bytes) -> None:
    try:
        path.write_bytes(data)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"cannot write {str(path)!r}: {why}") from None


def _finite(value: float) -> float | None:
    """JSON has no infinity."""
    return float(value) if isfinite(value) else None


def _print_head(design: Design, *lines: str) -> None:
    print(f"{design.name}: {design.title}", *lines, sep="\n")


def _print_json(answer: dict[str, Any]) -> None:
    print(json.dumps(answer, allow_nan=False))
