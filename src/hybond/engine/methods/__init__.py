"""One step, by Dormand and Prince or by Radau IIA; tolerances."""
