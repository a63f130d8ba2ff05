"""Blocks of signals that come from elsewhere: functional mock-up units."""
