"""How wrong a prediction may be: bounds that keep a promised coverage."""
