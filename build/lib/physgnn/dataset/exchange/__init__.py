"""Datasets to and from other programs."""
