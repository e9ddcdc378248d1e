"""The solids whose surfaces `symjax.datasets.generate` samples, as signed distance functions."""
