"""The mechanics of the rod: potential, internal forces, contact force, frames."""
