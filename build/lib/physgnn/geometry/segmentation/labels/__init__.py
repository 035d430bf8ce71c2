"""Which label is which tissue, by conventions or by names."""
