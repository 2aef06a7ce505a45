"""What a file holds: the description of files, and a stored study that is asked once."""
