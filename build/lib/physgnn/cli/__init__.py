"""The command line: parse, call, print."""

from physgnn.cli.door import main

__all__ = ["main"]
