"""The commands that run whole experiments on one resumable pipeline."""
