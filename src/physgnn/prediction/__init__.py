"""Predictors: a load case in, a displacement with its error estimate out."""
