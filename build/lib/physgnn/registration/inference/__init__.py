"""From rows of measurements to the most probable displacement and its spread."""
