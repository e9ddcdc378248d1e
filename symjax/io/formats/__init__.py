"""symjax/io/formats."""
