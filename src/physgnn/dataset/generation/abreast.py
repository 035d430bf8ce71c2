"""Work on load paths side by side in this process, each in a thread of its own."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed

NAME = "load path"
Do = Callable[[int], tuple[str, str]]


def side_by_side(
    do: Do, paths: list[int], abreast: int, stop: Callable[[], object]
) -> Iterator[tuple[int, str, str]]:
    """Do paths, some at once, and yield the results as they come.

    Parameters
    ----------
    do : callable
        From a path to how it ended and the error, empty if none.
    paths : list of int
    abreast : int
        How many at once.
    stop : callable
        Makes those that are being done end soon; called when nobody wants the rest.

    Raises
    ------
    Exception
        What `do` raises; the other paths are then stopped.
    """
    threads = ThreadPoolExecutor(abreast, thread_name_prefix=NAME)
    try:
        path_of = {threads.submit(do, i): i for i in paths}
        for future in as_completed(path_of):
            yield path_of[future], *future.result()
    except BaseException:
        stop()
        raise
    finally:
        threads.shutdown(cancel_futures=True)
