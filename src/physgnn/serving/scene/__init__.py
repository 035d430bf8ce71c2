"""What the page draws, and what it is coloured and pushed by."""
