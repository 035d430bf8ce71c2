"""A patient on show: the craniotomy, what was measured, and what is kept of it."""
