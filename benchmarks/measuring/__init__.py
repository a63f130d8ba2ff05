"""What the speed table is measured with."""
