"""What can be told about a model without running it: structure, mode by mode."""
