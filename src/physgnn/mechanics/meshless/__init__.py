"""Load paths without elements: total Lagrangian explicit dynamics brought to rest."""
