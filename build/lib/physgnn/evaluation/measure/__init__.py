"""Predictors on held-out samples: errors, bounds, baselines."""
