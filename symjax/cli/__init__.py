"""The command line. Slow imports come after the file has been read, so that help and file errors appear at once."""
