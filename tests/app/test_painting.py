"""How solids are painted: every triangle once, cut where a measure takes a step's value."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.scene import painting, palette
from app.scene.shapes import cylinder


def _solid(**more: Any) -> Any:
    vertices, faces = cylinder(24)
    shaded = SimpleNamespace(vertices=vertices, faces=faces)
    return SimpleNamespace(shaded=shaded, **more)


def _area(coat: painting.Coat) -> float:
    a, b, c = (coat.vertices[coat.faces[:, n]].astype(float) for n in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def _lifted(solid: Any) -> float:
    """The area of the surface as it is drawn when it is painted."""
    mesh = solid.shaded
    lifted = painting.lifted(mesh.vertices, mesh.faces)
    assert np.abs(lifted - mesh.vertices).max() <= 2.1 * painting.LIFT  # of a size of 2
    return _area(painting.Coat("", lifted, mesh.faces))


@given(
    st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3),
    st.floats(-3.0, 3.0),
    st.booleans(),
)
def test_steps_of_a_measure_cover_the_surface_once(
    slope: list[float], offset: float, high: bool
) -> None:
    solid = _solid()
    values = solid.shaded.vertices.astype(float) @ np.array(slope) + offset
    steps = painting.scale(values, high=high, limits=(None, None))
    assert steps is not None
    coats = painting.shaded(solid, values, steps, palette.WORKSPACE)
    assert sum(map(_area, coats)) == pytest.approx(_lifted(solid), rel=1e-5)
    assert {coat.color for coat in coats} <= {steps.color(n) for n in range(painting.STEPS)}


def test_a_step_ends_where_the_measure_takes_its_value() -> None:
    solid = _solid()
    values = solid.shaded.vertices[:, 2].astype(float)
    steps = painting.Scale(np.linspace(0.0, 1.0, painting.STEPS + 1), True)
    for coat in painting.shaded(solid, values, steps, palette.WORKSPACE):
        step = next(n for n in range(painting.STEPS) if steps.color(n) == coat.color)
        heights = coat.vertices[:, 2]
        assert heights.min() >= steps.edges[step] - 3 * painting.LIFT
        assert heights.max() <= steps.edges[step + 1] + 3 * painting.LIFT


def test_what_has_no_value_keeps_the_solids_colour() -> None:
    solid = _solid()
    values = np.where(solid.shaded.vertices[:, 0] > 0.5, np.nan, 1.0)
    steps = painting.scale(values, high=True, limits=(0.0, 1.0))
    assert steps is not None
    coats = painting.shaded(solid, values, steps, palette.WORKSPACE)
    bare = [coat for coat in coats if coat.color == palette.WORKSPACE]
    assert len(bare) == 1
    assert sum(map(_area, coats)) == pytest.approx(_lifted(solid), rel=1e-5)


def test_nothing_known_has_no_steps() -> None:
    assert painting.scale(np.full(4, np.nan), high=True, limits=(None, None)) is None


def test_good_values_have_the_same_end_of_the_colours() -> None:
    high = painting.Scale(np.linspace(0, 1, painting.STEPS + 1), True)
    low = painting.Scale(np.linspace(0, 1, painting.STEPS + 1), False)
    assert high.color(painting.STEPS - 1) == low.color(0) == palette.ramp_color(1.0)


def test_pieces_have_their_colours_and_the_locus_its_own() -> None:
    solid = _solid(pieces=(SimpleNamespace(sign=1), SimpleNamespace(sign=-1)))
    faces = len(solid.shaded.faces)
    solid.piece_of = np.arange(faces) % 2
    solid.on_locus = np.arange(faces) % 5 == 0
    coats = painting.pieces(solid, locus=True)
    colors = [coat.color for coat in coats]
    # The surface between them first: they are around it.
    assert colors == [palette.BEYOND, palette.aspect_color(1, 0), palette.aspect_color(-1, 0)]
    assert [coat.piece for coat in coats] == [None, 0, 1]
    assert [coat.shells for coat in coats] == [painting.LOCUS, painting.ASPECT, painting.ASPECT]
    assert [len(c.faces) for c in coats] == [
        int((solid.on_locus & (solid.piece_of == 0)).sum()),
        int((~solid.on_locus & (solid.piece_of == 0)).sum()),
        int((~solid.on_locus & (solid.piece_of == 1)).sum()),
    ]
    assert palette.BEYOND not in [coat.color for coat in painting.pieces(solid, locus=False)]


def test_aspects_are_told_from_limbs_and_from_each_other() -> None:
    shades = [color for colors in palette.ASPECTS.values() for color in colors]
    assert len(set(shades)) == len(shades)
    for shade in shades:  # grey beside any limb
        assert np.ptp(palette.rgb(shade)) < 70 < min(np.ptp(palette.rgb(c)) for c in palette.LIMBS)
