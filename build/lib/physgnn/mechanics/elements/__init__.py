"""Tetrahedra: internal force, energy and tangent of the two elements there are."""
