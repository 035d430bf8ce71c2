"""Surrogates that learn nothing: what everything that learns is shown beside."""
