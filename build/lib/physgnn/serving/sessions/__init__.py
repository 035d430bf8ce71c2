"""One browser: its loads solved in turn, and dropped when newer ones come."""
