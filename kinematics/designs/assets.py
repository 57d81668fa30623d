"""Where the files lie that the program reads at run time."""

from __future__ import annotations

from pathlib import Path


def asset_folder(name: str) -> Path:
    """A folder of assets: inside the package in a wheel, beside it in a checkout."""
    here = Path(__file__).parent.parent
    wheel = here / "_assets"
    return (wheel if wheel.is_dir() else here.parent / "assets") / name
