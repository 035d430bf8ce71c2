"""Cases made from the bundled brain: one with a tumour, and a family of anatomies."""
