"""What programs for other rods load by entry points: exact references on a cylinder for cosseratbench."""
