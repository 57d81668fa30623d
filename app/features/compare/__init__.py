"""Designs side by side: the present one is A."""

LETTERS = "ABCD"
