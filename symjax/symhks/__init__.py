"""The paper's Algorithm 1: correspondences by heat kernel signatures and eigenfunction signs, then L2E."""
