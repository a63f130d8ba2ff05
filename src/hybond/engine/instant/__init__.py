"""What happens at an instant: modes tried until none is left, what is told of it."""
