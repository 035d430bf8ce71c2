"""From a dataset to trained weights."""
