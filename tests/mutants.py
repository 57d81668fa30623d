"""Whether the tests notice a wrong operator: `make mutants`.

One operator, sign, index or number of `kinematics` or of what `app` decides (not what it draws)
is changed at a time, and the tests that run through its line are run, the nearest and quickest
first. Sites are drawn by a seed, so that a sample can be repeated; which tests run through which
line is measured once and kept in `.mutants` until the code or the tests change. Numbers below
`TINY` are left alone: tolerances have no right value, but bounds of proofs have tests of their own.

A changed program that gives the same answers is no fault of the tests. Those are listed in
`mutants_equal.toml`, each with the reason.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / ".mutants"
EQUAL = Path(__file__).with_name("mutants_equal.toml")
TESTS = ("tests/kinematics", "tests/conformance", "tests/app")
DECIDES = ("state.py", "compute.py", "part.py", "files.py", "command.py", "playing.py")
ROOMS = ("app/review", "app/jobs", "app/terminal", "app/loop.py", "app/cli.py")
KERNEL = ("sweep", "quadrature", "measures", "boundary", "integral")
"""Compiled, so that no line of theirs is seen to run."""

TINY = 1e-3
SECONDS = (60.0, 300.0)  # of tests for a mutant, and for one that these did not notice
PATIENCE = 10.0  # times as long as the tests take; then the mutant hangs, which is noticed

COMPARED = {
    ast.Lt: ("<", ">="),
    ast.LtE: ("<=", ">"),
    ast.Gt: (">", "<="),
    ast.GtE: (">=", "<"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
COMPUTED = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
}
CALLED = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"} | {
    "any": "all",
    "all": "any",
    "argmin": "argmax",
    "argmax": "argmin",
    "floor": "ceil",
    "ceil": "floor",
    "sin": "cos",
    "cos": "sin",
}
WITHOUT_EFFECT = {"strict", "frozen", "slots", "eq", "maxsize", "copy", "daemon", "stacklevel"}


@dataclass(frozen=True, order=True)
class Mutant:
    """One change: the bytes from ``start`` to ``end`` of a file become ``text``."""

    file: str
    line: int
    start: int
    end: int
    text: str
    where: str
    before: str

    @property
    def key(self) -> str:
        """What it is called where those that change nothing are listed."""
        return f"{self.file}: {self.where}: {self.before} -> {self.text}"


# --- sites ---------------------------------------------------------------------------------


def files() -> list[str]:
    """The files whose logic is tried."""
    every = sorted((ROOT / "kinematics").rglob("*.py")) + sorted((ROOT / "app").rglob("*.py"))
    names = [file.relative_to(ROOT).as_posix() for file in every]
    return [
        name
        for name in names
        if name.startswith(("kinematics/", *ROOMS))
        or (name.startswith("app/features/") and name.endswith(DECIDES))
    ]


def mutants_of(name: str) -> Iterator[Mutant]:
    """All changes to a file."""
    text = (ROOT / name).read_bytes()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def at(line: int | None, column: int | None) -> int:
        return starts[(line or 1) - 1] + (column or 0)

    def visit(node: ast.AST, where: str) -> Iterator[Mutant]:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            where = f"{where}.{node.name}".lstrip(".")
        for start, end, new in changes(node):
            line = text.count(b"\n", 0, start) + 1
            snippet = text[starts[line - 1] : starts[line]].decode().strip()
            old = text[start:end].decode()
            yield Mutant(name, line, start, end, new, where, f"{old} in `{snippet}`")
        for child in children(node):
            yield from visit(child, where)

    def between(left: ast.expr, right: ast.expr, old: str, new: str) -> Iterator[tuple]:
        start = at(left.end_lineno, left.end_col_offset)
        gap = text[start : at(right.lineno, right.col_offset)]
        place = gap.find(old.encode())
        if place >= 0 and b"#" not in gap:
            yield start + place, start + place + len(old), new

    def changes(node: ast.AST) -> Iterator[tuple]:
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            for operator, left, right in zip(node.ops, sides, sides[1:], strict=False):
                if type(operator) in COMPARED:
                    yield from between(left, right, *COMPARED[type(operator)])
        elif isinstance(node, ast.BinOp) and type(node.op) in COMPUTED:
            yield from between(node.left, node.right, *COMPUTED[type(node.op)])
        elif isinstance(node, ast.BoolOp):
            old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
            yield from between(node.values[0], node.values[1], old, new)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            start = at(node.lineno, node.col_offset)
            yield start, start + (4 if isinstance(node.op, ast.Not) else 1), ""
        elif isinstance(node, ast.Call):
            called = node.func
            last = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
            if last in CALLED:
                end = at(called.end_lineno, called.end_col_offset)
                yield end - len(last), end, CALLED[last]
        elif isinstance(node, ast.Constant) and not isinstance(node.value, str | bytes | complex):
            start, end = at(node.lineno, node.col_offset), at(node.end_lineno, node.end_col_offset)
            value = node.value
            if isinstance(value, bool):
                yield start, end, str(not value)
            elif isinstance(value, int):
                yield start, end, str(value + 1)
            elif isinstance(value, float) and abs(value) >= TINY:
                yield start, end, repr(2.0 * value)

    def children(node: ast.AST) -> Iterator[ast.AST]:
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_params", "exc", "msg"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.keyword) and child.arg in WITHOUT_EFFECT:
                    continue
                if isinstance(child, ast.AST) and not _is_talk(child):
                    yield child

    return visit(ast.parse(text), "")


def _is_talk(node: ast.AST) -> bool:
    """What only names types, or writes to the log."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return True
    call = node.value if isinstance(node, ast.Expr) else None
    return isinstance(call, ast.Call) and ast.unparse(call.func).startswith(("log.", "warnings."))


