"""Values at points of a motion that is known: of the library alone."""
