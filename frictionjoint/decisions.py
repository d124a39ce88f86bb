"""Thresholds that decide which effects are named, and what the report says of them.

All other constants of the search set its resolution or its stopping point. The error of a friction
law, which weights samples at rest, is in `identify/weights.py`; the waves that logs can show in
`identify/search.py`.
"""

# rate of false alarms over the whole family of candidates, or of parameters that are compared
SIGNIFICANCE = 0.05
# fraction of random half-samples of the data that must choose an effect before others and none
MOSTLY = 0.5
# fraction of the residual sum of squares that a change must remove: an effect must be about as
# large as everything that remains unexplained, because no law is exact, and its error correlates
# with many effects. Changes that differ by less are compared once more.
SMALLEST_GAIN = 0.33
# torque that a change must move, over the friction's rms: no law is exact, and what is smaller is
# as likely the law's own error as an effect
LEAST_MOVED = 0.004
# the same of an effect of the drive, over the drive's rms: a dead band resembles friction. Where
# nothing is hidden, one that takes the least fraction of the squares moves 0.6% at most
LEAST_MOVED_OF_DRIVE = 0.007
# models within this fraction of the best one's gain explain as much, so that what promises less of
# simulated motion to first order is not tried; they are apart where one leaves half of what the
# other leaves
TIE, APART = 0.1, 0.5
# standard errors, or rms errors, beyond which something is more than chance
SURELY = 2.0
# part of an error that another law, or the motion without an effect, must take away, and part of a
# joint's squares that a cause may add to them: what chance or a few more parameters do not make
CLEARLY = 0.05
# K: a temperature that changes by less holds nothing but its sensor's flicker
LEAST_WARMING = 1.0
# what counts as explained: a residual up to this multiple of the instruments' noise, or, where that
# is unknown, one that is correlated for no longer than this multiple of filtered white noise
AT_THE_FLOOR, AS_WHITE = 1.5, 3.0
# noise over the drive, of 14 bits: a smaller estimate is none of an instrument's noise
LEAST_NOISE = 1e-4
