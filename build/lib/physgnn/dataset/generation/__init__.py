"""Load paths solved, here or on many machines, and checked."""
