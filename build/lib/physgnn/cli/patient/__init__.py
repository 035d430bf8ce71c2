"""Commands about one patient, or a table of them."""
