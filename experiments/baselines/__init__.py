"""Other methods, each in a file of its own and faithful to its publication."""
