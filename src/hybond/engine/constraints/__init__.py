"""What a mode holds stored quantities to, and the impulses that move them there."""
