"""Translation of kernels: one front end reads annotated Python, back ends write C and Warp.

``kinds``              types of the values in kernels, and their names in C
``simple_statements``  rewrites statements in a simpler form
``kernel``             statements of a kernel and the kind of every value; derivatives use it too
``c_expressions``      C text of an expression
``c_functions``        C text of a function and of all functions that it calls
``c_math``             mathematical functions from exp, log and pow alone, for controllers
``warp``               the same functions for Warp
``c_file``             one C file with all kernels of the package, and the signature of each
``compiler``           a C compiler of this machine, or the one in ``ziglang``
``build``              builds the shared library with the package, and again after a kernel changes
"""
