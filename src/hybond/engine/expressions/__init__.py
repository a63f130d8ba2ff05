"""Expressions of the model: functions, and pairs of a finite part and an impulse."""
