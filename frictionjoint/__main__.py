"""`python -m frictionjoint`: the command line where the script's folder is not on the path."""

from .cli import main

main()
