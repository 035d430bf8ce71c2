"""The network that corrects the asymptotic expansion."""
