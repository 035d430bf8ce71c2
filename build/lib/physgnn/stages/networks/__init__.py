"""The commands that train and judge: train, evaluate, published."""
