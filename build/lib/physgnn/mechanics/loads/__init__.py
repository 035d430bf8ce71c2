"""Nodal forces and paths of them, pressure, gravity, prescribed displacements."""
