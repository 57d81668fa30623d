"""What is drawn only when something that it depends on has changed."""

from __future__ import annotations

from app.widgets.once import Once


def test_it_draws_again_only_for_other_arguments() -> None:
    drawn: list[tuple[object, ...]] = []

    def draw(*of: object, shown: bool) -> None:
        drawn.append((*of, shown))

    once = Once(draw)
    once("a", (1, 2), shown=True)
    once("a", (1, 2), shown=True)
    once("a", (1, 2), shown=False)
    once("a", (1, 3), shown=False)
    once("a", (1, 2), shown=True)
    assert drawn == [
        ("a", (1, 2), True),
        ("a", (1, 2), False),
        ("a", (1, 3), False),
        ("a", (1, 2), True),
    ]
