"""From a displacement to scans, plans and errors as images."""
