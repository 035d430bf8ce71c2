"""Commands that learn and compare: datasets, training, materials, experiments."""
