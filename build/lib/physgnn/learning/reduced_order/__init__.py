"""Models without weights to train: local expansions, POD–Galerkin."""
