"""What a model is: elements, junctions, bonds, machines, signals; the builder; the flat graph."""
