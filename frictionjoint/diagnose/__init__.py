"""What the model lacks: residual, trace, the loop."""
