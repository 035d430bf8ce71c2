"""The one exception that means "your input is wrong, and here is the remedy"."""


class InputError(ValueError):
    """Input that cannot be used.

    The message is one line: what was expected, what came, what to do. The command
    line prints it as it is and exits with code 2.
    """
