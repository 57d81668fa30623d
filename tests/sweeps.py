"""Many designs, files and commands drawn at random, from the usual to the absurd: `make sweeps`.

    python -m tests.sweeps designs 0 10000      designs, each with an orientation
    python -m tests.sweeps files 0 2000         design files, paths and sessions broken in some way
    python -m tests.sweeps commands 0 2000      command lines with hostile values

Nothing is written for a mechanism: designs are those of the presets with numbers changed, whatever
the numbers mean. Whoever is refused must be refused with a sentence. Each number of a sweep is its
own seed, so that what fails can be repeated alone.
"""

from __future__ import annotations

import contextlib
import io
import random
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import kinematics as kin
from kinematics.designs.files import _value, load_design
from kinematics.facets.solids import RESOLUTIONS
from tests.kinematics.mechanisms.five_rpur.nearly_equal import closed

LONGEST = 20.0
"""s of processor time that anything may take."""


class Hangs(Exception):
    """It took longer than `LONGEST`."""


# --- designs -------------------------------------------------------------------------------

FAMILIES = ("drawn", "round", "alike", "nearly alike", "thin", "zeros", "far", "usual", "doubled")


@dataclass(frozen=True)
class Drawn:
    """A design file, what kind of change made it, and the seed of what is asked of it."""

    seed: int
    preset: str
    family: str
    scale: float
    text: str

    def __str__(self) -> str:
        return f"{self.seed} {self.preset} {self.family} ×{self.scale:g}"


