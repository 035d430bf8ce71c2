"""What stands before every route: who may ask, how many, and what the page may do.

The server listens on this machine only, but any page that is open in the user's browser
can send requests to it. So the host must be this machine by name (a page elsewhere may
have a name that resolves to it), and the origin, which browsers send and scripts cannot
change, must be this server's own.
"""

import base64
import hashlib
import re
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

HOSTS = ("127.0.0.1", "localhost", "::1")
POLICY_VIOLATION, TRY_LATER = 1008, 1013  # of RFC 6455 and the IANA registry
INLINE = re.compile(r'<script type="importmap">(.*?)</script>', re.DOTALL)


class Guard:
    """Refuse who is not this server's own page or a program on this machine.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    page : str
        The page's HTML, whose import map is the only inline script allowed.
    most_sessions : int
        So many WebSockets at once; the next is refused.
    """

    def __init__(self, app: ASGIApp, page: str, most_sessions: int) -> None:
        self._app = app
        self._headers = _headers(page)
        self._free = most_sessions

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] == "websocket":
            await self._socket(scope, receive, send)
        elif scope["type"] == "http":
            await self._request(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    async def _request(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self._headers)
            await send(message)

        refusal = _refusal(Headers(scope=scope))
        if refusal is None:
            await self._app(scope, receive, with_headers)
        else:
            status, text = refusal
            answer = PlainTextResponse(text + "\n", status)
            await answer(scope, receive, with_headers)

    async def _socket(self, scope: Scope, receive: Receive, send: Send) -> None:
        refusal = _refusal(Headers(scope=scope))
        if refusal is not None or self._free == 0:
            code = TRY_LATER if refusal is None else POLICY_VIOLATION
            await send({"type": "websocket.close", "code": code})
            return
        self._free -= 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._free += 1


def _refusal(headers: Headers) -> tuple[int, str] | None:
    """Return status and reason if a request must not be answered."""
    hosts, origins = headers.getlist("host"), headers.getlist("origin")
    if len(hosts) != 1 or _name(hosts[0]) not in HOSTS:
        return 400, "this server answers to 127.0.0.1 and localhost only"
    if len(origins) > 1 or any(origin != f"http://{hosts[0]}" for origin in origins):
        return 403, "only this server's own page may ask"
    return None


def _name(host: str) -> str | None:
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None


def _headers(page: str) -> dict[str, str]:
    hashes = "".join(
        f" 'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
        for text in INLINE.findall(page)
    )
    policy = {
        "default-src": "'none'",
        "script-src": f"'self'{hashes}",
        "style-src": "'self'",
        "img-src": "'self' blob:",
        "connect-src": "'self'",
        "base-uri": "'none'",
        "form-action": "'none'",
        "frame-ancestors": "'none'",
    }
    return {
        "Content-Security-Policy": "; ".join(f"{k} {v}" for k, v in policy.items()),
        "X-Content-Type-Options": "nosniff",
        "X-Frame-Options": "DENY",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cross-Origin-Opener-Policy": "same-origin",
        # an updated package shows its own page
        "Cache-Control": "no-cache",
    }
