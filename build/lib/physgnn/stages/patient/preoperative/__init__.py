"""Before the operation: from a scan to a mesh, its loads and an adapted network."""
