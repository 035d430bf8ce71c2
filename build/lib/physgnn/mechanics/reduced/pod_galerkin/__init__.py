"""Equilibrium in POD modes, over a few weighted cells."""
