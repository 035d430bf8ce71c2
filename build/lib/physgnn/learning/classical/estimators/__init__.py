"""Learners of rows of numbers, written down as arrays."""
