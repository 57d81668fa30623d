"""A session is in its file soon after each change, and in nobody else's hands."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from app.review import keeping, session
from app.review.keeping import LATEST, Keeper
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from tests.conftest import ROOT


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rps-3"))


@contextmanager
def keeps(path: Path, review: Review) -> Iterator[Keeper]:
    keeper = Keeper(path)
    try:
        keeper.begin(review)
        yield keeper
    finally:
        keeper.close()


def at(review: Review, z: float) -> Review:
    return replace(review, pose=(z, *review.pose[1:]))


def z_in(path: Path) -> float:
    z: float = json.loads(path.read_text(encoding="utf-8"))["pose"]["z"]
    return z


def until(true: object, seconds: float = 10.0) -> None:
    end = time.monotonic() + seconds
    while not true():  # type: ignore[operator]
        assert time.monotonic() < end
        time.sleep(0.02)


def test_it_is_saved_while_changes_never_cease(review: Review, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    with keeps(path, review) as keeper:
        made = {}
        oldest = 0.0
        for n in range(60):
            made[float(n)] = time.monotonic()
            keeper.offer(at(review, float(n)))
            time.sleep(0.1)
            known = z_in(path)
            missing = [when for z, when in made.items() if known not in made or z > known]
            oldest = max(oldest, time.monotonic() - min(missing, default=time.monotonic()))
        assert oldest < LATEST + 1.5  # and the disk
    assert z_in(path) == 59.0


def test_a_change_is_saved_once_it_has_settled(review: Review, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    with keeps(path, review) as keeper:
        keeper.offer(at(review, 7.0))
        until(lambda: z_in(path) == 7.0, LATEST + 2.0)


def _full(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)


def test_a_full_disk_is_told_once_and_tried_again(
    review: Review, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.json"
    monkeypatch.setattr(keeping, "RETRY", 0.1)
    told: list[str] = []
    with keeps(path, review) as keeper:
        keeper.tells(told.append)
        with monkeypatch.context() as patch:
            _full(patch)
            keeper.offer(at(review, 5.0))
            until(lambda: told)
            time.sleep(0.5)
            assert len(told) == 1
            assert "no space left" in told[0]
            assert z_in(path) != 5.0
            assert {p.name for p in tmp_path.iterdir()} == {"r.json", ".r.json.lock"}
        until(lambda: z_in(path) == 5.0)
        until(lambda: told[1:] == ["The session is saved again."])


def test_a_newer_change_goes_before_one_that_could_not_be_saved(
    review: Review, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.json"
    told: list[str] = []
    with keeps(path, review) as keeper:
        keeper.tells(told.append)
        with monkeypatch.context() as patch:
            _full(patch)
            keeper.offer(at(review, 5.0))
            until(lambda: told)
            keeper.offer(at(review, 6.0))
    assert z_in(path) == 6.0


def test_what_is_lost_in_the_end_is_told(
    review: Review, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.json"
    keeper = Keeper(path)
    keeper.begin(review)
    with monkeypatch.context() as patch:
        _full(patch)
        keeper.offer(at(review, 5.0))
        assert "no space left" in keeper.close()
    assert [p.name for p in tmp_path.iterdir()] == ["r.json"]


def test_the_last_change_is_saved_at_once_when_it_ends(review: Review, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    keeper = Keeper(path)
    keeper.begin(review)
    keeper.offer(at(review, 9.0))
    assert keeper.close() == ""
    assert z_in(path) == 9.0
    assert [p.name for p in tmp_path.iterdir()] == ["r.json"]


def test_a_failure_that_nobody_thought_of_does_not_end_the_saving(
    review: Review, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "r.json"
    monkeypatch.setattr(keeping, "RETRY", 0.1)
    told: list[str] = []
    with keeps(path, review) as keeper:
        keeper.tells(told.append)
        with monkeypatch.context() as patch:
            patch.setattr(session, "to_text", lambda review: 1 // 0)
            keeper.offer(at(review, 5.0))
            until(lambda: told)
        until(lambda: z_in(path) == 5.0)


def test_links_are_followed_and_permissions_kept(review: Review, tmp_path: Path) -> None:
    real, link = tmp_path / "real.json", tmp_path / "folder" / "link.json"
    session.save(review, real)
    real.chmod(0o664)
    link.parent.mkdir()
    link.symlink_to(real)
    with keeps(link, review) as keeper:
        keeper.offer(at(review, 3.0))
    assert link.is_symlink()
    assert z_in(real) == 3.0
    assert stat.S_IMODE(real.stat().st_mode) == 0o664
    assert [p.name for p in link.parent.iterdir()] == ["link.json"]


def test_one_file_is_kept_by_one_server(review: Review, tmp_path: Path) -> None:
    real, link = tmp_path / "real.json", tmp_path / "link.json"
    link.symlink_to(real)
    with keeps(real, review):
        for path in (real, link):
            with pytest.raises(InputError, match=rf"another Bohemia \(process {os.getpid()}\)"):
                Keeper(path)
    with keeps(link, review):
        pass


def test_a_killed_server_locks_nobody_out_and_leaves_nothing(
    review: Review, tmp_path: Path
) -> None:
    path = tmp_path / "r.json"
    code = (
        "import os, sys; from pathlib import Path; from app.review.keeping import Keeper; "
        f"Keeper(Path({str(path)!r})); os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False, timeout=60)
    assert (tmp_path / ".r.json.lock").exists()
    (tmp_path / ".r.json.0123abcd").write_bytes(b"half")  # as if killed while it wrote
    (tmp_path / ".r.json.notes").write_bytes(b"mine")
    with keeps(path, review):
        pass
    assert {p.name for p in tmp_path.iterdir()} == {"r.json", ".r.json.notes"}


@pytest.mark.parametrize("name", ["none/r.json", "a\0b", "", "x" * 300 + ".json"])
def test_where_no_file_can_stand_it_is_said_at_the_start(
    name: str, review: Review, tmp_path: Path
) -> None:
    with pytest.raises(InputError), keeps(tmp_path / name, review):
        pass


def test_a_link_in_a_circle_is_no_file(review: Review, tmp_path: Path) -> None:
    (tmp_path / "a.json").symlink_to("b.json")
    (tmp_path / "b.json").symlink_to("a.json")
    with pytest.raises(InputError), keeps(tmp_path / "a.json", review):
        pass
    assert (tmp_path / "a.json").is_symlink()
