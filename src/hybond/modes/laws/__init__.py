"""The laws of junctions: which branches they take, decided together."""
