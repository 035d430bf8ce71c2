"""Samples of a training: order, batches of several meshes, memory that they take."""
