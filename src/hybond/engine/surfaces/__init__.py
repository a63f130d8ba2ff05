"""What is asked of a mode, asked of those around surfaces together while machines slide."""
