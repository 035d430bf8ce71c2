"""What is measured of a shift, as rows that are linear in the displacement."""
