"""Translation of kernels: one front end reads annotated Python, back ends write C and Warp."""
