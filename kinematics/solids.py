"""Solids by manifold3d and their files by trimesh; the only module that imports either."""
