"""What files hold: `{limbs}`, types of limbs with their keys, and `{schemas}`, the JSON Schemas.

The schemas are what ``bohemia schema`` prints, as files beside the pages.
"""

from __future__ import annotations

from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from app.features.review.command import FILES, schema_text
from kinematics.designs.assets import asset_folder
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


NAMES = [*FILES, *sorted(path.stem for path in asset_folder("schemas").glob("*.json"))]
FOLDER = "_static/schemas"


class Schemas(SphinxDirective):
    def run(self) -> list[nodes.Node]:
        up = "../" * self.env.docname.count("/")
        links = (f'<a href="{up}{FOLDER}/{name}.json">{name}.json</a>' for name in NAMES)
        return [nodes.raw("", f"<p>{', '.join(links)}</p>", format="html")]


def _write(app: Sphinx, exception: Exception | None) -> None:
    if exception is not None or app.builder.format != "html":
        return
    folder = Path(app.outdir) / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        (folder / f"{name}.json").write_text(schema_text(name), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("limbs", Limbs)
    app.add_directive("schemas", Schemas)
    app.connect("build-finished", _write, priority=100)  # before the links are checked
    return {"parallel_read_safe": True, "parallel_write_safe": True}
