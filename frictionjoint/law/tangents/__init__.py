"""Exact derivatives of the laws along a motion, by forward differentiation of their source.

``along``          evaluates a law along a given motion, with its derivatives
``direction``      tangents: derivatives in several directions at once
``rules``          hand-written derivatives, where the source of a kernel does not show them
``generate``       the laws' steps with tangents, as source and as functions
``differentiate``  derives one kernel with tangents from its source
``activity``       which numbers of a kernel have a tangent
``particulars``    facts that the source of a kernel does not state
"""
