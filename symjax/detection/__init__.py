"""symjax/detection."""
