"""Laws that are not linear: Newton's method, and where it begins."""
