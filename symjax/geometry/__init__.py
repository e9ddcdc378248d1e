"""symjax/geometry."""
