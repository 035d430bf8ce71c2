"""The published network, and what it needs."""
