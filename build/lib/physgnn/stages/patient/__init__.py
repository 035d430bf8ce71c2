"""The commands of one patient: mesh, adapt, predict, register, warp, view."""
