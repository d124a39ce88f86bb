"""Undeclared effects of the catalogue, each built from MuJoCo parts or in the stepping loop.

Every module has NAME, `draw(rng, spec)` (parameters of a realistic size) and `build(parts, p)`.
"""
