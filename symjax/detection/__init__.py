"""`detect` runs a method on a point cloud and returns a `Detection`, which can be saved, loaded and drawn."""
