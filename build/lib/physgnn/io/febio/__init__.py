"""FEBio's models, logs and runs."""
