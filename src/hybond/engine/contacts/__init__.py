"""Contacts: impacts that accumulate, landing, rest."""
