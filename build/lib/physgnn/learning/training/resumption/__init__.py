"""A training that a kill, a signal or a full disk ended goes on where it was."""
