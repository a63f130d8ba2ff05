"""The engine as one compiled library for all models, and runs by it."""
