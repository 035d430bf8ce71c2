"""What was planned on a scan, carried along: one file of a kind, one table of all."""
