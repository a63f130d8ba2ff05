"""Laws of junctions: the graph seen from them, and which branches they take."""
