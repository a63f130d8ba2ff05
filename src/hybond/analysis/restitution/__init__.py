"""Restitution derived from the compliance and resistance of a contact."""
