"""Formulas as MathML, which browsers draw themselves: no script and no network."""

from __future__ import annotations

import re
from typing import Any, Literal

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

_NAME = re.compile(r"(<mi>(?:sin|cos|tan|arccos)</mi>)(?!<mo|<mrow><mo)")
_BEFORE = re.compile(r"(?<=</mi>|</mn>)(?=<mi>(?:sin|cos|tan|arccos)</mi>)")
_THIN = '<mspace width="0.17em"/>'


def mathml(tex: str, display: Literal["inline", "block"]) -> str:
    """A formula as MathML; names of functions stand apart from what they are of."""
    return _BEFORE.sub(_THIN, _NAME.sub(rf"\1{_THIN}", convert(tex, display=display)))


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def _display(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(f'<div class="math">{mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
