"""What happens at an instant: trying modes, jumps, what is told of it."""
