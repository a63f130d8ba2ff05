"""Which modes can follow each other, from which states, and whether time always goes on."""
