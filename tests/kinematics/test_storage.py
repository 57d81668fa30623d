"""Files are read up to a limit and only if they are files; what is written is whole."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from kinematics import storage
from kinematics.errors import InputError


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_bytes(b"x" * 100)
    assert storage.read_file(file, 100, "a design file") == b"x" * 100
    with pytest.raises(InputError, match=r"a\.toml: longer than 0 kB, so not a design file"):
        storage.read_file(file, 99, "a design file")
    file.write_bytes(b"x" * ((3 << 20) + 1))
    for limit, size in ((64 * 1024, "64 kB"), (3 << 20, "3 MB")):
        with pytest.raises(InputError, match=f"longer than {size}, so not a design file"):
            storage.read_file(file, limit, "a design file")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes in folders")
def test_what_is_no_file_is_not_read_and_nobody_waits(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    for name in ("pipe", "link", "."):
        with pytest.raises(InputError, match="no regular file, so not a design file"):
            storage.read_file(tmp_path / name, 100, "a design file")


def test_a_byte_order_mark_is_left_out_and_other_bytes_are_told(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_bytes("\ufeffx,y\n".encode())
    assert storage.read_text(file, 100, "a list of points") == "x,y\n"
    file.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="not text in UTF-8, so not a list of points"):
        storage.read_text(file, 100, "a list of points")


def test_links_are_followed_and_permissions_kept(tmp_path: Path) -> None:
    file, link = tmp_path / "real.json", tmp_path / "link.json"
    file.write_bytes(b"old")
    file.chmod(0o664)
    link.symlink_to(file)
    storage.write_file(link, b"new")
    assert link.is_symlink()
    assert file.read_bytes() == b"new"
    assert stat.S_IMODE(file.stat().st_mode) == 0o664
    assert {each.name for each in tmp_path.iterdir()} == {"link.json", "real.json"}


def test_a_failure_leaves_the_old_file_whole_and_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "a.stl"
    file.write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match=r"cannot write .*a\.stl': no space left on device"):
        storage.write_file(file, b"new")
    assert file.read_bytes() == b"old"
    assert [each.name for each in tmp_path.iterdir()] == ["a.stl"]


def test_a_device_is_written_to_directly() -> None:
    storage.write_file(os.devnull, b"gone")
    with pytest.raises(InputError, match="cannot write"):
        storage.write_file("/dev/full" if Path("/dev/full").exists() else "/", b"much")
