"""What rounding is measured by, and sums with all their digits."""
