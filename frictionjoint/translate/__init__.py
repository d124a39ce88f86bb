"""Kernels translated: the front end reads annotated Python, printers write C.

``kinds``        types of kernels' values and what they are called in C
``expressions``  C text and type of an expression
``functions``    C text of a function and of all it calls
``c_math``       mathematics from exp, log and pow alone, for controllers
``unit``         one C file with all kernels of the package, and how to call each
``compiler``     a C compiler of this machine, or the one of ``ziglang``
``build``        the shared library, when the package is built and when a kernel has changed
"""
