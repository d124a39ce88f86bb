"""Exact derivatives of the laws along a motion, by forward differentiation of their source.

``along``          a law driven along a given motion, with its derivatives
``direction``      tangents: derivatives in several directions at once
``kernels``        the laws' kernels with tangents
``drive``          source of those that drive a law along a motion
``rules``          derivatives that the source of a kernel does not show
``generate``       source of the others
``differentiate``  one kernel with tangents, from its source
``activity``       which numbers of a kernel have a tangent
``terms``          sums of tangents, as source
"""
