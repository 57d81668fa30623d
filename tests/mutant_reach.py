"""Which tests run through the places of mutants, for `mutants.py`.

In a copy of the checkout each place says that it ran: ``a + b`` becomes ``(__hit__(7) or a + b)``,
which costs nothing elsewhere. Processes that a test starts say so too. What only runs when a module
is loaded counts as run where a function mentions what it gave a value to; the compiled kernel's
lines say nothing, so that its callers speak for them.
"""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

from mutant_sites import ROOT, Mutant, files

KERNEL = ("sweep", "quadrature", "measures", "boundary", "integral")
KERNEL_FOLDER = "kinematics/mechanisms/five_rpur/slicing"
KERNEL_CALLS = (f"{KERNEL_FOLDER}/acceleration.py", "call")


@dataclass
class Ran:
    """What the tests of a file ran through.

    ``sites``: of each mutant's key the tests; ``seconds`` that each test of the file took, of
    processors, without those that fail as it is.
    """

    sites: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    seconds: dict[str, float] = field(default_factory=dict)


def copied(to: Path) -> Path:
    """A copy of the checkout without what is only kept."""
    without = shutil.ignore_patterns(".*", "__pycache__")
    shutil.copytree(ROOT, to, ignore=without)
    return to


def is_kernel(file: str) -> bool:
    """Whether a file is compiled."""
    return Path(file).stem in KERNEL and file.startswith(KERNEL_FOLDER)


def instrumented(copy: Path, sites: list[Mutant]) -> None:
    """Have each place say that it runs."""
    inserted: dict[str, list[tuple[int, int, bytes]]] = defaultdict(list)
    trees = {name: ast.parse((ROOT / name).read_bytes()) for name in files()}
    for n, site in enumerate(sites):
        if is_kernel(site.file):
            _at_functions(inserted, trees, n, (KERNEL_CALLS[1],), KERNEL_CALLS[0])
            continue
        if site.used:
            alone = site.file if site.used[0].startswith("_") or "." in site.where else ""
            _at_functions(inserted, trees, n, site.used, alone)
        start, end = site.whole
        text = (ROOT / site.file).read_bytes()
        here = f"(__hit__({n}) or ".encode()
        try:
            compile(text[:start] + here + text[start:end] + b")" + text[end:], site.file, "exec")
        except SyntaxError:
            continue
        inserted[site.file] += [(start, -end, here), (end, -start, b")")]
    for name, places in inserted.items():
        text = (ROOT / name).read_bytes()
        for at, _, new in sorted(places, key=lambda p: (p[0], p[2] != b")", p[1]), reverse=True):
            text = text[:at] + new + text[at:]
        (copy / name).write_bytes(text)
    for package in ("kinematics", "app"):
        place = copy / package / "__init__.py"
        text = place.read_bytes()
        kept = [s for s in ast.parse(text).body if _comes_first(s)]
        lines = text.splitlines(keepends=True)
        last = max((s.end_lineno or 0 for s in kept), default=0)
        place.write_bytes(b"".join([*lines[:last], b"import mutant_seen\n", *lines[last:]]))


def _comes_first(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.ImportFrom):
        return statement.module == "__future__"
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _at_functions(
    inserted: dict[str, list[tuple[int, int, bytes]]],
    trees: dict[str, ast.Module],
    site: int,
    names: tuple[str, ...],
    only: str,
) -> None:
    """At the beginning of every function that has or mentions one of the names."""
    for file, tree in trees.items():
        if (only and file != only) or is_kernel(file):
            continue
        text = (ROOT / file).read_bytes()
        lines = text.splitlines(keepends=True)
        for node in ast.walk(tree):
            if not isinstance(node, ast.FunctionDef) or not (
                node.name in names or any(_mentions(each, names) for each in node.body)
            ):
                continue
            first = next((s for s in node.body if not _comes_first(s)), None)
            if first is not None and first.lineno > node.lineno:
                decorated = getattr(first, "decorator_list", None)
                line = decorated[0].lineno if decorated else first.lineno
                at = sum(map(len, lines[: line - 1]))
                new = f"{' ' * first.col_offset}__hit__({site})\n".encode()
                inserted[file].append((at, 0, new))


def _mentions(statement: ast.stmt, names: tuple[str, ...]) -> bool:
    return any(
        (isinstance(node, ast.Name) and node.id in names)
        or (isinstance(node, ast.Attribute) and node.attr in names)
        for node in ast.walk(statement)
    )


def run_through(copy: Path, sites: list[Mutant], modules: list[str]) -> dict[str, Ran]:
    """Runs files of tests in an instrumented copy; of each, what it ran through."""
    hits, tests = copy / "hits", copy / "tests.jsonl"
    hits.unlink(missing_ok=True)
    tests.unlink(missing_ok=True)
    shutil.copy(Path(__file__).with_name("mutant_seen.py"), copy)
    options = ["-q", "-p", "no:cacheprovider", "-p", "mutant_seen", "-n", "0", "--timeout=0"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *modules],
        cwd=copy,
        env={**environment(copy), "MUTANT_HITS": str(hits), "MUTANT_TESTS": str(tests)},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1):
        print(done.stdout[-2000:], done.stderr[-2000:], sep="\n")
    found = {module: Ran() for module in modules}
    failed = set()
    for line in tests.read_text().splitlines() if tests.exists() else ():
        test, seconds = json.loads(line)
        if seconds is None:
            failed.add(test)
        else:
            found[test.split("::")[0]].seconds[test] = seconds
    for test in failed:
        print(f"fails as it is, and is left out: {test}")
        found[test.split("::")[0]].seconds.pop(test, None)
    for line in sorted(set(hits.read_text().splitlines())) if hits.exists() else ():
        site, said = line.split("\t", 1)
        test, _, phase = said.rpartition(" ")
        module = test.split("::")[0]
        if module not in found:  # while modules were loaded
            continue
        every = found[module].seconds
        ran = list(every) if phase == "(setup)" else [test] if test in every else []
        known = found[module].sites[sites[int(site)].key]
        known += [each for each in ran if each not in known]
    return found


def environment(copy: Path) -> dict[str, str]:
    """Of tests in a copy: its modules, a cache of its own, the same examples every time."""
    paths = os.pathsep.join([str(copy), *filter(None, [os.environ.get("PYTHONPATH")])])
    cache = str(copy.parent / "cache")
    return {**os.environ, "PYTHONPATH": paths, "XDG_CACHE_HOME": cache, "CI": "1"}
