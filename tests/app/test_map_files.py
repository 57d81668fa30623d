"""Maps as files: read back, they are the map; a figure says what it shows."""

from __future__ import annotations

import csv
import io
import re
import warnings
from typing import Any

import imageio.v3 as imageio
import numpy as np
import pytest

from app.features.map.files import FORMATS, map_bytes, map_figure
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.facets.map_sweeps import Map, map_request

DESIGN = load_design("rpur-table1")
ALL = ("volume", "pieces", "largest_piece", "sphere", "stroke")
TWO = ("volume", "pieces")


def made(
    first: Any, second: Any, *, done: Any = True, quantities: Any = ALL, modes: Any = None
) -> Map:
    """A map of a formula; the workspace is empty where φ is large."""
    request = map_request(
        DESIGN, np.radians(first), np.radians(second), quantities=quantities, modes=modes
    )
    phi, theta = np.meshgrid(request.first, request.second, indexing="ij")
    there = np.maximum(np.cos(2 * phi) * np.cos(theta), 0.0)
    whole = [2e7 * there, np.ceil(3 * there), 1.5e7 * there, 80 * there, 100 * there]
    values = np.stack([whole[ALL.index(quantity.key)] for quantity in request.quantities])
    done = np.broadcast_to(done, there.shape).copy()
    values[:, ~done] = np.nan
    return Map(request, values, values * 1e-5, done)


GRID = made(np.linspace(-90, 90, 13), np.linspace(-45, 45, 9))
_DONE = [[True, False], [False, False], [True, True]]
PART = made([-10, 0, 10], [0, 5], done=_DONE, quantities=TWO)


def test_a_csv_begins_with_the_columns_that_scripts_rely_on() -> None:
    text = map_bytes(made([0, 1], [0], quantities=["volume"]), "csv").decode()
    assert text.splitlines()[0] == "phi_deg,theta_deg,volume_mm3,error_mm3"


def test_a_csv_loses_nothing() -> None:
    rows = list(csv.DictReader(io.StringIO(map_bytes(GRID, "csv").decode())))
    assert list(rows[0]) == [
        *("phi_deg", "theta_deg", "volume_mm3", "error_mm3", "pieces", "pieces_error"),
        *("largest_piece_mm3", "largest_piece_error_mm3", "sphere_mm", "sphere_error_mm"),
        *("stroke_percent", "stroke_error_percent"),
    ]
    assert len(rows) == 13 * 9
    assert [float(row["theta_deg"]) for row in rows[:2]] == [-45.0, -33.75]
    assert {float(row["phi_deg"]) for row in rows} == set(np.linspace(-90, 90, 13))
    for name, values in zip(
        ("volume_mm3", "pieces", "largest_piece_mm3", "sphere_mm", "stroke_percent"),
        GRID.values,
        strict=True,
    ):
        assert [float(row[name]) for row in rows] == values.ravel().tolist()
    assert [float(row["error_mm3"]) for row in rows] == GRID.errors[0].ravel().tolist()


def test_a_csv_has_only_what_is_done() -> None:
    rows = list(csv.DictReader(io.StringIO(map_bytes(PART, "csv").decode())))
    places = [(float(row["phi_deg"]), float(row["theta_deg"])) for row in rows]
    assert places == [(-10.0, 0.0), (10.0, 0.0), (10.0, 5.0)]


@pytest.mark.parametrize(
    "found", [GRID, PART, made([3], [4], modes=["+++++"])], ids=["grid", "part", "point"]
)
def test_an_npz_is_the_map(found: Map) -> None:
    with np.load(io.BytesIO(map_bytes(found, "npz")), allow_pickle=False) as arrays:
        np.testing.assert_allclose(np.radians(arrays["phi_deg"]), found.request.first, atol=1e-12)
        np.testing.assert_allclose(
            np.radians(arrays["theta_deg"]), found.request.second, atol=1e-12
        )
        np.testing.assert_array_equal(arrays["volume_mm3"], found.values[0])
        np.testing.assert_array_equal(arrays["error_mm3"], found.errors[0])
        np.testing.assert_array_equal(arrays["pieces"], found.values[1])
        np.testing.assert_array_equal(arrays["done"], found.done)
        assert arrays["design"] == "rpur-table1"
        assert "".join(arrays["modes"].ravel()) == (
            "all" if found.request.modes is None else "+++++"
        )


