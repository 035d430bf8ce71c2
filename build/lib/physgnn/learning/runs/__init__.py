"""A trained model on disk, and on another body."""
