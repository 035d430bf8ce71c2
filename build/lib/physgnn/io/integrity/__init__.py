"""Files whole or absent, and the digest of what a displacement depends on."""
