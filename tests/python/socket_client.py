"""A viewer without a browser: sends what browsers cannot be made to send."""

import base64
import json
import os
import socket
import struct
import time
from urllib.parse import parse_qs, urlsplit


class Closed(Exception):
    """The server has closed the connection; the code of its close frame, if there was one."""


def ask(port, head, seconds=10.0):
    """Sends bytes and gives all that comes back."""
    with socket.create_connection(("127.0.0.1", port), timeout=seconds) as connection:
        connection.sendall(head)
        answer = b""
        try:
            while part := connection.recv(65536):
                answer += part
        except ConnectionResetError:
            pass
        return answer


def status(port, head, **options):
    """The number in the first line of the answer; none where there is no answer."""
    words = ask(port, head, **options).split(b" ", 2)
    return int(words[1]) if len(words) > 1 else None


def get(path, host, fields=""):
    return f"GET {path} HTTP/1.1\r\nHost: {host}\r\n{fields}\r\n".encode()


def handshake(host, origin):
    key = base64.b64encode(os.urandom(16)).decode()
    origin = f"Origin: {origin}\r\n" if origin else ""
    return (f"{origin}Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {key}\r\n")


class Viewer:
    """A connected viewer."""

    def __init__(self, address):
        parts = urlsplit(address)
        host = parts.netloc
        self.connection = socket.create_connection((parts.hostname, parts.port), timeout=10)
        key = parse_qs(parts.query)["k"][0]
        self.connection.sendall(get(f"/live?k={key}", host, handshake(host, f"http://{host}")))
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self.buffer += self.connection.recv(4096)
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        assert head.startswith(b"HTTP/1.1 101 "), head
        self.inputs, self.held, self.values, self.time, self.paused, self.factor = {}, [], (), 0.0, True, 0.0
        self.failed = ""

    def send(self, message):
        self.frame(0x81, json.dumps(message).encode())

    def frame(self, first, payload):
        mask = os.urandom(4)
        size = len(payload)
        head = bytes([first, 0x80 | size]) if size < 126 else bytes([first, 0xFE]) + struct.pack(">H", size) \
            if size < 65536 else bytes([first, 0xFF]) + struct.pack(">Q", size)
        masked = bytes(b ^ mask[i % 4] for i, b in enumerate(payload))
        self.connection.sendall(head + mask + masked)

    def _take(self, count):
        while len(self.buffer) < count:
            part = self.connection.recv(65536)
            if not part:
                raise Closed(None)
            self.buffer += part
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def read(self):
        """Reads a frame; gives its kind."""
        first, size = self._take(2)
        if size == 126:
            size, = struct.unpack(">H", self._take(2))
        elif size == 127:
            size, = struct.unpack(">Q", self._take(8))
        payload = self._take(size)
        kind = first & 15
        if kind == 1:
            news = json.loads(payload)
            self.inputs.update(news.get("inputs", {}))
            self.held, self.failed = news["held"], news["failed"]
        elif kind == 2:
            flags, self.factor, self.time = struct.unpack("<Ifd", payload[:16])
            self.paused = bool(flags & 1)
            self.values = struct.unpack(f"<{(len(payload) - 16) // 4}f", payload[16:])
        elif kind == 8:
            raise Closed(struct.unpack(">H", payload[:2])[0])
        return kind

    def until(self, condition, seconds=20):
        """Reads on, with signs of life, until a condition holds."""
        end = time.monotonic() + seconds
        told = 0
        while not condition():
            assert time.monotonic() < end, (self.time, self.paused, self.inputs, self.held)
            if time.monotonic() - told > 0.5:
                told = time.monotonic()
                self.send({"alive": True})
            self.read()

    def close(self):
        self.connection.close()
