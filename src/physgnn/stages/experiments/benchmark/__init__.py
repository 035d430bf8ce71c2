"""Every method on the same tasks: their data, made once, and the command."""
