"""In the operating theatre: from loads, or measurements, to a displacement."""
