"""The command line: parse, call, print."""

from physgnn.cli.door import command, main

__all__ = ["command", "main"]
