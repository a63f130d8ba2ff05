"""The native kernel: what the reference does, only faster; it declines what it was not made for."""
