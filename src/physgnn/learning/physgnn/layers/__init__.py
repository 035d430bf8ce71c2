"""What the published network is made of: convolutions, attention, dropout."""
