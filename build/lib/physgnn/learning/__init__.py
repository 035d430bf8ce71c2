"""Networks that predict displacement: graph, inputs, models, training, checkpoints."""
