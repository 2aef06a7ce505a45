"""One-sided contact: a rod in space that may leave the cylinder, as a minimum of its energy."""
