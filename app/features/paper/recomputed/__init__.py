"""The functions that recompute the items, a module a part of a paper; see `paper.registry`."""
