"""Boxes that people type into, and what becomes of what cannot be used."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import viser

from app.features.map.state import Span
from app.review.units import from_page_units, in_page_units, page_unit
from app.widgets.desk import Desk, answer, esc, put
from app.widgets.plots import number
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate

# A number box that is left without a number goes back to its last one: viser does not even report
# what is none. Once for a page, in the browser.
_BACK = """
if(!window.boxesGoBack){window.boxesGoBack=1;
const ok=(i)=>i.value.trim()!==''&&isFinite(+i.value),
box=(e)=>e.target.closest&&e.target.closest('.mantine-NumberInput-root')?e.target:null,
keep=(e)=>{const i=box(e);if(i&&ok(i))i.good=i.value;},
back=(e)=>{const i=box(e);if(!i||ok(i)||i.good===undefined||e.key&&e.key!=='Enter')return;
Object.getOwnPropertyDescriptor(HTMLInputElement.prototype,'value').set.call(i,i.good);
i.dispatchEvent(new Event('input',{bubbles:true}));};
for(const t of ['focusin','input'])document.addEventListener(t,keep,true);
for(const t of ['focusout','keydown'])document.addEventListener(t,back,true);}
"""
NUMBERS_GO_BACK = (
    '<img alt="" style="display:none" src="data:image/gif;base64,'
    'R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7" '
    f'onload="{esc(_BACK.replace(chr(10), " ").strip())}">'
)


class SpanBox:
    """From, to, and how many values of a coordinate, in the page's units.

    Text, because number boxes keep to themselves what is no number.
    """

    def __init__(
        self,
        desk: Desk,
        axis: Coordinate,
        span: Span,
        act: Callable[[str, viser.ClientHandle | None], None],
    ) -> None:
        self._desk = desk
        self._axis = axis
        self._handle = desk.gui.add_text(
            f"{axis.symbol} from, to ({page_unit(axis)}), values",
            shown(axis, span),
            hint="Three numbers; both ends are included, and more values take longer",
        )
        answer(desk, self._handle, act)

    def read(self) -> Span:
        """What stands in the box.

        Raises:
            InputError: it is no span; whether its numbers can be used is for others to say.
        """
        return typed_span(self._axis, self._handle.value)

    def draw(self, span: Span) -> None:
        """Show a span; what was typed and means the same stays as it was typed."""
        try:
            same = self.read() == span
        except InputError:
            same = False
        if not same:
            put(self._desk, self._handle, shown(self._axis, span))


def shown(axis: Coordinate, span: Span) -> str:
    """A span as it can be typed: "-90, 90, 37"."""
    low, high = (number(round(in_page_units(axis, v), 6)) for v in (span.low, span.high))
    return f"{low}, {high}, {span.count}"


def typed_span(axis: Coordinate, typed: str) -> Span:
    """What a person typed: three numbers, with commas, semicolons or spaces between them.

    Raises:
        InputError: it is something else.
    """
    words = re.split(r"[\s,;…]+", typed.strip().replace("−", "-"))
    try:
        low, high, count = map(float, words)
    except ValueError:
        raise InputError(
            f"{axis.symbol} needs three numbers: from, to, and how many values, as "
            f"{shown(axis, Span())}"
        ) from None
    if not (math.isfinite(count) and count == round(count)):
        raise InputError(f"how many values of {axis.symbol} is a whole number")
    return Span(from_page_units(axis, low), from_page_units(axis, high), int(count))
