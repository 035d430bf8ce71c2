"""What makes a surface fit to be meshed: its topology, crossings and repairs."""
