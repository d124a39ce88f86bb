"""From a log to parameters: rigid-body torque, prepared signals, least squares."""
