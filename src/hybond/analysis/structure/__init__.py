"""What the structure of a mode says: controllability, observability, stiffness."""
