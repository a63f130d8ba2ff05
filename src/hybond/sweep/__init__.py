"""Many runs of one model, each with other parameters."""
