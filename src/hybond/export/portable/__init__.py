"""The runtime of exported programs, in the small Python that is printed as C and as Java."""
