"""Simulated motion of a fitted model: free runs from measured states, whole logs in closed loop."""
