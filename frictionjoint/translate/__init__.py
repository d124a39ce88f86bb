"""Kernels translated: one front end reads annotated Python, printers write C and Warp.

``kinds``          types of kernels' values and what they are called in C
``plain``          statements brought into a plainer form
``kernel``         a kernel's statements and the kind of every value; derivatives start from it, too
``c_expressions``  C text of an expression
``c_functions``    C text of a function and of all it calls
``c_math``         mathematics from exp, log and pow alone, for controllers
``warp``           the same functions as Warp takes them
``unit``           one C file with all kernels of the package, and how to call each
``compiler``       a C compiler of this machine, or the one of ``ziglang``
``build``          the shared library, when the package is built and when a kernel has changed
"""
