"""Networks on a regular grid about the body, after Pfeiffer et al. 2019."""
