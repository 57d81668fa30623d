"""The places where one operator, sign, index or number can be changed, for `mutants.py`.

Numbers below `TINY` are left alone: tolerances have no right value, but bounds of proofs have tests
of their own.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DECIDES = ("state.py", "compute.py", "part.py", "files.py", "command.py", "playing.py")
ROOMS = ("app/review", "app/jobs", "app/terminal", "app/loop.py", "app/cli.py")
TINY = 1e-3

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
    whole: tuple[int, int]
    """Bytes of the expression that changes."""
    used: tuple[str, ...]
    """Empty where the place runs when it is called; else what carries its value on: the names that
    are given it when the module is loaded, or the function whose default it is."""

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

    def visit(node: ast.AST, where: str, used: tuple[str, ...] | None) -> Iterator[Mutant]:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            where = f"{where}.{node.name}".lstrip(".")
        elif used is None and isinstance(node, ast.Assign | ast.AnnAssign):
            given = node.targets if isinstance(node, ast.Assign) else [node.target]
            used = tuple(n.id for each in given for n in ast.walk(each) if isinstance(n, ast.Name))
        whole = (
            at(getattr(node, "lineno", 1), getattr(node, "col_offset", 0)),
            at(getattr(node, "end_lineno", 1), getattr(node, "end_col_offset", 0)),
        )
        for start, end, new in changes(node):
            line = text.count(b"\n", 0, start) + 1
            snippet = text[starts[line - 1] : starts[line]].decode().strip()
            old, to = text[start:end].decode(), used or ()
            told = f"{old} in `{snippet}`"
            yield Mutant(name, line, start, end, new, where, told, whole, to)
        for child in children(node):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and used != ():
                yield from visit(child, where, (node.name,) if child is node.args else ())
            else:
                yield from visit(child, where, used)

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
            if text[start:end] != repr(value).encode() and not _says(text[start:end], value):
                return  # within an f-string, whose places Python does not tell
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

    return visit(ast.parse(text), "", None)


def _says(text: bytes, value: object) -> bool:
    try:
        return bool(ast.literal_eval(text.decode()) == value)
    except (ValueError, SyntaxError, UnicodeDecodeError):
        return False


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
