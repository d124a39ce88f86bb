"""The claims of Ganseman et al. (1997), each a figure and numbers: one file a claim.

A module here offers ``claim() -> Claim``; lab/tests/test_paper.py holds the numbers to account.
"""
