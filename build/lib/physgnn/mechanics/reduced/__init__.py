"""Equilibrium in few unknowns: submodels, expansions, POD–Galerkin."""
