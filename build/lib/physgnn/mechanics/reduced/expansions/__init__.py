"""Solutions expanded about reference states, and which of these is nearest."""
