"""The reference cases: computed by other means, each file with its source."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

REFERENCE = Path(__file__).parents[1] / "reference"


def read(name: str) -> Any:
    """A file of tests/reference."""
    return json.loads((REFERENCE / name).read_text(encoding="utf-8"))
