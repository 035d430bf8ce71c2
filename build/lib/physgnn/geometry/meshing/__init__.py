"""From surfaces to tetrahedra of known quality."""
