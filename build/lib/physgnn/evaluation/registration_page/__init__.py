"""One page about one registration: what was measured, what came of it, how sure."""
