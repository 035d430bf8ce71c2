"""``python -m physgnn`` is the command ``physgnn``."""

from physgnn.cli import main

if __name__ == "__main__":
    main()
