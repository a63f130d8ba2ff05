"""What `fuzz.py` is made of: changes of good inputs, readers, a judge."""
