"""The command line: parse, call, print."""

from physgnn.cli.app import main

__all__ = ["main"]
