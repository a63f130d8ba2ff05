"""What is worth a second look in a model that means something: hints, which are no errors."""
