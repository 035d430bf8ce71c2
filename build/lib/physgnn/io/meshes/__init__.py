"""Meshes that other programs made: cells, groups and sets as their files hold them."""
