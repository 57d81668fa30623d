"""Whether the tests notice a wrong operator: `make mutants`.

One operator, sign, index or number of `kinematics` or of what `app` decides (not what it draws) is
changed at a time, and the tests that run through its place are run, the nearest and quickest first.
Places are drawn by a seed, so that a sample can be repeated. First those files of tests are tried
for a few seconds that speak of the mutant's module. For the mutants that these do not notice it is
seen which tests run through their places, folder by folder of the tests, from the nearest on. What
was seen is kept in `.mutants` until the code, or that file of tests, changes; so is what was
noticed, until the code changes.

A changed program that gives the same answers is no fault of the tests. Those are listed in
`mutants_equal.toml`, each with the reason.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from queue import Queue
from threading import Lock

from mutant_reach import Ran, copied, environment, instrumented, is_kernel, run_through
from mutant_sites import ROOT, Mutant, sample

KEPT = ROOT / ".mutants"
EQUAL = Path(__file__).with_name("mutants_equal.toml")
TESTS = ("tests/kinematics", "tests/conformance", "tests/app")

SECONDS = (45.0, 150.0)  # of processors: for the tests of a folder, and of all for a mutant
GUESS = 15.0  # s of processors for tests that speak of its module
MEMORY = 8 << 30  # bytes of addresses that a process of a mutant's tests may have
PATIENCE = 10.0  # times as long as the tests take; then the mutant hangs, which is noticed


def folders(mutant: Mutant) -> list[str]:
    """Folders of tests, the nearest to a mutant first."""
    every = {file.parent for place in TESTS for file in (ROOT / place).rglob("test_*.py")}
    mine = Path(mutant.file).parent.parts

    def far(folder: str) -> tuple[bool, int, int, str]:
        parts = Path(folder).parts[1:]
        shared = sum(mine[: n + 1] == parts[: n + 1] for n in range(len(mine)))
        beside = parts[:2] == ("kinematics", "mechanisms") and parts[:3] != mine[:3]
        return (beside, -len(set(mine) & set(parts)), len(parts) - shared, folder)

    return sorted((folder.relative_to(ROOT).as_posix() for folder in every), key=far)


@dataclass
class Reach:
    """Which tests run through the places of a sample, as far as it was asked."""

    sites: list[Mutant]
    code: str
    scratch: Path
    known: dict[str, Ran] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)

    def tests(self, mutant: Mutant, folder: str) -> list[tuple[str, float]]:
        """Of a folder, those that run through a place and their seconds, the quickest first."""
        with self.lock:
            modules = sorted(
                file.relative_to(ROOT).as_posix() for file in (ROOT / folder).glob("test_*.py")
            )
            missing = [each for each in modules if each not in self.known and not self._kept(each)]
            if missing:
                self._see(missing)
        ran = [self.known[each] for each in modules]
        found = [
            (test, each.seconds[test]) for each in ran for test in each.sites.get(mutant.key, ())
        ]
        return sorted(found, key=lambda each: each[1])

    def _file(self, module: str) -> Path:
        digest = hashlib.sha256((ROOT / module).read_bytes())
        digest.update("\n".join([self.code, *(site.key for site in self.sites)]).encode())
        return KEPT / f"{Path(module).stem}-{digest.hexdigest()[:16]}.json"

    def _kept(self, module: str) -> bool:
        file = self._file(module)
        if not file.exists():
            return False
        kept = json.loads(file.read_text())
        self.known[module] = Ran(kept["sites"], kept["seconds"])
        return True

    def _see(self, modules: list[str]) -> None:
        copy = self.scratch / "seen"
        if not copy.exists():
            instrumented(copied(copy), self.sites)
        for module in modules:  # they may be others by now
            (copy / module).write_bytes((ROOT / module).read_bytes())
        print(
            f"{len(modules)} files of tests in {Path(modules[0]).parent} are seen first", flush=True
        )
        for module, ran in run_through(copy, self.sites, modules).items():
            self.known[module] = ran
            kept = {"sites": ran.sites, "seconds": ran.seconds}
            self._file(module).write_text(json.dumps(kept))


@dataclass
class Trial:
    """How far a mutant was tried."""

    mutant: Mutant
    folders: list[str]
    said: str = ""
    run: int = 0
    left: int = 0
    seconds: float = 0.0

    def go_on(self, copy: Path, reach: Reach) -> None:
        """Try the tests of the next folder, as far as they are quick enough."""
        chosen: list[str] = []
        seconds = 0.0
        for test, each in reach.tests(self.mutant, self.folders.pop(0)):
            more = seconds + each
            within = more <= SECONDS[0] and self.seconds + more <= SECONDS[1]
            if within or not self.run + len(chosen):
                chosen.append(test)
                seconds = more
            else:
                self.left += 1
        self.run += len(chosen)
        self.seconds += seconds
        if chosen:
            with changed(copy, self.mutant):
                self.said = _noticed(copy, chosen, 60.0 + PATIENCE * seconds)


def guessed(room: list[Mutant], copy: Path) -> dict[Mutant, str]:
    """By what mutants are noticed in a few seconds, in forks of one process.

    Tried are the files of tests that speak of a mutant's module: no search is as quick.
    """
    asked, files = copy / "asked.json", {each: speaking_of(each) for each in room}
    found = copy / "found.jsonl"
    found.unlink(missing_ok=True)
    content = [
        {
            **{name: getattr(each, name) for name in ("key", "file", "start", "end", "text")},
            "number": n,
            "tests": files[each],
            "seconds": GUESS,
        }
        for n, each in enumerate(room)
        if files[each] and not is_kernel(each.file)
    ]
    if not content:
        return {}
    asked.write_text(json.dumps(content))
    shutil.copy(Path(__file__).with_name("mutant_forks.py"), copy)
    options = ["-q", "-p", "no:cacheprovider", "-p", "mutant_forks", "-n", "0", "--timeout=0"]
    every = dict.fromkeys(test for each in files.values() for test in each)
    subprocess.run(
        [sys.executable, "-m", "pytest", *options, *every],
        cwd=copy,
        env={**environment(copy), "MUTANTS_ASKED": str(asked), "MUTANTS_FOUND": str(found)},
        capture_output=True,
        check=False,
    )
    lines = found.read_text().splitlines() if found.exists() else []
    told = [json.loads(line) for line in lines]
    return {
        room[each["number"]]: " - ".join(each["failed"]).splitlines()[0]
        for each in told
        if each["failed"]
    }


def room_of(mutant: Mutant) -> str:
    """Mutants that are tried together."""
    parts = Path(mutant.file).parent.parts
    return "/".join(parts[:3] if parts[1:2] == ("mechanisms",) else parts[:2])


def speaking_of(mutant: Mutant) -> list[str]:
    """Files of tests that name a mutant's module, those of the nearest folders first, and others
    beside them."""
    module = Path(mutant.file)
    stem = module.parent.name if module.stem == "__init__" else module.stem
    named = re.compile(rf"\b{re.escape(stem)}\b.*")
    above = re.compile(rf"\b{re.escape(module.parent.name)}\b")
    found = []
    for n, folder in enumerate(folders(mutant)):
        for file in sorted((ROOT / folder).glob("test_*.py")):
            text = file.read_text()
            count = len(named.findall(text)) if above.search(text) or n == 0 else 0
            if count:
                found.append((n, -count, file.relative_to(ROOT).as_posix()))
    named_by = [file for _, _, file in sorted(found)[:3]]
    near = sorted((ROOT / folders(mutant)[0]).glob("test_*.py"))
    beside = [file.relative_to(ROOT).as_posix() for file in near] if len(near) < 20 else []
    return list(dict.fromkeys([*named_by, *beside]))[:5]


@contextmanager
def changed(copy: Path, mutant: Mutant) -> Iterator[None]:
    """The copy with the mutant in it."""
    place = copy / mutant.file
    text, times = place.read_bytes(), place.stat()
    place.write_bytes(text[: mutant.start] + mutant.text.encode() + text[mutant.end :])
    for old in (place.parent / "__pycache__").glob(f"{place.stem}.*"):
        old.unlink()  # it goes by seconds, and one mutant may follow another in less
    try:
        yield
    finally:
        place.write_bytes(text)
        # What is compiled goes by the date.
        os.utime(place, ns=(times.st_atime_ns, times.st_mtime_ns))


def _noticed(copy: Path, tests: list[str], most: float) -> str:
    """How tests end that may take so many seconds of processors; "" where they pass."""
    options = ["-x", "-q", "-p", "no:cacheprovider", "--tb=line", "-n", "0", "--timeout=0"]

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(most), int(most) + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    try:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *tests],
            cwd=copy,
            capture_output=True,
            text=True,
            timeout=6.0 * most,
            env=environment(copy),
            preexec_fn=limited,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "it waits for ever"
    if done.returncode == 0:
        return ""
    if done.returncode < 0:
        return f"it hangs, or ends by signal {-done.returncode}"
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0][:300] if failed else f"exit {done.returncode}: {done.stdout[-200:]!r}"


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", default="", help="what names of files begin with")
    parser.add_argument("--match", default="", help="only mutants whose name has this in it")
    parser.add_argument("--least", type=float, default=0.95, help="the part to be noticed")
    asked = parser.parse_args()
    equal: dict[str, str] = tomllib.loads(EQUAL.read_text())["equal"] if EQUAL.exists() else {}
    every = sorted(sample(asked.seed, asked.count, asked.only), key=_order)
    KEPT.mkdir(exist_ok=True)
    results = Results(len(every), KEPT / f"noticed-{_code()}.jsonl")
    left = []
    for mutant in (m for m in every if re.search(asked.match, m.key)):
        said = "equal" if mutant.key in equal else results.before.get(_named(mutant))
        if said:
            results.found[mutant] = said
        else:
            left.append(mutant)
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(asked.jobs) as pool:
        reach = Reach(every, _code(), Path(scratch))
        copies: Queue[Path] = Queue()
        for n in range(asked.jobs):
            copies.put(copied(Path(scratch) / str(n)))

        def guess(room: list[Mutant]) -> None:
            copy = copies.get()
            for mutant, said in guessed(room, copy).items():
                results.add(mutant, said)
            copies.put(copy)

        def try_on(trial: Trial) -> None:
            copy = copies.get()
            trial.go_on(copy, reach)
            copies.put(copy)
            if trial.said or not trial.folders:
                results.add(trial.mutant, trial.said)

        list(pool.map(guess, [list(group) for _, group in groupby(left, room_of)]))
        trials = [Trial(each, folders(each)) for each in left if each not in results.found]
        while trials := [each for each in trials if each.folders and not each.said]:
            list(pool.map(try_on, trials))
    return _told(results.found, asked.least)


class Results:
    """By what mutants were noticed, "" by nothing; kept in a file."""

    def __init__(self, count: int, file: Path) -> None:
        self._count, self._file = count, file
        lines = file.read_text().splitlines() if file.exists() else []
        self.before: dict[str, str] = dict(map(json.loads, lines))
        self.found: dict[Mutant, str] = {}

    def add(self, mutant: Mutant, said: str) -> None:
        """And tell it."""
        self.found[mutant] = said
        with self._file.open("a") as out:
            out.write(json.dumps([_named(mutant), said]) + "\n")
        told = said or "NOT NOTICED"
        print(f"{len(self.found)}/{self._count} {mutant.line} {mutant.key}\n    {told}", flush=True)


def _named(mutant: Mutant) -> str:
    return f"{mutant.key} @{mutant.start}"


def _order(mutant: Mutant) -> tuple[bool, str, int]:
    return mutant.file.startswith("app"), mutant.file, mutant.start


def _code() -> str:
    digest = hashlib.sha256()
    for folder in ("kinematics", "app", "assets"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _told(results: dict[Mutant, str], least: float) -> int:
    missed = sorted(mutant for mutant, said in results.items() if not said)
    counted = [said for said in results.values() if said != "equal"]
    share = 1.0 - len(missed) / max(len(counted), 1)
    print(f"\n{len(counted) - len(missed)} of {len(counted)} noticed ({share:.1%})")
    print(f"{len(results) - len(counted)} change nothing, see {EQUAL.name}")
    for mutant in missed:
        print(f"  line {mutant.line} {mutant.key}")
    return 0 if share >= least else 1


if __name__ == "__main__":
    sys.exit(main())
