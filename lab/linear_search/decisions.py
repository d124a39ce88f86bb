"""The numbers that decide what the search names, each with its reason."""

# Largest chance, over the whole family of candidates, that random signs explain as much: the usual
# rate of false alarms.
SIGNIFICANCE = 0.05
# Part of the squares left without an effect that it must explain. No law is exact, and what one
# leaves resembles some effect or other; a real effect is about as large as the law's error.
NEEDED_PART = 0.33
# The same of effects that resemble the law's own error at low speed and at rest.
NEEDED_OF_LAW_LIKE = 0.5
# The same beside an effect of the drive, which is far larger than friction and never held exactly.
NEEDED_BESIDE_DRIVE = 0.67
# Torque over the rms of friction below which nothing is named: laws are not better known.
LEAST_TORQUE = 0.0045
# Torque over the rms of friction, and standard errors of the gain, from which an effect is named
# whatever else is left: an error of a law that large would show elsewhere.
CLEAR_TORQUE, CLEAR_ERRORS = 0.015, 3.0
# Standard errors by which an effect's size must differ from nothing: else it is not determined.
DETERMINED = 2.0
# Part of the squares by which a model must beat another that is as simple, for the logs to
# distinguish them. Less is a tie.
APART = 0.5
# Squares over the least at which a model with fewer numbers is preferred.
AS_GOOD = 1.1
# Error of the law at rest and at reversals, over its level: what laws leave of other laws there.
LAW_ERROR = 0.05
