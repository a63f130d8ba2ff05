"""Steps by rates alone: Dormand and Prince, Runge and Kutta, Euler."""
