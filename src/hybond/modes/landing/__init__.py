"""Accumulation of impacts: seen, landed on, at rest."""
