"""The same answer twice: one model run by two engines."""
