"""Pictures of anything that has points, a plane and pairs: an interactive page, and a raster image."""
