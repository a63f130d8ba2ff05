"""Impact laws: what contacts that are struck at one instant exchange."""
