"""What a run of the library gives: segments, events, reasons, signals."""
