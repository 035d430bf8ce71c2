"""Command-line modules of 3D Slicer: their table, their XML, and what each does."""
