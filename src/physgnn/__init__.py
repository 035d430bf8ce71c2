"""Real-time prediction of brain deformation."""
