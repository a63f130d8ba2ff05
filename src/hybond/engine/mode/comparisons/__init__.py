"""Comparisons and rates that are sums of the state; what stands at an equilibrium."""
