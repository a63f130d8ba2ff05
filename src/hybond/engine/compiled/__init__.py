"""The engine printed as one library, compiled, and called from Python."""
