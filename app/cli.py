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
from math import degrees, isfinite, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from kinematics.errors import BohemiaError, ComputationError, InputError

if TYPE_CHECKING:
    from kinematics.mechanism import Coordinate, Design, Mechanism
    from kinematics.solids import BuiltSolid
    from kinematics.solutions import Posture, Reason

DEFAULT_DESIGN = "rpur-table1"

# Their values may begin with a minus sign, which argparse takes for an option.
SIGNED_OPTIONS = frozenset({"--pose", "--phi", "--theta", "--modes"})

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


def _pose(text: str, axes: Sequence[Coordinate]) -> list[float]:
    """The numbers as typed, mm and degrees, one for each coordinate."""
    words = text.split(",")
    wanted = ", ".join(f"{axis.symbol} ({_unit(axis)})" for axis in axes)
    if len(words) != len(axes):
        raise InputError(
            f"--pose needs {len(axes)} numbers with commas between them, {wanted}; got {len(words)}"
        )
    return [_number(word, f"--pose: {axis.symbol}") for word, axis in zip(words, axes, strict=True)]


def _modes(text: str, known: tuple[str, ...]) -> tuple[str, ...] | None:
    """The working modes asked for, in the mechanism's order; None for all of them."""
    if text.strip().lower() == "all":
        return None
    chosen: set[str] = set()
    for word in text.replace("−", "-").split(","):
        pattern = word.strip()
        matching = {mode for mode in known if _matches(mode, pattern)}
        if not matching:
            raise InputError(
                f"--modes: {pattern!r} is not a working mode; it is one sign for each of the "
                f"{len(known[0])} limbs, as {known[-2]}, with ? for either sign, or 'all'"
            )
        chosen |= matching
    return None if len(chosen) == len(known) else tuple(mode for mode in known if mode in chosen)


def _matches(mode: str, pattern: str) -> bool:
    return len(mode) == len(pattern) and all(
        p in {"?", sign} for sign, p in zip(mode, pattern, strict=True)
    )


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
    _print_table(("name", "mechanism", "title", "source"), rows)


def _ik(arguments: argparse.Namespace) -> None:
    design, mechanism = _load(arguments.design)
    axes = mechanism.pose_coordinates(design)
    typed = _pose(arguments.pose, axes)
    pose = [_inner(value, axis) for value, axis in zip(typed, axes, strict=True)]
    postures = [mechanism.posture(design, pose, mode) for mode in mechanism.modes]
    closing = [posture for posture in postures if posture.closes]
    reachable = any(posture.reachable for posture in postures)
    nearest = min(postures, key=_miss)
    reasons = [] if reachable else [reason.text for reason in nearest.reasons]
    _warn(design, mechanism)
    joints = mechanism.joint_coordinates(design)
    if not arguments.json:
        _print_ik(design, axes, typed, joints, closing, reachable, nearest)
        return
    transform = mechanism.transform(design, pose).tolist()
    _print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "pose": {_key(axis): value for axis, value in zip(axes, typed, strict=True)},
            "transform": transform,
            "reachable": reachable,
            "reasons": reasons,
            "solutions": [
                {
                    "working_mode": posture.mode,
                    "joints": _outer(posture.joints, joints),
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
        _print_solid(design, spec.title, arguments, built, modes if spec.uses_modes else ())
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


def _print_json(answer: dict[str, Any]) -> None:
    print(json.dumps(answer, allow_nan=False))


def _unit(axis: Coordinate) -> str:
    return "degrees" if axis.unit == "rad" else axis.unit


def _key(axis: Coordinate) -> str:
    return f"{axis.key}_deg" if axis.unit == "rad" else axis.key


def _inner(value: float, axis: Coordinate) -> float:
    return radians(value) if axis.unit == "rad" else value


def _outer(values: Sequence[float], axes: Sequence[Coordinate]) -> list[float]:
    """Joints as people read them: mm, and degrees for rad."""
    return [
        degrees(value) if axis.unit == "rad" else value
        for value, axis in zip(values, axes, strict=True)
    ]


def _with_unit(value: float, axis: Coordinate) -> str:
    return f"{axis.symbol} = {value:g}°" if axis.unit == "rad" else f"{axis.symbol} = {value:g} mm"


def _print_ik(
    design: Design,
    axes: Sequence[Coordinate],
    typed: Sequence[float],
    joints: Sequence[Coordinate],
    closing: Sequence[Posture],
    reachable: bool,
    nearest: Posture,
) -> None:
    print(f"{design.name}: {design.title}")
    print("Pose " + ", ".join(_with_unit(v, axis) for v, axis in zip(typed, axes, strict=True)))
    if closing:
        print()
        header = ["mode", *(f"{j.symbol} ({_unit(j)})" for j in joints), "within its stroke"]
        symbols = {joint.limb: joint.symbol for joint in joints}
        rows = [
            (
                posture.mode,
                *(f"{joint:.4f}" for joint in _outer(posture.joints, joints)),
                ", ".join(_beyond(reason, symbols) for reason in posture.reasons) or "yes",
            )
            for posture in closing
        ]
        _print_table(header, rows)
    print()
    if reachable:
        count = sum(posture.reachable for posture in closing)
        print(f"Reachable in {count} of {len(closing)} working modes.")
        return
    where = "" if not closing else f" The nearest working mode is {nearest.mode}:"
    print(f"Not reachable in any working mode.{where}")
    for reason in nearest.reasons:
        print(f"  {reason.text}")


def _beyond(reason: Reason, symbols: dict[int | None, str]) -> str:
    """A reason short enough for a table: "ρ₃ 40.3 too long"."""
    direction = "too short" if reason.bound == "rho_min" else "too long"
    return f"{symbols.get(reason.limb, f'limb {reason.limb}')} {reason.amount:.1f} {direction}"


def _print_solid(
    design: Design,
    title: str,
    arguments: argparse.Namespace,
    built: BuiltSolid,
    modes: tuple[str, ...] | None,
) -> None:
    print(f"{design.name}: {design.title}")
    where = f"at φ = {arguments.phi:g}°, θ = {arguments.theta:g}°, {arguments.resolution}"
    if modes is None:
        where += ", all working modes"
    elif modes:
        where += f", working mode {', '.join(modes)}"
    print(f"{title} {where}")
    print(f"volume     {_volume(built.volume)} ± {_volume(built.volume_error)}")
    pieces = ", ".join(_volume(piece.volume) for piece in built.pieces)
    print(f"pieces     {len(built.pieces)}" + (f": {pieces}" if len(built.pieces) > 1 else ""))
    print(f"triangles  {built.triangles}" + ("" if built.watertight else ", not watertight"))
    if arguments.output is not None:
        print(f"file       {arguments.output} (mm, base coordinates)")


def _volume(value: float) -> str:
    number = f"{value:,.0f}".replace(",", "\u202f") if value >= 100 else f"{value:.3g}"
    return f"{number} mm³"


def _print_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    for row in (header, *rows):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        print(line.rstrip())
