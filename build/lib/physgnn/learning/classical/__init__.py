"""Learners of the time before networks on meshes: what a new one is compared with."""
