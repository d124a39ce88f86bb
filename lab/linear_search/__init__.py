"""The search for missing effects, beside a friction law that is linear in its coefficients.

Noise, weights, initial states and time offsets are fixed before it (`experiment`). Every candidate
is a set of columns (`columns`), a set of candidates has one score (`score`), and sets, not
sequences of decisions, are compared (`sets`). The parametric law is fitted last (`final_law`).
"""
