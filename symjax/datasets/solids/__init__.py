"""symjax/datasets/solids."""
