"""A browser without a window, driven over a pipe by its own protocol (Chrome DevTools)."""

from __future__ import annotations

import base64
import fcntl
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

PROGRAM = shutil.which("chromium") or shutil.which("google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--remote-debugging-pipe")
WAIT = 60.0  # s

needed = pytest.mark.skipif(PROGRAM is None and "CI" not in os.environ, reason="no browser is installed")
"""Tests that need one; where the whole suite must be run, one that is missing is a failure."""

KEYS = {"Enter": ("Enter", 13, "\r"), "Tab": ("Tab", 9, ""), "Escape": ("Escape", 27, "")}
KEYS |= {name: (name, code, "") for name, code in zip(("End", "Home"), (35, 36), strict=True)}
KEYS |= {f"Arrow{name}": (f"Arrow{name}", 37 + i, "") for i, name in enumerate(("Left", "Up", "Right", "Down"))}


class Browser:
    """One page in a browser of its own; ``errors`` are those of its console, ``asked`` all addresses it asked for."""

    def __init__(self, folder: Path, width: int = 1200, height: int = 900) -> None:
        assert PROGRAM is not None, "there is no chromium"
        there, mine = os.pipe(), os.pipe()

        def pipes() -> None:  # the browser reads from 3 and writes to 4
            ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 100) for end in (there[0], mine[1])]
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        words = [PROGRAM, *FLAGS, f"--user-data-dir={folder / 'profile'}", f"--window-size={width},{height}"]
        with open(folder / "browser.log", "wb") as log:
            self._process = subprocess.Popen(
                [*words, "about:blank"], stdout=log, stderr=log, preexec_fn=pipes, pass_fds=(3, 4)
            )
        os.close(there[0])
        os.close(mine[1])
        self._write, self._read = there[1], mine[0]
        os.set_blocking(self._read, False)
        self._rest, self._count, self._session = b"", 0, None
        self.errors: list[str] = []
        self.asked: list[str] = []
        target = self._page()
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def _page(self) -> str:
        end = time.monotonic() + WAIT
        while time.monotonic() < end:
            for info in self.call("Target.getTargets")["targetInfos"]:
                if info["type"] == "page":
                    return info["targetId"]
            time.sleep(0.05)
        raise TimeoutError("the browser has no page")

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._write)
        self._process.kill()
        self._process.wait()
        os.close(self._read)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The answer to a message."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + WAIT
        while time.monotonic() < end:
            answer = self._next(end)
            if answer.get("id") == self._count:
                assert "error" not in answer, answer["error"]
                return answer["result"]
            self._heard(answer)
        raise TimeoutError(method)

    def _next(self, end: float) -> dict[str, Any]:
        while b"\0" not in self._rest:
            try:
                part = os.read(self._read, 1 << 20)
                assert part, "the browser has ended"
                self._rest += part
            except BlockingIOError:
                if time.monotonic() > end:
                    raise TimeoutError from None
                time.sleep(0.005)
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def _heard(self, event: dict[str, Any]) -> None:
        method, what = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(what["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.errors.append(json.dumps(what["args"]))
        elif method == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.errors.append(what["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.asked.append(what["request"]["url"])

    def open(self, file: Path, fragment: str = "") -> None:
        """Load a file, to the end of its scripts."""
        self.call("Page.navigate", url=file.resolve().as_uri() + fragment)
        self.until("document.readyState === 'complete' && location.protocol === 'file:'")

    def value(self, expression: str) -> Any:
        """The value of an expression, or of what it promises."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, expression: str) -> None:
        """Wait until it is true."""
        end = time.monotonic() + WAIT
        while time.monotonic() < end:
            if self.value(expression):
                return
            time.sleep(0.03)
        raise TimeoutError(expression)

    def press(self, *names: str) -> None:
        """Keys, or texts that are typed letter by letter."""
        for name in names:
            if name not in KEYS:
                self.call("Input.insertText", text=name)
                continue
            key, code, text = KEYS[name]
            about = {"key": key, "code": key, "windowsVirtualKeyCode": code}
            self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **about)
            self.call("Input.dispatchKeyEvent", type="keyUp", **about)

    def picture(self, file: Path, whole: bool = False) -> Path:
        """What is to be seen, as PNG."""
        data = self.call("Page.captureScreenshot", captureBeyondViewport=whole)["data"]
        file.write_bytes(base64.b64decode(data))
        return file

    def pdf(self, file: Path) -> Path:
        """The page as it is printed on A4."""
        size = {"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": True, "printBackground": True}
        file.write_bytes(base64.b64decode(self.call("Page.printToPDF", **size)["data"]))
        return file