def test_other_formats_are_refused() -> None:
    with pytest.raises(InputError, match="csv, npz, png, svg"):
        map_bytes(GRID, "pdf")


# --- figures -------------------------------------------------------------------------------


def test_a_figure_names_its_axes_units_design_and_modes() -> None:
    wanted = ("volume", "pieces", "stroke")
    found = made([0, 5, 10], [0, 5], modes=["+-+-+"], quantities=wanted)
    svg = map_bytes(found, "svg").decode()
    texts = set(re.findall(r"<text[^>]*>([^<]*)</text>", svg))
    assert {"φ (degrees)", "θ (degrees)", "Volume (10⁶ mm³)", "Number of pieces"} <= texts
    assert "Share of the stroke used, least of the limbs (%)" in texts
    assert {"General 5-RPUR, Table 1 (journal)", "working mode +−+−+"} <= texts


def test_a_figure_says_that_it_is_not_whole() -> None:
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", map_bytes(PART, "svg").decode())
    assert any("3 of 6 orientations" in text for text in texts)
    whole = map_bytes(made([0, 5], [0, 5], quantities=["volume"]), "svg").decode()
    assert "orientations" not in whole


def test_cells_are_coloured_by_their_values_and_empty_ones_are_white() -> None:
    found = made(np.linspace(-60, 60, 5), np.linspace(-40, 40, 5), quantities=["volume"])
    figure = map_figure(found)
    figure.set_dpi(100)
    written = io.BytesIO()
    figure.savefig(written, format="png", dpi=100)
    picture = np.asarray(imageio.imread(written.getvalue()))[..., :3].astype(int)
    panel = figure.axes[0]

    def at(phi: float, theta: float) -> Any:
        x, y = panel.transData.transform((phi, theta))
        return picture[picture.shape[0] - 1 - round(y), round(x)]

    assert found.values[0, 0, 2] == 0.0
    assert at(-60, 0).tolist() == [255, 255, 255]
    bright = [at(phi, theta).sum() for phi, theta in ((-30, -40), (-30, 0), (0, 0))]
    assert bright == sorted(bright)
    assert len(set(bright)) == 3


GRIDS: dict[str, dict[str, Any]] = {
    "grid": {"first": np.linspace(-60, 60, 9), "second": np.linspace(-45, 45, 8)},
    "row": {"first": [0], "second": np.linspace(0, 30, 4)},
    "column": {"first": np.linspace(0, 30, 4), "second": [0]},
    "point": {"first": [0], "second": [0]},
    "empty": {"first": np.linspace(80, 90, 9), "second": np.linspace(0, 9, 9)},
    "backwards": {"first": [30, 0, -30], "second": [1, 2]},
    "part": {"first": [-10, 0, 10], "second": [0, 5], "done": _DONE},
    "none done": {"first": [-10, 0, 10], "second": [0, 5], "done": False},
}


@pytest.mark.parametrize("options", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("kind", FORMATS)
def test_every_map_can_be_written_without_a_warning(options: Any, kind: str) -> None:
    found = made(**options, quantities=TWO)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        data = map_bytes(found, kind)
    starts = {"csv": b"phi_deg,", "npz": b"PK", "png": b"\x89PNG", "svg": b"<?xml"}
    assert data.startswith(starts[kind])


def test_the_same_map_gives_the_same_picture() -> None:
    assert map_bytes(PART, "svg") == map_bytes(PART, "svg")


def test_many_cells_become_one_picture_in_an_svg() -> None:
    many = made(np.linspace(-90, 90, 121), np.linspace(-90, 90, 121), quantities=["volume"])
    assert len(map_bytes(many, "svg")) < 2e6
