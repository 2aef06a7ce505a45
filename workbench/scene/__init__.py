"""PyVista scenes: a cylinder and the tube of a rod on it."""
