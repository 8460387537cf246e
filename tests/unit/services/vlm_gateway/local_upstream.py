"""A real HTTP upstream on this machine that behaves, or misbehaves, as its script says."""

from __future__ import annotations

import contextlib
import json
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import cv2
import numpy as np

from services.vlm_gateway.config import UpstreamSettings

KEY = "sk-local-0123456789"


@dataclass(frozen=True)
class Answer:
    """One HTTP answer. delay_s: silence before it; drip_s: pause after each byte of the body."""

    status: int = 200
    body: bytes = b""
    headers: dict[str, str] = field(default_factory=dict)
    delay_s: float = 0.0
    drip_s: float = 0.0


@dataclass(frozen=True)
class Received:
    """One request as it came in."""

    path: str
    headers: dict[str, str]
    body: dict[str, Any]
    at: float


class LocalUpstream:
    """Gives its answers in turn, the last one again and again."""

    def __init__(self, port: int) -> None:
        self.base_url = f"http://127.0.0.1:{port}/v1"
        self.answers: list[Answer] = []
        self.received: list[Received] = []
        self.at_once = 0
        self.most_at_once = 0
        self.lock = threading.Lock()

    def script(self, *answers: Answer) -> None:
        self.answers = list(answers)

    def settings(self, **changes: Any) -> UpstreamSettings:
        values = {"name": "local", "base_url": self.base_url, "model": "tiny-vl", "api_key": KEY, **changes}
        return UpstreamSettings.model_validate(values)

    def next_answer(self) -> Answer:
        with self.lock:
            return self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]


@contextlib.contextmanager
def local_upstream() -> Iterator[LocalUpstream]:
    """A running upstream on a free port of the loopback interface."""
    server = _Server(("127.0.0.1", 0), _Handler)
    upstream = LocalUpstream(server.server_address[1])
    server.upstream = upstream
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    try:
        yield upstream
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def says(
    content: Any, finish: str = "stop", prompt_tokens: int = 40, output_tokens: int = 7, **more: Any
) -> Answer:
    """A chat completion with this content; other values than text are written as JSON."""
    text = content if isinstance(content, str) or content is None else json.dumps(content)
    choice = {"index": 0, "finish_reason": finish, "message": {"role": "assistant", "content": text}}
    usage = {"prompt_tokens": prompt_tokens, "completion_tokens": output_tokens}
    return Answer(
        body=json.dumps({"object": "chat.completion", "choices": [choice], "usage": usage}).encode(), **more
    )


def refuses(status: int, message: str = "", headers: dict[str, str] | None = None) -> Answer:
    """An error in OpenAI's form."""
    return Answer(status, json.dumps({"error": {"message": message}}).encode(), headers or {})


def picture(width: int, height: int, kind: str = ".jpg") -> bytes:
    """An encoded image of this size with something on it."""
    ramp = np.linspace(0, 255, width, dtype=np.uint8)
    pixels = np.repeat(ramp[None, :, None], height, axis=0).repeat(3, axis=2)
    _, data = cv2.imencode(kind, pixels)
    return data.tobytes()


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    upstream: LocalUpstream

    def handle_error(self, request: object, client_address: object) -> None:
        """Callers that hang up are part of the tests."""


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: _Server

    def do_POST(self) -> None:
        upstream = self.server.upstream
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        with upstream.lock:
            upstream.received.append(Received(self.path, dict(self.headers), body, time.monotonic()))
            upstream.at_once += 1
            upstream.most_at_once = max(upstream.most_at_once, upstream.at_once)
        try:
            self._give(upstream.next_answer())
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True
        finally:
            with upstream.lock:
                upstream.at_once -= 1

    def _give(self, answer: Answer) -> None:
        time.sleep(answer.delay_s)
        self.send_response(answer.status)
        for name, value in answer.headers.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(answer.body)))
        self.end_headers()
        if not answer.drip_s:
            self.wfile.write(answer.body)
            return
        for byte in answer.body:
            self.wfile.write(bytes([byte]))
            self.wfile.flush()
            time.sleep(answer.drip_s)

    def log_message(self, format: str, *args: Any) -> None:
        pass
