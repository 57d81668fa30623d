"""The page's plots for a report: as they stand there, without a pointer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from app.features.map import plot as maps
from app.features.map.state import Chart
from app.features.report.compute import Found, Measured
from app.features.report.model import Figure
from app.features.section import html as profiles
from app.features.section.plot import Picture, section_figure
from app.features.singularities import plot as loci
from app.features.trajectory import plot as strips
from app.features.workspace.compute import Laid, region_colors
from app.review.state import Review
from app.review.view import short_title
from app.widgets import axes
from app.widgets.axes import Look
from app.widgets.svg import document, heading
from kinematics.answers.circles import OrientationCircle, Profile
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.sections import together
from kinematics.arrays import Array
from kinematics.facets.map_sweeps import Map
from kinematics.machine import machine_of
from kinematics.mechanism import Design

WIDE = 640.0  # px, the width of the text
SECTION, MAP = (WIDE, 430.0), (WIDE, 400.0)
STRIPS = WIDE, 620.0
SMALL = 0.56  # of the width of the text: plots that are no wider on the page


def framed(figure: axes.Figure, caption: str, *, over: str = "", share: float = 1.0) -> Figure:
    """A plot with its title, and what lies over it."""
    a = figure.axes
    title = heading(a.left, a.top - 9, figure.title, figure.unit)
    content = figure.content + over + title
    alt = f"{figure.name}. {caption}".strip()
    return Figure(document((a.width, a.height), content, name=figure.name), caption, alt, share)


def section(measured: Measured) -> Figure:
    """The section where the plane stands."""
    drawn = measured.drawn
    close = replace(drawn.picture, bounds=None)  # a page keeps still while the plane moves
    figure = section_figure(close, Look(size=SECTION))
    caption = f"{figure.title}: {drawn.picture.note}. Edges by limb; how they are dashed says "
    return framed(figure, f"{caption}which bound it is.")


def profile(measured: Measured, review: Review) -> Figure | None:
    """The area of the sections along their normal."""
    spec = review.machine.section_spec
    if spec is None:
        return None
    figure = profiles.profile(measured.present, spec)
    if figure is None:
        return None
    over = profiles.mark(measured.present, figure.axes, measured.drawn.section.at)
    caption = f"The area of the section against {spec.normal}; the line: where the section above is"
    return framed(figure, f"{caption} taken.", over=over, share=0.75)


def regions(laid: Laid, at: Sequence[float] | None) -> Figure | None:
    """The regions of one kind in their plane."""
    there = [r for r in laid.regions if r.section.loops]
    if not there:
        return None
    colors = dict(zip((r.title for r in laid.regions), region_colors(laid.regions), strict=True))
    drawn = [
        r
        for r, fill in zip(laid.regions, laid.fills, strict=True)
        if len(fill.faces) and r.section.loops
    ]
    fills = [(r.section, colors[r.title]) for r in drawn]
    picture = Picture(
        together([r.section for r in drawn]),
        laid.spec.plane,
        faint=False,
        mark=at,
        curves=_plane_curves(laid),
        fills=fills if len(fills) > 1 else (),
    )
    figure = section_figure(picture, Look(size=SECTION))
    figure = replace(figure, title=laid.spec.title, unit="")
    return framed(figure, "The machine's place is the cross.")


def _plane_curves(laid: Laid) -> list[Array]:
    """Where control is lost, in the plane again."""
    turn, shift = laid.frame[:3, :3], laid.frame[:3, 3]
    return [((run - shift) @ turn)[:, :2] for run in laid.locus]


def chart(
    spec: LocusSpec, curves: LocusCurves, review: Review, circle: OrientationCircle | None
) -> Figure:
    """Singular curves over two coordinates."""
    figure = loci.figure(spec, curves, circle if spec.polar else None, leads=False)
    place = chart_place(review, spec)
    over = "" if place is None else loci.mark(spec, figure.axes, place)
    return framed(figure, "", over=over, share=SMALL)


def chart_place(review: Review, spec: LocusSpec) -> tuple[float, float] | None:
    """Where the machine stands in a chart; None if it has not these coordinates."""
    axes_ = review.machine.coordinates
    known = {c.symbol: v for c, v in zip(axes_, review.pose, strict=True)}
    if not all(symbol in known for symbol in spec.axes):
        return None
    return known[spec.axes[0]], known[spec.axes[1]]


def circles(found: Sequence[tuple[Design, Profile]]) -> Figure:
    """The largest circle of orientations over the altitude."""
    own = [(short_title(machine_of(design)), profile) for design, profile in found[:1]]
    figure = loci.profile_figure(own)
    over = loci.profile_mark(figure.axes, found[0][1].at)
    caption = f"{figure.name} over {found[0][1].across}. {figure.idle}."
    return framed(figure, caption, over=over, share=SMALL)


def chart_of_map(found: Map, review: Review) -> Figure:
    """The map."""
    figure = maps.figure(found, Look(size=MAP), stale=False, colours=review[Chart].colours)
    over = maps.here(found, figure.axes, review.pose)
    n, m = found.request.shape
    return framed(figure, f"{n} × {m} orientations.", over=over)


def trajectory(found: Found) -> Figure | None:
    """Everything against time."""
    if found.moving is None:
        return None
    figure = strips.figure(found.moving.computed, "all", Look(size=STRIPS), legend=True)
    text = "Bands: where something is beyond its limit, or not held; dashed: limits."
    return framed(figure, text)
