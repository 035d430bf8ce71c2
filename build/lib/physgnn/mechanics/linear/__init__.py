"""The tangent matrix factorised, and linear elasticity about the rest state."""
