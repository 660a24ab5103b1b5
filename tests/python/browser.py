"""Drives Debian's Chromium, headless and with software WebGL, through the DevTools protocol on a pair of pipes.

Nothing but the standard library is needed. A page that reports an error or asks for anything outside of itself is
told by `Page.close`, which each test calls by leaving the `with` block.
"""

import base64
import itertools
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections import deque
from pathlib import Path
from select import select

import pytest

NAMES = "chromium", "chromium-browser", "google-chrome"

KEYS = {
    " ": ("Space", 32), "ArrowLeft": ("ArrowLeft", 37), "ArrowRight": ("ArrowRight", 39), "Home": ("Home", 36),
    "End": ("End", 35), "Tab": ("Tab", 9), "Enter": ("Enter", 13), "Backspace": ("Backspace", 8), ".": ("Period", 190),
}


class Failed(Exception):
    """What the browser says is wrong."""


class Browser:
    """A browser of its own, with a profile that goes when it ends."""

    def __init__(self, *options):
        name = next(filter(None, map(shutil.which, NAMES)), None)
        if name is None:
            pytest.skip("no chromium; on Debian: apt install chromium")
        self.profile = tempfile.mkdtemp(prefix="urdf2fmu-browser-")
        out, self.to = os.pipe()
        self.by, back = os.pipe()

        def pipes():
            # The protocol's places: 3 to read, 4 to write.
            kept = os.dup(out), os.dup(back)
            os.dup2(kept[0], 3)
            os.dup2(kept[1], 4)

        self.process = subprocess.Popen(
            [name, "--headless=new", "--remote-debugging-pipe", f"--user-data-dir={self.profile}", "--no-first-run",
             "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--hide-scrollbars", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--no-default-browser-check", *options, "about:blank"],
            preexec_fn=pipes, pass_fds=(3, 4) if out in (3, 4) else (), close_fds=False,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(out)
        os.close(back)
        self.numbers = itertools.count(1)
        self.buffer = b""
        self.events = deque()

    def send(self, method, session=None, **parameters):
        """A call without waiting for its answer; gives its number."""
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        return number

    def read(self, seconds):
        """The next message; none where there is none in time."""
        while b"\0" not in self.buffer:
            if not select([self.by], [], [], seconds)[0]:
                return None
            part = os.read(self.by, 1 << 20)
            if not part:
                raise Failed("the browser has ended")
            self.buffer += part
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, session=None, seconds=60, **parameters):
        """A call and its answer."""
        number = self.send(method, session, **parameters)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = self.read(max(end - time.monotonic(), 0.01))
            if message is None:
                break
            if message.get("id") == number:
                if "error" in message:
                    raise Failed(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)
        raise Failed(f"{method}: no answer within {seconds} s")

    def page(self, address, **options):
        return Page(self, address, **options)

    def close(self):
        try:
            self.send("Browser.close")
            self.process.wait(10)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.to)
        os.close(self.by)
        shutil.rmtree(self.profile, ignore_errors=True)


class Page:
    """A tab. `network`: whether it may use one; a report must do without."""

    def __init__(self, browser, address, width=1440, height=900, features=(), network=False, phone=False):
        self.browser = browser
        self.errors, self.requests, self.closed = [], [], False
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in "Page", "Runtime", "Network", "Log":
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": name, "value": value} for name, value in features])
        if not network:
            self.call("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1,
                      uploadThroughput=-1)
        self.address = address
        self.call("Page.navigate", url=address)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.close(check=kind is None)

    def call(self, method, **parameters):
        result = self.browser.call(method, self.session, **parameters)
        self.note()
        return result

    def note(self):
        """Keeps errors and requests among the events."""
        events = self.browser.events
        for _ in range(len(events)):
            event = events.popleft()
            if event.get("sessionId") != self.session:
                events.append(event)
                continue
            method, what = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                self.errors.append(what["exceptionDetails"].get("exception", {}).get("description") or str(what))
            elif method == "Runtime.consoleAPICalled" and what["type"] == "error":
                self.errors.append(str(what["args"]))
            elif method == "Log.entryAdded" and what["entry"]["level"] == "error":
                self.errors.append(what["entry"]["text"])
            elif method == "Network.requestWillBeSent":
                self.requests.append(what["request"]["url"])

    def evaluate(self, expression):
        """Value of JavaScript."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise Failed(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, expression, seconds=60):
        """Waits for JavaScript to be true; gives its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.evaluate(expression)
            if value:
                return value
            time.sleep(0.05)
        raise Failed(f"not within {seconds} s: {expression}; errors: {self.errors}")

    def ready(self):
        """Waits until the page shows its robot."""
        self.until("document.body?.dataset.ready || document.body?.dataset.error")
        error = self.evaluate("document.body.dataset.error")
        if error:
            raise Failed(error)
        return self

    def key(self, key, down=True, up=True, modifiers=0):
        code, number = KEYS.get(key, (f"Key{key.upper()}", ord(key.upper()[0])))
        event = {"key": key, "code": code, "windowsVirtualKeyCode": number, "modifiers": modifiers}
        # Text is what makes buttons react to Space and Enter.
        text = {"Enter": "\r"}.get(key, key if len(key) == 1 else "")
        if down:
            self.call("Input.dispatchKeyEvent", type="keyDown", text=text, **event)
        if up:
            self.call("Input.dispatchKeyEvent", type="keyUp", **event)

    def mouse(self, kind, x, y, modifiers=0, buttons=1):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1,
                  modifiers=modifiers)

    def click(self, selector):
        """Clicks the middle of an element."""
        x, y = self.evaluate(f"""(() => {{
            const node = document.querySelector({json.dumps(selector)});
            node.scrollIntoView({{ block: "nearest" }});
            const box = node.getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2];
        }})()""")
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y, buttons=0)

    def picture(self, file: Path):
        file.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def close(self, check=True):
        if self.closed:
            return
        self.closed = True
        self.evaluate("0")
        self.browser.call("Target.closeTarget", targetId=self.target)
        if check:
            assert not self.errors, self.errors
            here = self.address.split("?")[0].rstrip("/")
            outside = [url for url in self.requests if not url.startswith((here, "blob:", "data:", "about:"))]
            assert not outside, outside
