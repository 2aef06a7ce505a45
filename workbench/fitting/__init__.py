"""A fit: its input from files and text, its dataset for the figure, and the files that it writes."""
