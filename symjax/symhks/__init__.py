"""The paper's Algorithm 1: mirror pairs by heat kernel signatures and signs of eigenfunctions, then L2E on them."""
