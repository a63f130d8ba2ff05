"""Inputs piece after piece, sampled signals, and what is asked of others."""
