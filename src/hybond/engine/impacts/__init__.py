"""Impacts: what contacts that meet at one instant exchange, by laws that see all at once."""
