"""The first instant of a step at which a guard holds."""