def sample(seed: int, count: int, only: str) -> list[Mutant]:
    """Mutants drawn by their sites, all of the same chance."""
    every = [m for name in files() if name.startswith(only) for m in mutants_of(name)]
    return random.Random(seed).sample(every, min(count, len(every)))


# --- which tests ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Known:
    """Which tests run through each line, and how long they take.

    ``lines``: file → line → tests, "tests/…/test_x.py::test_y"; ``seconds`` of each test.
    """

    lines: dict[str, dict[str, list[str]]]
    seconds: dict[str, float]

    def tests(self, mutant: Mutant) -> list[str]:
        """Those that may notice a mutant, the nearest and quickest first."""
        found = self.lines.get(mutant.file, {}).get(str(mutant.line), [])
        if Path(mutant.file).stem in KERNEL and "slicing" in mutant.file:
            found = [test for test in self.seconds if "slicing" in test]
        folder = Path(mutant.file).parent.parts

        def far(test: str) -> float:
            shared = len(set(folder) & set(Path(test.split("::")[0]).parts))
            return self.seconds.get(test, 1.0) * 0.3**shared

        return sorted(found, key=far)


def known(jobs: int) -> Known:
    """Measured once for a state of code and tests."""
    digest = hashlib.sha256()
    for folder in ("kinematics", "app", "tests"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            digest.update(file.read_bytes())
    kept = KEPT / f"{digest.hexdigest()[:16]}.json"
    if not kept.exists():
        KEPT.mkdir(exist_ok=True)
        print("Which tests run through which line is measured first; this takes a while.")
        kept.write_text(json.dumps(measured(jobs)))
    found = json.loads(kept.read_text())
    return Known(found["lines"], found["seconds"])


def measured(jobs: int) -> dict[str, object]:
    """Runs all tests but those of the browser under coverage."""
    from coverage import CoverageData

    settings = KEPT / "coverage.ini"
    settings.write_text(
        f"[run]\ndynamic_context = test_function\nsource = {ROOT}/kinematics,{ROOT}/app\n"
        f"data_file = {KEPT}/data\nparallel = true\n"
    )
    for old in KEPT.glob("data*"):
        old.unlink()
    modules = sorted(
        file.relative_to(ROOT).as_posix()
        for folder in TESTS
        for file in (ROOT / folder).rglob("test_*.py")
    )

    def run(part: int) -> str:
        mine = modules[part::jobs]
        command = [sys.executable, "-m", "coverage", "run", f"--rcfile={settings}", "-m", "pytest"]
        options = ["-q", "-p", "no:cacheprovider", "--durations=0", "-vv", "-n", "0"]
        done = subprocess.run([*command, *options, *mine], cwd=ROOT, capture_output=True, text=True)
        return done.stdout

    with ThreadPoolExecutor(jobs) as pool:
        outputs = list(pool.map(run, range(jobs)))
    seconds: dict[str, float] = defaultdict(float)
    for line in "\n".join(outputs).splitlines():
        words = line.split()
        if len(words) >= 3 and words[1] in ("call", "setup") and words[0].endswith("s"):
            seconds[words[2].split("[")[0]] += float(words[0][:-1])
    functions = {_context(test): test for test in seconds}
    lines: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for file in KEPT.glob("data.*"):
        data = CoverageData(basename=str(file))
        data.read()
        for source in data.measured_files():
            name = Path(source).relative_to(ROOT).as_posix()
            for line, contexts in data.contexts_by_lineno(source).items():
                lines[name][str(line)] += [functions[c] for c in contexts if c in functions]
    return {"lines": lines, "seconds": seconds}


def _context(test: str) -> str:
    """A test as coverage names it."""
    file, *names = test.split("::")
    return ".".join([file.removesuffix(".py").replace("/", "."), *names])


# --- trying --------------------------------------------------------------------------------


def tried(mutant: Mutant, copy: Path, tests: list[str], seconds: dict[str, float]) -> str:
    """By what a mutant was noticed; "" if by nothing."""
    place = copy / mutant.file
    text = place.read_bytes()
    place.write_bytes(text[: mutant.start] + mutant.text.encode() + text[mutant.end :])
    try:
        for least, most in zip((0.0, *SECONDS), SECONDS, strict=False):
            chosen, total, passed = [], 0.0, 0.0
            for test in tests:
                each = seconds.get(test, 1.0)
                if passed >= least and (total + each <= most - least or not chosen):
                    chosen.append(test)
                    total += each
                passed += each
            if chosen and (said := _noticed(copy, chosen, total)):
                return said
        return ""
    finally:
        place.write_bytes(text)


def _noticed(copy: Path, tests: list[str], seconds: float) -> str:
    options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", "--tb=no", "-n", "0"]
    try:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *tests],
            cwd=copy,
            capture_output=True,
            text=True,
            timeout=60.0 + PATIENCE * seconds,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "it hangs"
    if done.returncode == 0:
        return ""
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].split(" - ")[0] if failed else f"exit {done.returncode}"


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", default="", help="what names of files begin with")
    parser.add_argument("--least", type=float, default=0.95, help="the part to be noticed")
    asked = parser.parse_args()
    equal: dict[str, str] = tomllib.loads(EQUAL.read_text())["equal"] if EQUAL.exists() else {}
    every = sample(asked.seed, asked.count, asked.only)
    map_ = known(asked.jobs)
    results: dict[Mutant, str] = {}
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(asked.jobs) as pool:
        copies: Queue[Path] = Queue()
        for n in range(asked.jobs):
            copy = Path(scratch) / str(n)
            without = shutil.ignore_patterns(".git", ".venv", ".mutants", "__pycache__", ".hyp*")
            shutil.copytree(ROOT, copy, ignore=without)
            copies.put(copy)

        def one(mutant: Mutant) -> None:
            if mutant.key in equal:
                results[mutant] = "equal"
                return
            copy = copies.get()
            try:
                results[mutant] = tried(mutant, copy, map_.tests(mutant), map_.seconds)
            finally:
                copies.put(copy)
            print(f"{len(results)}/{len(every)} {results[mutant] or 'NOT NOTICED'}: {mutant.key}")
            sys.stdout.flush()

        list(pool.map(one, every))
    missed = sorted(mutant for mutant, said in results.items() if not said)
    counted = [said for said in results.values() if said != "equal"]
    share = 1.0 - len(missed) / max(len(counted), 1)
    print(f"\n{len(counted) - len(missed)} of {len(counted)} noticed ({share:.1%})")
    print(f"{len(results) - len(counted)} change nothing, see {EQUAL.name}")
    for mutant in missed:
        print(f"  line {mutant.line} {mutant.key}")
    return 0 if share >= asked.least else 1


if __name__ == "__main__":
    sys.exit(main())
