"""One reader a file format: bytes in, vertices and faces out."""
