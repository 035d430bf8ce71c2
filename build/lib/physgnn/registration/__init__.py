"""From what was measured in the operating theatre to the displacement everywhere."""
