"""Identified motors that ship with the package, and parameter files of BAM."""
