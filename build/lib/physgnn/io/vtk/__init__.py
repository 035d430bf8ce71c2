"""VTK's own files: meshes, surfaces, series of results."""
