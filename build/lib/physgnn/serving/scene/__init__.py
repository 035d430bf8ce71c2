"""What the page draws, and how it is coloured and loaded."""
