"""Surfaces: one short file a format, one table of all."""
