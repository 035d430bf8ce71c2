"""The commands that make datasets: simulate, import, export, anatomies."""
