"""The command that makes a material of what was measured: fit-material."""
