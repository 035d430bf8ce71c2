"""Nonlinear equilibrium: along a load path, from a warm start, or by full Newton."""
