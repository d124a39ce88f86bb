"""Friction laws as scalar kernels: the equations of the papers, no MuJoCo and no files.

``transition``  the transition curve Fd(z) and its inverse
``stribeck``    the sliding level S(v)
``relaxation``  the exact solution of dr/da = 1 - sgn(r) |r|**n
``memory``      the stacks of minima m and maxima M
``integrated``  one step of the integrated friction model (1997, and its 2002 modification)
``bristle``     layout common to the rival laws: ``static``, ``armstrong``, ``dahl`` (two laws),
                ``lugre``, ``elastoplastic``, ``maxwell_slip``, one file each
``kernel``      one entry to all laws
``motion``      a law driven along a given motion
``tangents``    the same with exact derivatives; its kernels are made from those here

Every law is a function on two flat float64 arrays, parameters ``P`` and state ``X``, with
offsets into both, so that the same machine code serves a NumPy array in identification and a
pointer into ``mjModel`` and ``mjData`` in simulation.
"""
