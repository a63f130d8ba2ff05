"""The linear complementarity system of a model whose junctions have laws."""
