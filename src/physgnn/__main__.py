"""``python -m physgnn`` is the command ``physgnn``."""

from physgnn.cli import command

if __name__ == "__main__":
    command()
