"""The paper's Algorithm 1: end to end, choice by choice, and its Laplacian."""
