"""Paths as spreadsheets and programs write them."""

from __future__ import annotations

from contextlib import suppress
from math import radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.features.trajectory.files import MOST, Points, read_points
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate

XY = (Coordinate("x", "x", "mm", -500.0, 500.0), Coordinate("y", "y", "mm", -500.0, 500.0))
TURN = (*XY, Coordinate("phi", "φ", "rad", -3.0, 3.0))
WANTED = ((-60.5, 250.0), (60.0, 250.25))


def read(text: str, axes: tuple[Coordinate, ...] = XY) -> Points:
    return read_points(text, axes, origin="way.csv")


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n-60.5,250\n60,250.25\n",
        "x,y\r\n-60.5,250\r\n60,250.25\r\n",
        "x,y\r-60.5,250\r60,250.25",
        "x,y\r-60.5,250\n60,250.25\r\n\n",
        "\ufeffx;y\n-60,5;250\n60;250,25\n",
        "x\ty\n-60,5\t250\n60\t250,25\n",
        "sep=;\nx;y\n-60,5;250\n60;250,25\n",
        "# a way\nx,y\n# its points\n\n-60.5,250\n60,250.25\n",
        "x,y\n\u221260.5,250\n60,250.25\n",
        "x_mm,y_mm\n-60.5,250\n60,250.25\n",
        "X [mm],Y [mm]\n-60.5,250\n60,250.25\n",
        "x (cm),y / m\n-6.05,0.25\n6,0.25025\n",
        "y,note,x\n250,a,-60.5\n250.25,b,60\n",
        'x,y\n"-60.5","250"\n"60","250.25"\n',
        "x,y,\n-60.5,250,\n60,250.25,\n",
        "x,y\n-60.5,250,,\n60,250.25,,\n",
    ],
)
def test_points_are_read_as_they_are_written(text: str) -> None:
    found = read(text)
    np.testing.assert_allclose(found.poses, WANTED, rtol=1e-12)
    assert found.times is None


@pytest.mark.parametrize(
    ("head", "factor"),
    [("t", 1), ("time", 1), ("t_s", 1), ("t [s]", 1), ("Time (s)", 1), ("time_ms", 1e-3)],
)
def test_times_are_read_under_their_usual_names(head: str, factor: float) -> None:
    found = read(f"{head},x,y\n1,0,0\n2.5,1,1\n")
    assert found.times == pytest.approx((factor, 2.5 * factor))


@pytest.mark.parametrize("head", ["phi", "phi_deg", "φ [°]", "phi (deg)"])
def test_angles_are_degrees_unless_they_say_otherwise(head: str) -> None:
    found = read(f"x,y,{head}\n0,0,30\n1,0,-30\n", TURN)
    assert found.poses[0][2] == pytest.approx(radians(30.0))
    turned = read("x,y,phi_rad\n0,0,0.5\n1,0,-0.5\n", TURN)
    assert turned.poses[0][2] == 0.5


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,y\n-60,5,250,25\n60,250\n", r"line 2: 2 columns are named, found 4; .*decimal commas"),
        ("x,y\n1,2\n3\n", "line 3: 2 columns are named, found 1"),
        ("x [furlong],y\n1,2\n3,4\n", "the column x is in 'furlong'; write mm, cm"),
        ("x,y\n1e308,2\n3,4\n", r"line 2: x must lie within ±1e\+09"),
        ("x,y\n1,nan\n3,4\n", "y must be a finite number"),
        ("x,y\n1,two\n3,4\n", "line 2: y must be a number, got 'two'"),
        (f"x,y\n{'1' * 200_000},2\n3,4\n", "line 2: not a line of cells"),
        ("", "must name a column x"),
        ("# nothing\n\n", "must name a column x"),
        ("x,y\n", "at least two points, found 0"),
        ("t,x,y\n2,0,0\n1,1,1\n", "line 3: t must increase"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(text)


@given(st.text(max_size=300))
def test_no_text_does_more_than_that(text: str) -> None:
    for head in ("", "x,y\n", "t;x;y\n"):
        with suppress(InputError):
            assert np.abs(read(head + text).poses).max() <= MOST


@pytest.mark.parametrize(
    ("said", "factor"),
    [
        ('units = "mm"', 1.0),
        ('units = "cm"', 10.0),
        ("# units: m", 1000.0),
        ("#units=inch", 25.4),
        ("# Unit = in", 25.4),
        ("# units: cm, degrees", 10.0),
        ("units = cm;;", 10.0),
        ("# a way in cm", 1.0),
        ("# a way\n\n# units: cm", 10.0),
    ],
)
def test_a_line_before_the_header_says_the_unit(said: str, factor: float) -> None:
    for first in ("", "\ufeff"):
        found = read(f"{first}{said}\nx,y\n-6,25\n6,25.5\n")
        assert np.array(found.poses) == pytest.approx(factor * np.array([[-6, 25], [6, 25.5]]))


def test_a_column_s_own_unit_goes_before_that_of_the_file_and_angles_have_none() -> None:
    found = read("units = m\nx [mm],y,phi\n60,0.25,10\n61,0.26,11\n", TURN)
    assert found.poses[0] == pytest.approx((60.0, 250.0, radians(10.0)))


@pytest.mark.parametrize("said", ["units = feet", "# units: millimetres", "units =", "units: 3"])
def test_an_unknown_unit_is_refused(said: str) -> None:
    with pytest.raises(InputError, match=r"way\.csv, line 1: units must be one of mm, cm, m, inch"):
        read(f"{said}\nx,y\n-6,25\n6,25.5\n")


def test_a_unit_below_the_header_says_nothing() -> None:
    assert read("x,y\n# units: m\n-6,25\n6,25.5\n").poses[0] == (-6.0, 25.0)
