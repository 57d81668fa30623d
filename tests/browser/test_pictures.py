"""The README's pictures are not older than what they show."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from tests.pictures import PICTURES, take

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = [pytest.mark.browser, pytest.mark.slow]

DIFFERS = 40  # of 255, in a colour
MOST = 0.03  # of the pixels: edges are drawn a little otherwise by another browser


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_shows_the_page_as_it_is(
    browser: Browser,
    root: Path,
    tmp_path: Path,
    name: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from tests.browser import conftest

    monkeypatch.setattr(conftest, "SIZE", conftest.SIZE)  # given back in the end
    kept, fresh = (
        np.asarray(Image.open(file).convert("RGB")).astype(int)
        for file in (root / f"assets/readme/{name}.png", take(browser, name, tmp_path))
    )
    assert kept.shape == fresh.shape, "make pictures"
    off = (np.abs(kept - fresh).max(axis=2) > DIFFERS).mean()
    assert off < MOST, f"{name}.png is of an earlier page; make pictures"
