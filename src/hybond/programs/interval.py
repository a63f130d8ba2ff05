"""What is constant between two timed events, for those who still look for it here."""

from hybond.model.interval import Interval, discrete_names, discrete_values, interval_after

__all__ = ["Interval", "discrete_names", "discrete_values", "interval_after"]
