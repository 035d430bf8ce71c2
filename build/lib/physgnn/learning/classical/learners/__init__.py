"""A load as a row of numbers, a displacement as what a row is answered by."""
