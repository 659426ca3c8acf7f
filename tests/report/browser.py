# SPDX-License-Identifier: LGPL-2.1-or-later
"""A headless Chromium that receives commands through a pipe (the DevTools protocol)."""

import json
import os
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
SOFTWARE_WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def find_browser():
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One page in a browser without a network."""

    def __init__(self, *options):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self.to_write = os.pipe()
        self.to_read, to_write = os.pipe()
        # The browser reads from 3 and writes to 4.
        shell = ["bash", "-c", f'exec "$@" 3<&{to_read} 4>&{to_write}', "bash"]
        command = [find_browser(), "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run",
                   f"--user-data-dir={self.profile.name}", "--host-resolver-rules=MAP * ~NOTFOUND",
                   "--remote-debugging-pipe", *options, "about:blank"]
        self.process = subprocess.Popen(shell + command, pass_fds=(to_read, to_write), stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        env=dict(os.environ, HOME=self.profile.name))
        os.close(to_read)
        os.close(to_write)
        self.number, self.read = 0, b""
        self.session = None
        targets = self.request("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        self.session = self.request("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.to_read)
        os.close(self.to_write)
        self.profile.cleanup()

    def request(self, method, **parameters):
        """Sends a command and waits for its answer, as long as the browser needs."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to_write, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" in self.read:
                text, _, self.read = self.read.partition(b"\0")
                answer = json.loads(text)
                if answer.get("id") == self.number:
                    if "error" in answer:
                        raise RuntimeError(f"{method}: {answer['error']}")
                    return answer["result"]
            part = os.read(self.to_read, 1 << 20)
            if not part:
                raise RuntimeError(f"{method}: the browser has ended")
            self.read += part

    def open(self, path, width=1400, height=1000, is_phone=False, is_dark=False):
        """Shows a file in a window of this size, and waits until its programs have run."""
        self.request("Emulation.setDeviceMetricsOverride", width=width, height=height, mobile=is_phone,
                     deviceScaleFactor=2 if is_phone else 1)
        self.request("Emulation.setEmulatedMedia",
                     features=[{"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}])
        self.request("Page.enable")
        self.request("Page.navigate", url=path.resolve().as_uri())
        while self.run("location.protocol === 'file:' && document.readyState") != "complete":
            time.sleep(0.05)

    def run(self, program):
        """The value of an expression, which may be a promise."""
        answer = self.request("Runtime.evaluate", expression=program, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:2000])
        return answer["result"].get("value")
