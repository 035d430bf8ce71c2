"""Networks on meshes from the literature, as peers: MeshGraphNets and Transolver."""
