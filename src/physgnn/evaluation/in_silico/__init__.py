"""Registrations in silico: shifts simulated and measured, and what finds them."""
