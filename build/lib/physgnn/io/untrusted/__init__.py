"""What reads a stranger's bytes: sizes first, then contents, and one kind of error."""
