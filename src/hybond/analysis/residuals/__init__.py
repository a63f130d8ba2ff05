"""Relations among sensors and sources that hold in every mode, for diagnosis."""
