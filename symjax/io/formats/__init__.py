"""One reader per file format, from bytes to points or to vertices and faces."""
