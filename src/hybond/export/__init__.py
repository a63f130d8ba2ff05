"""Models as text that runs without hybond: C, Java and other languages."""
