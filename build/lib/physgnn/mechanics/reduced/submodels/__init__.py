"""A few cells of a body, solved by themselves."""
