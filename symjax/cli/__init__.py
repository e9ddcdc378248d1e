"""The command line. It imports nothing slow until a file has been read: help and file errors answer at once."""
