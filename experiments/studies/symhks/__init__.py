"""Studies of Sym-HKS, the paper's Algorithm 1: the effect of each choice, and its Laplacian."""
