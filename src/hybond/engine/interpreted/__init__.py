"""The engine as the ordinary Python that it is, where there is no library."""
