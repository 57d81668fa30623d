"""Exceptions whose messages a person can act on.

An unreachable pose is not one of these: it is a normal answer that carries its reasons.
"""


class BohemiaError(Exception):
    """Base of everything that Bohemia raises on purpose; the message is one clear sentence."""


class InputError(BohemiaError):
    """A value that was handed in is wrong; the message says which, and what would be right."""


class DesignError(InputError):
    """A design file or table is broken; the message names the file, the key and the remedy."""


class ComputationError(BohemiaError):
    """The input is fine, but the result could not be computed; the message says why."""
