"""An error of ours: the traceback goes to a file, one line to the user."""

import platform
import sys
import tempfile
import traceback

from physgnn.versions import release


def write_report(error: Exception) -> str:
    """Write what is needed to find the error; return the line that names the file."""
    what = " ".join(f"{type(error).__name__}: {error}".split())[:200]
    text = "\n".join(
        [
            f"physgnn {release('physgnn')}, Python {platform.python_version()}",
            platform.platform(),
            "arguments: " + repr(sys.argv[1:]),
            "".join(traceback.format_exception(error)),
        ]
    )
    try:
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", prefix="physgnn-error-", suffix=".txt", delete=False
        ) as file:
            file.write(text)
    except OSError:
        return f"an error in physgnn itself ({what}); no report could be written"
    return f"an error in physgnn itself ({what}): please report it with {file.name}"
