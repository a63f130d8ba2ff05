"""Sparse rows, LU, QR, singular values, blocks that grow."""
