"""Load the live view's server, and print latencies and memory.

    python tests/faults/server_load.py --minutes 30 --clients 8 --rate 30

Every client sends patch loads, sections, releases and bad messages, in a seeded order.
Exit code 1 if a client was dropped or memory grew by more than a quarter after warming
up.
"""

import argparse
import asyncio
import json
import random
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
import psutil
from websockets.asyncio.client import connect

from physgnn.serving.protocol.frames import decode

PROGRAM = "from physgnn.cli import command; command()"
WARM_UP = 0.2  # of the time: caches fill
MOST_GROWTH = 1.25
BAD = ('{"type": "eval"}', "[" * 100, '{"type": "section", "axis": "x"}', "")


@dataclass
class Seen:
    """What the clients saw."""

    seconds: list[float] = field(default_factory=list)
    errors: int = 0
    dropped: list[str] = field(default_factory=list)
    resident: list[tuple[float, float, float]] = field(default_factory=list)


async def client(address: str, rate: float, end: float, seed: int, seen: Seen) -> None:
    """Send messages at a rate until the end, and time the predictions."""
    rng = random.Random(seed)
    async with connect(address, max_size=None, open_timeout=120) as socket:
        header, arrays = decode(await socket.recv())
        exposed = arrays["points"][arrays["exposed"] > 0]
        sent: dict[int, float] = {}
        reading = asyncio.create_task(read(socket, sent, seen))
        number = 0
        while time.monotonic() < end:
            number += 1
            kind = rng.random()
            if kind < 0.9:
                sent[number] = time.monotonic()
                await socket.send(patch_load(rng, number, exposed, header))
            elif kind < 0.95:
                axis = rng.choice(["sagittal", "coronal", "axial"])
                message = {"type": "section", "axis": axis, "offset_mm": 0.0}
                await socket.send(json.dumps(message))
            else:
                await socket.send(rng.choice(BAD))
            await asyncio.sleep(rng.expovariate(rate))
        reading.cancel()


def patch_load(
    rng: random.Random, number: int, exposed: np.ndarray, header: dict
) -> str:
    force = rng.random() * header["max_force_n"] * -np.array(header["normal"])
    return json.dumps(
        {
            "type": "patch_load",
            "id": number,
            "point": exposed[rng.randrange(len(exposed))].tolist(),
            "force_n": force.tolist(),
            "radius_mm": 2 + rng.random() * (header["max_radius_mm"] - 2),
            "predictors": header["predictors"][: rng.choice([1, 2])],
            "solve": rng.random() < 0.02,
        }
    )


async def read(socket, sent: dict[int, float], seen: Seen) -> None:
    async for content in socket:
        if isinstance(content, str):
            seen.errors += json.loads(content)["kind"] == "error"
            continue
        number = decode(content)[0].get("id")
        if number in sent:
            seen.seconds.append(time.monotonic() - sent[number])
            for old in [one for one in sent if one <= number]:
                del sent[old]


async def watch(process: psutil.Process, seen: Seen) -> None:
    start = time.monotonic()
    while True:
        below = 0
        for child in process.children(recursive=True):
            with suppress(psutil.Error):  # it ended meanwhile
                below += child.memory_info().rss
        sizes = (process.memory_info().rss / 1e6, below / 1e6)
        seen.resident.append((time.monotonic() - start, *sizes))
        await asyncio.sleep(1)


async def load(page: str, process: psutil.Process, given: argparse.Namespace) -> Seen:
    seen = Seen()
    end = time.monotonic() + 60 * given.minutes
    watching = asyncio.create_task(watch(process, seen))
    live = page.replace("http", "ws") + "/live"
    clients = [client(live, given.rate, end, i, seen) for i in range(given.clients)]
    for result in await asyncio.gather(*clients, return_exceptions=True):
        if isinstance(result, BaseException):
            seen.dropped.append(repr(result))
    watching.cancel()
    return seen


def report(seen: Seen, minutes: float) -> int:
    late = [mb for s, mb, _ in seen.resident if s > WARM_UP * 60 * minutes]
    below = max(mb for _, _, mb in seen.resident)
    half = len(late) // 2
    before, after = np.median(late[:half] or [0]), np.median(late[half:] or [0])
    for share in (0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0):
        s, mb, others = seen.resident[round(share * (len(seen.resident) - 1))]
        print(f"after {s:6.0f} s: {mb:6.0f} MB, and {others:.0f} MB in its processes")
    p50, p95, p99 = 1e3 * np.percentile(seen.seconds or [np.nan], [50, 95, 99])
    print(
        f"{len(seen.seconds)} predictions, p50 {p50:.0f} ms, p95 {p95:.0f} ms, "
        f"p99 {p99:.0f} ms; {seen.errors} errors reported; memory "
        f"{seen.resident[0][1]:.0f} MB at first, {before:.0f} and {after:.0f} MB in "
        f"the halves after warming up, {max(late, default=0):.0f} MB at most, "
        f"{below:.0f} MB at most in its processes; "
        f"clients dropped: {seen.dropped or 'none'}"
    )
    return int(bool(seen.dropped) or not seen.seconds or after > MOST_GROWTH * before)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--clients", type=int, default=8)
    parser.add_argument(
        "--rate", type=float, default=30.0, help="messages a second, each"
    )
    given = parser.parse_args()
    server = subprocess.Popen(
        [sys.executable, "-u", "-c", PROGRAM, "view", "--port", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        line = ""
        while "http://" not in line:
            line = server.stdout.readline()
            if not line:
                raise SystemExit("the server did not start")
        page = line[line.index("http://") :].split()[0]
        seen = asyncio.run(load(page, psutil.Process(server.pid), given))
    finally:
        server.terminate()
        code = server.wait(30)
    print(f"the server ended with exit code {code}")
    return report(seen, given.minutes)


if __name__ == "__main__":
    sys.exit(main())
