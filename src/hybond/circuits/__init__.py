"""Circuits and bond graphs from the files of other tools: SPICE netlists, BondGraphTools."""
