"""What a run is asked for and what ends it, the records that it writes, its state to go on from."""
