"""`python -m videg`: the command-line tool."""

from ._cases import main

main()
