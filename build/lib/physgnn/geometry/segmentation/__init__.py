"""From a label map to closed, nested surfaces."""