def drawn(seed: int) -> Drawn:
    """A design made of a preset by changing its numbers."""
    r = random.Random(seed)
    names = sorted({preset.mechanism for preset in kin.presets()})
    kind = names[seed % len(names)]
    preset = r.choice([each.name for each in kin.presets() if each.mechanism == kind])
    family = FAMILIES[seed // len(names) % len(FAMILIES)]
    scale = 10.0 ** r.choice([0, 0, 0, 0, -6, -3, 3, 6, r.uniform(-6.0, 6.0)])
    table = _table(preset)
    little = 10.0 ** r.uniform(-12.0, -3.0)

    def number(value: float, key: str) -> float:
        changed = {
            "drawn": lambda: value * r.uniform(0.3, 1.7) + r.uniform(-30.0, 30.0),
            "round": lambda: round(value * r.uniform(0.5, 1.5), -1),
            "alike": lambda: value,
            "nearly alike": lambda: value * (1.0 + little * r.uniform(-1.0, 1.0)),
            "thin": lambda: value * r.uniform(0.7, 1.3),
            "zeros": lambda: 0.0 if r.random() < 0.3 else value,
            "far": lambda: value * 10.0 ** r.choice([0, 0, 0, 0, -3, 3]),
            "usual": lambda: value * r.uniform(0.9, 1.1),
            "doubled": lambda: value * r.choice([0.5, 1.0, 1.0, 2.0]),
        }[family]()
        return float(changed) * (1.0 if "deg" in key or "axis" in key else scale)

    def visit(value: Any, key: str) -> Any:
        if isinstance(value, dict):
            return {name: visit(each, name) for name, each in value.items()}
        if isinstance(value, bool | str | int):
            return value
        if isinstance(value, float):
            return number(value, key)
        made = [visit(each, key) for each in value]
        if _is_range(made, key):
            low, high = sorted(made)
            made = [low, low + (high - low) * little if family == "thin" else high]
        return made

    changed = visit(table, "")
    for key, entries in changed.items():
        if family in ("alike", "nearly alike") and _are_limbs(entries):
            first = table[key][0]
            count = r.randint(1, len(entries))
            for place in r.sample(range(len(entries)), count):
                entries[place] = visit(first, "")
            changed[key] = entries
    return Drawn(seed, preset, family, scale, _written(changed))


@cache
def _table(preset: str) -> dict[str, Any]:
    return kin.open(preset).table


def _is_range(values: list[Any], key: str) -> bool:
    named = any(word in key for word in ("stroke", "range", "travel"))
    return named and len(values) == 2 and all(isinstance(v, float) for v in values)


def _are_limbs(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 1 and isinstance(value[0], dict)


def _written(table: dict[str, Any]) -> str:
    plain = [f"{key} = {_value(v)}" for key, v in table.items() if not _are_limbs(v)]
    blocks = [
        "\n".join([f"[[{key}]]", *(f"{k} = {_value(v)}" for k, v in entry.items())])
        for key, entries in table.items()
        if _are_limbs(entries)
        for entry in entries
    ]
    return "\n".join(plain) + "\n\n" + "\n\n".join(blocks) + "\n"


def wrong_design(seed: int) -> Iterator[str]:
    """What is wrong with the answers for a design."""
    this = drawn(seed)
    try:
        machine = kin.read(this.text, origin="the design")
    except kin.DesignError:
        return
    yield from _asked(this, "postures", lambda: _wrong_postures(machine, seed))
    yield from _asked(this, "workspace", lambda: _wrong_workspace(machine, seed))


def _asked(this: Drawn, what: str, ask: Callable[[], Iterator[str]]) -> Iterator[str]:
    began = time.process_time()
    try:
        with limited():
            for said in ask():
                yield f"{this}, {what}: {said}"
    except Hangs:
        yield f"{this}, {what}: no end within {LONGEST:g} s, at {_where()}"
    except (kin.InputError, kin.ComputationError) as error:
        Refused.said[f"{what}: {' '.join(str(error).split())[:60]}"] += 1
    except Exception as error:  # noqa: BLE001 (whatever it is, it is a fault)
        yield f"{this}, {what}: {type(error).__name__} {error} at {_where()}"
    Slowest.seconds = max(Slowest.seconds, time.process_time() - began)


class Refused:
    said: Counter[str] = Counter()


class Slowest:
    seconds = 0.0


def _where() -> str:
    trace = traceback.extract_tb(sys.exc_info()[2])
    ours = [
        frame for frame in trace if "/kinematics/" in frame.filename or "/app/" in frame.filename
    ]
    last = (ours or trace)[-1]
    return f"{'/'.join(Path(last.filename).parts[-3:])}:{last.lineno}"


def _wrong_postures(machine: kin.Machine[Any], seed: int) -> Iterator[str]:
    """IK of poses about home; FK of what it gives knows the pose."""
    r = np.random.default_rng(seed)
    home, length = machine.home, machine.length
    units = np.array([length if c.unit == "mm" else 1.0 for c in machine.coordinates])
    poses = np.array(home.pose) + r.normal(size=(16, len(units))) * units * 0.2
    found = machine.inverse(poses)
    if not np.isfinite(found.joints[found.within_stroke]).all():
        yield "a joint is no number where a mode holds the pose"
    machine.singularities.at(home, 1e-3)
    if not home.reachable or home.joints is None:
        return
    solutions = machine.forward(home.joints)
    if not solutions.complete:
        return
    apart = min(
        (
            np.abs((machine.transform(p, m) - machine.transform(home.pose, home.mode))).max()
            for p, m in zip(solutions.poses, solutions.modes, strict=True)
        ),
        default=np.inf,
    )
    if apart > 1e-6 * max(length, *map(abs, home.joints)):
        yield f"complete, and the pose that the joints are of is not among them ({apart:g})"


def _wrong_workspace(machine: kin.Machine[Any], seed: int) -> Iterator[str]:
    """Solids are closed; volumes at two resolutions and of exact sections agree."""
    r = np.random.default_rng(seed)
    if machine.solids is None:
        if machine.regions is not None:
            area = machine.workspace().section().area
            if not area >= 0.0:
                yield f"area {area:g}"
        return
    turns = [c.key for c in machine.coordinates if c.unit == "rad"]
    held = {} if r.random() < 0.3 else {key: float(r.uniform(-np.pi, np.pi)) for key in turns}
    if machine.dependent:
        held = dict(list(held.items())[:2])
    one = any(s.of_present_mode for s in machine.solid_specs) or r.random() < 0.5
    modes = str(machine.modes[int(r.integers(len(machine.modes)))]) if one else None
    if not modes:
        modes = None
    try:
        space = machine.workspace(modes, **held)
    except kin.InputError:
        space = machine.workspace(modes)
    key = next((s.key for s in machine.solid_specs if s.key.startswith("workspace")), None)
    if key is None:
        return
    volumes = []
    for resolution in RESOLUTIONS[:2]:
        built = space.solid(resolution, key=key).built
        if not built.watertight or not closed(built.mesh.vertices, built.mesh.faces):
            yield f"{resolution} leaks"
        volumes.append((resolution, built.volume, built.volume_error))
    if machine.sections is not None:
        exact = space.volume(1e-4)
        volumes.append(("exact", exact.value, exact.error))
    for name, value, error in volumes[:-1]:
        other, right, margin = volumes[-1]
        if not abs(value - right) <= error + margin + 1e-9 * max(abs(value), abs(right)):
            yield f"{name} {value:g} ± {error:g}, {other} {right:g} ± {margin:g}"
    name, value, error = volumes[1]
    if value > 0.0 and not error <= 0.05 * value:
        Refused.said[f"{name} {machine.kind}: error above 5 % of the volume"] += 1


# --- files and commands ---------------------------------------------------------------------


def wrong_file(seed: int) -> Iterator[str]:
    """What is wrong with how a broken file is read."""
    r = random.Random(seed)
    kind = ("design", "path", "session")[seed % 3]
    text = broken(_whole(kind, r), r)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / {"design": "d.toml", "path": "p.csv", "session": "s.json"}[kind]
        file.write_bytes(text)
        arguments = {
            "design": ["ik", str(file), "--pose", "0,0,0,0,0"],
            "path": ["trajectory", "five-bar", str(file), "--samples", "3"],
            "session": ["serve", "--session", str(file), "--port", "1"],
        }[kind]
        if kind != "session":
            yield from _run(seed, arguments)
            return
        from app.review import session

        try:
            with limited():
                session.load(file)
        except (kin.InputError, kin.ComputationError):
            pass
        except Exception as error:  # noqa: BLE001
            yield f"{seed} session: {type(error).__name__} {error} at {_where()}"


def _whole(kind: str, r: random.Random) -> bytes:
    if kind == "design":
        return kin.write(kin.open(r.choice(kin.presets()).name)).encode()
    if kind == "path":
        rows = [f"{k * 0.5},{r.uniform(-60, 60):.3f},{r.uniform(240, 300):.3f}" for k in range(6)]
        return ("t,x,y\n" + "\n".join(rows) + "\n").encode()
    from app.review import session
    from app.review.state import new_review

    return session.to_text(new_review(load_design(r.choice(kin.presets()).name))).encode()


HOSTILE = (
    b"", b"\0", b"\xff\xfe", b"nan", b"inf", b"-inf", b"1e400", b"9" * 400, b"[" * 3000,
    b"{" * 3000, b"\"", b"'''", b"=", b",", b";", b"\r", b"\r\n", b"\t", b"\xe2\x88\x92",
    b"a.a.a.a.a.a" * 200, b"-0.0", b"1e-320", b"#", b"sep=;\n", b"true", b"[[limb]]\n", b"''",
    b"x" * 140_000, b"1_0", b"0x1", b"\xf0\x9f\x98\x80", b"..", b"mechanism=1\n", b"null",
)  # fmt: skip


def broken(text: bytes, r: random.Random) -> bytes:
    """A text with one to four of its places changed."""
    for _ in range(r.randint(1, 4)):
        at, to = sorted(r.randrange(len(text) + 1) for _ in range(2))
        how = r.randrange(7)
        if how == 0:
            text = text[:at] + r.choice(HOSTILE) + text[at:]
        elif how == 1:
            text = text[:at] + r.choice(HOSTILE) + text[to:]
        elif how == 2:
            text = text[:at]
        elif how == 3:
            text = text[:to] + text[at:]
        elif how == 4:
            text = text.replace(b"\n", r.choice([b"\r", b"\r\n", b"\n\n", b" "]))
        elif how == 5:
            digits = [k for k, c in enumerate(text) if 48 <= c < 58]
            if digits:
                k = r.choice(digits)
                text = text[:k] + r.choice(HOSTILE) + text[k + 1 :]
        else:
            text = r.choice([text.decode("latin1").encode("utf-16"), b"\xef\xbb\xbf" + text])
    return text


VALUES = (
    "nan", "inf", "-inf", "1e400", "-1e300", "1e-320", "0", "-0", "", " ", ",", ",,", "1,2", "-",
    "--", "+++++", "?", "all", "9" * 400, "1:2", "1:2:0", "1:2:-1", "0:1:999999999999", "::", "é",
    "−5", "5,5", "/dev/null", "/", ".", "..", "no/such", "a" * 5000, "1;2", "0,0,0,0,0",
    "0,0,450,0,0", "1e9,1e9,1e9,1e9,1e9", "0,0,650,0,0,-", "true", "[]", "{}", "%s", "\n",
)  # fmt: skip


def wrong_command(seed: int) -> Iterator[str]:
    """What is wrong with how a command takes hostile values."""
    from app.cli import bohemia

    r = random.Random(seed)
    names = sorted(set(bohemia.list_commands(None)) - {"serve", "map"})  # type: ignore[arg-type]
    name = r.choice(names)
    command = bohemia.get_command(None, name)  # type: ignore[arg-type]
    arguments = [name]
    preset = r.choice(kin.presets()).name
    if any(each.name == "machine" for each in command.params) and r.random() < 0.97:
        arguments.append(preset if r.random() < 0.9 else r.choice(VALUES))
    options = [o for o in command.params if o.param_type_name == "option" and o.name != "help"]
    for each in options:
        flag, usual = getattr(each, "is_flag", False), _usual(each.opts[-1], preset, r)
        if "output" in (each.name or "") or r.random() < 0.6:
            continue
        arguments.append(each.opts[-1])
        if not flag:
            arguments.append(r.choice(VALUES) if usual is None or r.random() < 0.3 else usual)
    if r.random() < 0.1:
        arguments.append(r.choice(VALUES))
    yield from _run(seed, arguments)


def _usual(option: str, preset: str, r: random.Random) -> str | None:
    """What a person may write, some of it far from where a machine can be."""
    machine = _machine(preset)
    axes = {"--pose": machine.coordinates, "--joints": machine.joints}.get(option)
    if axes is not None:
        home = machine.home.pose if option == "--pose" else machine.home.joints
        spread = 10.0 ** r.uniform(-12.0, 2.0)
        moved = [
            v + r.gauss(0.0, spread) * (1.0 if a.unit == "mm" else 0.01)
            for v, a in zip(home, axes, strict=True)
        ]
        return ",".join(repr(a.outer(v)) for v, a in zip(moved, axes, strict=True))
    return {
        "--mode": r.choice([machine.home.mode, "home"]),
        "--modes": r.choice([machine.home.mode, "home", "all"]),
        "--resolution": "preview",
        "--load": "0,0,-10,0,5,0",
        "--rates": ",".join(["1"] * len(machine.coordinates)),
        "--joint-rates": ",".join(["1"] * len(machine.joints)),
        "--limb": r.choice(["1", "2", "7"]),
        "--samples": r.choice(["2", "3", "50"]),
        "--phi": str(r.uniform(-200.0, 200.0)),
        "--theta": str(r.choice([0.0, 90.0, r.uniform(-200.0, 200.0)])),
        "--x": str(r.uniform(-500.0, 500.0)),
        "--tolerance": r.choice(["1e-3", "1e-2", "0.1"]),
    }.get(option)


@cache
def _machine(preset: str) -> kin.Machine[Any]:
    return kin.open(preset)


def _run(seed: int, arguments: list[str]) -> Iterator[str]:
    from app import cli

    out, err = io.StringIO(), io.StringIO()
    shown = " ".join(a[:40] for a in arguments)
    began = time.process_time()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), limited():
            code = cli.main(arguments)
    except Hangs:
        yield f"{seed} {shown}: no end within {LONGEST:g} s"
        return
    except BaseException as error:  # noqa: BLE001
        yield f"{seed} {shown}: {type(error).__name__} {error} at {_where()}"
        return
    Slowest.seconds = max(Slowest.seconds, time.process_time() - began)
    said = err.getvalue().strip()
    if code not in (0, 1, 2) or (code == 2 and not said) or "Traceback" in said:
        yield f"{seed} {shown}: exit {code}, {said[-200:]!r}"
    if "Warning" in said or (code == 2 and len(said.splitlines()) > 2):
        yield f"{seed} {shown}: {said[:300]!r}"


@contextlib.contextmanager
def limited(seconds: float = LONGEST) -> Iterator[None]:
    """Ends what takes longer, where the system has such an alarm."""

    def late(*_: object) -> None:
        raise Hangs

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


SWEEPS = {"designs": wrong_design, "files": wrong_file, "commands": wrong_command}


def main(what: str, first: int, last: int) -> int:
    """Sweeps and prints what is wrong; how many faults."""
    began, found = time.process_time(), 0
    for seed in range(first, last):
        for line in SWEEPS[what](seed):
            print(line, flush=True)
            found += 1
    took = time.process_time() - began
    print(f"{last - first} {what} in {took:.0f} s, {found} faults; slowest {Slowest.seconds:.1f} s")
    for said, count in Refused.said.most_common(12):
        print(f"  {count} × {said}")
    return found


if __name__ == "__main__":
    load_design("five-bar")
    sys.exit(1 if main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])) else 0)
