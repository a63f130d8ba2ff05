"""The equations of a mode: rows eliminated, bond variables, what is stored."""
