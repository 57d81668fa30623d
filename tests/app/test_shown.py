"""`machine.show()`: the page inside another program."""

from __future__ import annotations

import urllib.error
import urllib.request
import webbrowser

import pytest

import kinematics as kin
from kinematics.errors import InputError


@pytest.mark.slow  # processes are started for it
def test_a_machine_shows_itself_until_it_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    machine = kin.open("five-bar")
    page = machine.show([100.0, 700.0], "+-")
    try:
        assert page._page._view.review.pose == (100.0, 700.0)
        assert page._page._view.review.mode == "+-"
        with urllib.request.urlopen(page.url, timeout=30) as answer:
            held = answer.headers["Content-Security-Policy"].partition("frame-ancestors ")[2]
            assert "http://localhost:*" in held.split()
            assert answer.headers["X-Frame-Options"] is None
        assert page.url in page._repr_html_()
        assert "<iframe" in page._repr_html_()
    finally:
        page.close()
    assert "closed" in page._repr_html_()
    assert "closed" in repr(page)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(page.url, timeout=5)
    page.close()  # once more does no harm
    assert opened in ([page.url], [])


def test_what_it_cannot_show_is_refused() -> None:
    machine = kin.open("five-bar")
    with pytest.raises(InputError, match="mode"):
        machine.show(mode="+++")
    with pytest.raises(InputError, match="2 numbers"):
        machine.show([1.0])
