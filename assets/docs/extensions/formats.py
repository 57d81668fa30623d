"""`{limbs}`: the types of limbs that a design file may name, and their keys."""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from kinematics.mechanisms.parallel.limb_types import TYPES, LimbKey

FORMS = {
    "point": "three coordinates, mm",
    "direction": "a direction, three numbers",
    "number": "a length, mm",
    "pair": "two lengths, mm",
    "mode": '`"+"` or `"-"`',
    "choice": "1 or 2",
}


def _form(key: LimbKey) -> str:
    if key.unit == "rad":
        return "two angles, degrees" if key.form == "pair" else "an angle, degrees"
    frame = f", {key.frame} frame" if key.frame else ""
    return f"{FORMS[key.form]}{frame}"


class Limbs(SphinxDirective):
    def run(self) -> list[nodes.Node]:
        rows = ["| type | keys | may be left out |", "|---|---|---|"]
        keys: dict[str, set[str]] = {}
        for kind in TYPES.values():
            needed, rest = (
                ", ".join(f"`{key.name}`" for key in kind.keys if key.needed is is_needed)
                for is_needed in (True, False)
            )
            rows.append(f"| {kind.name} | {needed} | {rest} |")
            for key in kind.keys:
                keys.setdefault(key.name, set()).add(_form(key))
        rows += ["", "| key | holds |", "|---|---|"]
        rows += [f"| `{name}` | {'; or '.join(sorted(forms))} |" for name, forms in keys.items()]
        return self.parse_text_to_nodes("\n".join(rows))


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("limbs", Limbs)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
