"""Sym-HKS, the method of the paper: mirror pairs from heat kernel signatures, then the plane of the pairs."""
