"""What a report tells of a design: the page's tables, words and plots, in the order of a review."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from app.features.design.html import LIMB, about_html, shown
from app.features.report import charts, drawing, headline, marked
from app.features.report.compute import Found, Shown
from app.features.report.model import (
    Block,
    Chapter,
    Figure,
    Run,
    Runs,
    Scene,
    Section,
    Words,
    said,
    table,
)
from app.features.report.packing import motion_of, pack
from app.features.report.reading import read, runs_of
from app.features.section.html import numbers_html
from app.features.singularities import html as control
from app.features.singularities.compute import Controlled
from app.features.solutions import html as assembly
from app.features.solutions.compute import atlas, nearest_first
from app.features.solutions.state import Atlas
from app.features.trajectory import html as trajectories
from app.features.trajectory.compute import Moved
from app.features.workspace import html as workspaces
from app.features.workspace.compute import Laying, Solids, region_colors
from app.features.workspace.state import ASPECTS, colour_text
from app.language import tr
from app.review.units import minus, page_unit, pose_text, tenths
from app.review.view import short_title
from app.scene import painting, palette
from app.scene.palette import DARK, LIGHT
from app.scene.shapes import ground_cell
from app.terminal.tables import condition_text
from app.widgets.svg import DIM
from kinematics.arrays import Array
from kinematics.mechanism import DesignField

MOST_SOLUTIONS = 40  # that are listed
FRAMES = 91  # of an animation, at the most
APART = "\u2003"  # between entries of a line


def chapter(found: Found, letter: str = "") -> Chapter:
    """All that is told of one design."""
    design = found.review.design
    sections = (
        overview(found),
        *_optional(marked.section(found, tuple(_shapes(found)))),
        place(found),
        held(found),
        *_optional(workspace(found), cut(found), singular(found), modes(found), way(found)),
        numbers(found),
        *_optional(failed(found)),
    )
    title = design.title or design.name
    return Chapter(title, design.source, sections, letter, design.name)


def _optional(*sections: Section | None) -> Iterator[Section]:
    return (section for section in sections if section is not None and section.blocks)


# --- the scene and what matters most -------------------------------------------------------


def overview(found: Found) -> Section:
    """The machine with its workspace, and the numbers that matter."""
    review, machine = found.review, found.review.machine
    shapes = tuple(_shapes(found))
    motion = None
    if found.moving is not None:
        run = found.moving.computed.found
        kept = [*range(0, len(run.times), max(1, len(run.times) // FRAMES)), len(run.times) - 1]
        kept = sorted(set(kept))
        motion = motion_of(machine, run.poses[kept], run.mode, run.times[kept])
    cell = f"{ground_cell(found.view.drawing):g}"
    where = f"The machine at {pose_text(machine.coordinates, review.pose)}"
    told = ", ".join(filter(None, (where, found.view.status.mode, _beside(found))))
    alt = f"Drawing: {short_title(machine)}. {told}."
    marks = marked.told(found.view)
    over = lambda sheet: marked.over(sheet, marks)  # noqa: E731
    picture = drawing.picture(found.view, shapes, alt, over)
    still = Figure(picture, f"{told}. Grid {cell} mm.", alt)
    packed = pack(found.view, shapes, motion, marks=marked.in_scene(found.view))
    limbs = sorted({c.limb or n + 1 for n, c in enumerate(machine.joints)})
    legend = tuple(
        Run(f"limb {limb}{APART if limb != limbs[-1] else ''}", chip=palette.limb_color(limb))
        for limb in limbs
    )
    blocks: list[Block] = [Scene(packed, still), Words(legend, "quiet")]
    blocks.append(headline.verdict(found))
    blocks.append(headline.results(found))
    return Section("Overview", tuple(blocks))


def _beside(found: Found) -> str:
    on = [s for s in found.solids if s.on and s.seen.triangles]
    return f"with the {colour_text(found.review)}" if on or found.regions else ""


def _shapes(found: Found) -> Iterator[drawing.Shape]:
    """The solids and regions, painted as the page paints them."""
    for each in found.solids:
        if not each.seen.triangles:
            continue
        turn, shift = each.built.wish.placement[:3, :3], each.built.wish.placement[:3, 3]
        pairs = list(zip(_coats(each, dark=False), _coats(each, dark=True), strict=True))
        for n, (light, dark) in enumerate(pairs):
            edges = each.seen.edges if n == 0 else each.seen.edges[:0]
            yield drawing.Shape(
                each.spec.key,
                each.spec.title,
                each.on,
                light.vertices @ turn.T + shift,
                light.faces,
                edges @ turn.T + shift,
                (light.color, dark.color),
                (LIGHT.edge, DARK.edge),
                light.shells,
            )
    for laid in found.regions[:1]:
        colors = (
            region_colors(laid.regions),
            region_colors(laid.regions, DARK),
        )
        filled = [n for n, fill in enumerate(laid.fills) if len(fill.faces)]
        for n in filled:
            fill = laid.fills[n]
            yield drawing.Shape(
                "regions",
                laid.spec.title,
                True,
                fill.vertices.astype(float),
                fill.faces,
                laid.lines if n == filled[0] else laid.lines[:0],
                (colors[0][n], colors[1][n]),
                (LIGHT.edge, DARK.edge),
                painting.MEASURE,
            )


def _coats(each: Shown, *, dark: bool) -> tuple[painting.Coat, ...]:
    of = DARK if dark else LIGHT
    if each.seen.piece_of is not None and each.seen.on_locus is not None and each.seen.pieces:
        return painting.pieces(each.seen, locus=True, of=of)
    return painting.plain(each.seen, palette.solid_color(each.spec, of))


# --- the pose ------------------------------------------------------------------------------


def place(found: Found) -> Section:
    """Where the machine stands, and its actuators between their bounds."""
    view, machine = found.view, found.review.machine
    pose = [
        (f"{c.symbol}", tenths(c.outer(v)), page_unit(c))
        for c, v in zip(machine.coordinates, found.review.pose, strict=True)
    ]
    blocks: list[Block] = [table("Pose of the platform", ("", "value", "unit"), pose, [1])]
    rows = []
    for row in view.joints:
        name: Runs = (Run(row.symbol, chip=palette.limb_color(row.limb)),)
        share = (row.value - row.low) / (row.high - row.low) if row.high > row.low else 0.0
        bar: Runs = (Run("", bar=((0.0, share, palette.limb_color(row.limb)),)),)
        ends = tenths(row.low), tenths(row.high)
        rows.append((name, tenths(row.value), *ends, row.unit, bar, said(row.note)))
    heads = ("actuator", "value", "min", "max", "unit", "between its ends", "")
    blocks.append(table("Actuators", heads, rows, [1, 2, 3], note=_closure(found)))
    told = runs_of(control.motion_html(found.here))
    blocks += read(
        control.motion_html(found.here),
        "Velocity and acceleration at the rates asked for",
        heads=("", "rate", "acceleration"),
    ) * bool(told or found.here.motion)
    return Section("Pose and actuators", tuple(blocks))


def _closure(found: Found) -> str:
    from app.features.move.html import closure_text

    text = closure_text(found.view.posture.residual)
    return f"{text[:1].upper()}{text[1:]}."


def held(found: Found) -> Section:
    """How well the platform is held, what is near, and the forces under the load."""
    here, machine = found.here, found.review.machine
    blocks: list[Block] = [*read(control.here_html(Controlled(here)))]
    size = f"{machine.length:.1f}"
    blocks += read(
        control.measures_html(here),
        f"How well it is held here; moments by the characteristic length L = {size} mm",
        heads=("measure", "value", "of its range"),
    )
    blocks.append(headline.clearances(here))
    if here.remedy is not None:
        blocks += read(control.ways_html(here.remedy), "Changes that would allow this pose")
    load = here.place.load
    force = ", ".join(minus(f"{v:g}") for v in load[:3])
    moment = ", ".join(minus(f"{v:g}") for v in load[3:])
    blocks += read(
        control.forces_html(here),
        f"Forces that hold F = ({force}) N, T = ({moment}) N·mm on the platform at O′, base frame",
        heads=("", "force", "push or pull"),
    )
    blocks += read(control.circles_html(here))
    return Section("How the platform is held", tuple(blocks))


# --- the workspace -------------------------------------------------------------------------


def workspace(found: Found) -> Section | None:
    """Pieces, regions, the map."""
    blocks: list[Block] = []
    review = found.review
    for each in found.solids:
        if each.spec.key == ASPECTS or not each.built.solid.triangles:
            continue
        blocks.append(headline.pieces(found, each))
    for laid in found.regions:
        one = Laying(laid, False, "")
        blocks += read(
            workspaces.regions_html(one), laid.spec.title, heads=("region", "area", "", "")
        )
        at = _in_plane(found, laid.frame)
        if (figure := charts.regions(laid, at)) is not None:
            blocks.append(figure)
    if found.map is not None and found.map.done.any():
        from app.features.map.plot import extremes_html

        blocks.append(charts.chart_of_map(found.map, review))
        quantity = found.map.request.quantities[0].title
        modes_ = workspaces_of(found)
        blocks += read(
            extremes_html(found.map, review.pose), f"{quantity} over the orientations, {modes_}"
        )
    return Section("Workspace", tuple(blocks), fresh=True)


def workspaces_of(found: Found) -> str:
    """Of which modes the workspace is."""
    from app.features.workspace.state import modes_text

    return modes_text(found.review)


def _in_plane(found: Found, frame: Array) -> tuple[float, float]:
    """Where O′ is in a plane (4, 4), mm."""
    at = found.view.platform[:3, 3] - frame[:3, 3]
    x, y = (at @ frame[:3, :3])[:2].tolist()
    return x, y


def cut(found: Found) -> Section | None:
    """The section and the area along its normal."""
    measured, spec = found.measured, found.review.machine.section_spec
    if measured is None or spec is None:
        return None
    drawn = measured.drawn
    told = numbers_html(drawn.section, spec, drawn.extent.along)
    blocks: list[Block] = [charts.section(measured)]
    blocks += _joined(read(told, f"The section, {drawn.picture.note}", heads=("", "value")))
    if (figure := charts.profile(measured, found.review)) is not None:
        blocks.append(figure)
    return Section("Section", tuple(blocks), fresh=True)


def _joined(blocks: Sequence[Block]) -> Iterator[Block]:
    """Paragraphs that follow each other as one."""
    runs: list[Run] = []
    for block in blocks:
        if isinstance(block, Words):
            runs += [*([Run(" · ", color=DIM)] if runs else []), *block.runs]
            continue
        if runs:
            yield Words(tuple(runs))
            runs = []
        yield block
    if runs:
        yield Words(tuple(runs))


def singular(found: Found) -> Section | None:
    """Aspects and singular curves."""
    blocks: list[Block] = []
    aspects = {s.spec.key: s.built for s in found.solids if s.spec.key == ASPECTS}
    if aspects:
        solids = Solids((), aspects, {}, None)
        blocks += read(control.pieces_html(found.review, solids), "Aspects of the present mode")
    circle = next((c for c in found.here.circles if c.limit == "parallel"), None)
    for spec, curves in found.curves:
        blocks.append(charts.chart(spec, curves, found.review, circle))
        blocks.append(Words(said(f"{control.exactness(spec, curves)}."), "quiet"))
    if found.profiles:
        blocks.append(charts.circles(found.profiles))
    return Section("Singularities", tuple(blocks), fresh=True)


# --- other assembly modes, the trajectory --------------------------------------------------


def modes(found: Found) -> Section | None:
    """All solutions for the present actuators, and where the present one ends."""
    if found.known is None:
        return None
    listed = atlas(found.view, found.known)
    review, machine = found.review, found.review.machine
    blocks: list[Block] = [
        *read(assembly.count_html(listed, "")),
        *read(assembly.remarks_html(listed)),
    ]
    signs = any(machine.modes)
    rows = listed.rows[:MOST_SOLUTIONS]
    heads = [*(["mode"] * signs), *(f"{c.symbol} ({page_unit(c)})" for c in machine.coordinates)]
    heads += ["Δ (mm)", "cond.", ""]
    cells = []
    for row in rows:
        cell: list[Runs | str] = []
        if signs:
            cell.append((Run(minus(row.mode)),))
        cell += [tenths(c.outer(v)) for c, v in zip(machine.coordinates, row.pose, strict=True)]
        cell += [tenths(row.distance), condition_text(row.condition)]
        notes = ["here" * row.here, "beyond stroke" * (not row.within_stroke), row.remark]
        cell.append(", ".join(filter(None, notes)))
        cells.append(cell)
    if cells:
        more = (
            f" The nearest {len(rows)} of {len(listed.rows)}."
            if len(listed.rows) > len(rows)
            else ""
        )
        by = tr(f"solutions.sort_by.{review[Atlas].sort}").replace("Sort ", "Sorted ", 1)
        note = f"{by}; Δ: way of the platform's farthest point.{more}"
        numeric = range(int(signs), len(heads) - 1)
        marked = [n for n, row in enumerate(rows) if row.here]
        blocks.append(table("Assembly modes", heads, cells, [*numeric], marked=marked, note=note))
    blocks += _folds(found)
    return Section("Assembly modes", tuple(blocks), fresh=True)


def _folds(found: Found) -> Iterator[Block]:
    if not found.ahead:
        return
    review, machine = found.review, found.review.machine
    folds = nearest_first(found.ahead, None)
    goals = {(a.index, a.longer): a.goal for a in folds}
    joints = zip(machine.joints, found.view.posture.joints, strict=True)
    spans = [(c, v, goals.get((n, False)), goals.get((n, True))) for n, (c, v) in enumerate(joints)]
    yield from read(
        assembly.strokes_html(spans),
        "How far each actuator can go alone until this assembly mode ends (mm, °)",
        heads=("", "shorter", "stroke, folds marked", "longer"),
    )
    if folds:
        yield Words(said(assembly.words(review, folds[0], found.known)))
    else:
        text = "No actuator, driven alone, meets a fold before the end of its stroke."
        yield Words(said(text), "quiet")


def way(found: Found) -> Section | None:
    """The trajectory."""
    if found.moving is None:
        return None
    computed, fits = found.moving.computed, found.moving.fits
    moved = Moved(computed, False, "", 1.0, False, fits, "", None, "")
    machine = found.review.machine
    blocks: list[Block] = [*read(trajectories.summary_html(moved))]
    if (figure := charts.trajectory(found)) is not None:
        blocks.append(figure)
    blocks += read(trajectories.most_html(computed), "The largest of each actuator on the way")
    if fits is not None:
        axes, joints = machine.coordinates, machine.joints
        blocks += read(
            trajectories.fits_html(fits, "", axes, joints), "True error of the fitted polynomials"
        )
    return Section("Trajectory", tuple(blocks), fresh=True)


# --- the design ----------------------------------------------------------------------------


def numbers(found: Found) -> Section:
    """What was found in the design, what its numbers are, and the numbers."""
    review, view = found.review, found.view
    blocks: list[Block] = [*read(about_html(review.design))]
    name = f"What the numbers of {review.design.title or review.design.name} are"
    picture, limb = drawing.dimensioned(view, name)
    dims = [d for d in view.drawing.dimensions if d.limb in (None, limb)]
    dims += [d for d in view.drawing.dimensions if d.kind == "direction" and d.limb != limb]
    told = "; ".join(f"{d.symbol} {d.text}" for d in dims)
    caption = f"The numbers of the design at limb {limb}; those of the others likewise."
    caption = caption if dims else "The machine with the names of its joints."
    blocks.append(Figure(picture, caption, f"{name}: {told}."))
    rows = [(d.symbol, d.text, _values(review.machine.fields, d.paths)) for d in dims]
    if rows:
        title = f"What they are, and those of limb {limb}"
        blocks.append(table(title, ("", "what", "value"), rows))
    blocks += _tables(review.machine.fields)
    return Section("Design", tuple(blocks), fresh=True)


def _values(fields: Sequence[DesignField], paths: Sequence[tuple[str | int, ...]]) -> str:
    """The numbers at some paths: "(−55, 30, 50) mm", "250 … 400 mm"."""
    own = [f for f in fields for p in paths if f.path[: len(p)] == p]
    unit = {"mm": " mm", "rad": "°"}.get(own[0].unit, "") if own else ""
    texts = [_number(f) for f in own]
    if len(texts) == 1:
        return f"{texts[0]}{unit}"
    if len(texts) == 2:
        return f"{texts[0]}{'°' * (unit == '°')} … {texts[1]}{unit}"
    return f"({', '.join(texts)}){unit}"


def _number(field: DesignField) -> str:
    return minus(f"{round(shown(field), 9) + 0.0:.10g}")


def _tables(fields: Sequence[DesignField]) -> Iterator[Block]:
    """A table of the limbs, a row each, and one of each other group."""
    groups: dict[str, list[DesignField]] = {}
    for field in fields:
        groups.setdefault(field.group, []).append(field)
    limbs = {
        g: f for g, f in groups.items() if g.startswith(LIMB) and g.removeprefix(LIMB)[:1].isdigit()
    }
    common = [f.label for f in next(iter(limbs.values()), [])]
    if limbs:
        heads = ["limb", *(_titled(f) for f in next(iter(limbs.values())))]
        rows: list[list[Runs | str]] = []
        for group, own in limbs.items():
            number = group.removeprefix(LIMB)
            color = palette.limb_color(int(number.partition(" ")[0]))
            rows.append([(Run(number, chip=color),), *(_number(f) for f in own[: len(common)])])
        yield table("Limbs", heads, rows, [*range(1, len(heads))])
    for group, own in groups.items():
        more = own[len(common) :] if group in limbs else own
        if more:
            unit = {"mm": "mm", "rad": "°", "": ""}
            listed = [(f.label, _number(f), unit[f.unit]) for f in more]
            yield table(group, ("", "value", "unit"), listed, [1])


def _titled(field: DesignField) -> str:
    unit = {"mm": "mm", "rad": "°"}.get(field.unit, "")
    return f"{field.label} ({unit})" if unit else field.label


def failed(found: Found) -> Section | None:
    """What could not be computed."""
    return Section("Not computed", tuple(Words(said(text), "bad") for text in found.failed))
