"""Identified motors that ship with the package, and parameter files of BAM.

``library``  the motors, each with source, licence and what its fit left
``bam``      BAM's JSON files, read and written
"""
