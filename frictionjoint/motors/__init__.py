"""Identified motors that ship with the package, and parameter files of BAM.

``library``  the motors, each with source, licence and the residual of its fit
``bam``      reading and writing of BAM's JSON files
"""
