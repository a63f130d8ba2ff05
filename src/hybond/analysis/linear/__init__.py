"""Models linearised at a point, and switched models asked for their frequency response."""
