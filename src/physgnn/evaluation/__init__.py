"""Errors of predictors on held-out samples: tables, figures and a report."""
