#!/usr/bin/env python3
"""bench/attack_page.py PROGRAM [SECONDS [KIND...]]: a show in real time on two outputs of 320x180 at 30 Hz,
whose page four threads attack for so long (default: 20 s each). Prints what was sent, whether the page answers
afterwards, and how many frames were late; the yardstick says how many a thread that does nothing has missed.

nobody: no attack. flood: requests as fast as they are answered. drip: connections that send one byte. large:
bodies as large as allowed, of nothing but brackets. junk: damaged requests. deaf: pages that listen and never
read, while GO is pressed."""

import json
import random
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SHOW = str(Path(__file__).resolve().parent / "red-and-blue")
GO = b'{"do": "go"}'


def get(path, more=b""):
    return b"GET " + path + b" HTTP/1.1\r\nHost: localhost\r\n" + more + b"\r\n"


def post(body):
    head = b"POST /api/v1/inputs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nConnection: close\r\n"
    return head + b"Content-Length: %d\r\n\r\n" % len(body) + body


class Attack:
    def __init__(self, port, seconds):
        self.port, self.end, self.sent, self.refused = port, time.monotonic() + seconds, 0, 0

    def connect(self):
        client = socket.socket()
        client.settimeout(2)
        client.connect(("127.0.0.1", self.port))
        return client

    def answers(self):
        with self.connect() as client:
            client.sendall(get(b"/api/v1/state", b"Connection: close\r\n"))
            return client.recv(100).startswith(b"HTTP/1.1 200")

    def again_and_again(self, once):
        while time.monotonic() < self.end:
            try:
                self.sent += once()
            except OSError:
                self.refused += 1

    def nobody(self):
        time.sleep(max(0, self.end - time.monotonic()))

    def flood(self):
        def once():
            with self.connect() as client:
                client.sendall(get(b"/api/v1/cues") * 19 + get(b"/api/v1/state", b"Connection: close\r\n"))
                while client.recv(65536):
                    pass
            return 20

        self.again_and_again(once)

    def drip(self):
        open_ones = []

        def once():
            client = self.connect()
            client.sendall(b"G")
            open_ones.append(client)
            return 1

        while time.monotonic() < self.end and len(open_ones) < 4000:
            try:
                self.sent += once()
            except OSError:
                self.refused += 1
        self.nobody()

    def large(self):
        def once():
            with self.connect() as client:
                client.sendall(post(b"[" * 65000))
                client.recv(1000)
            return 1

        self.again_and_again(once)

    def junk(self):
        chance = random.Random(threading.get_ident() % 4)

        def once():
            data = bytearray(post(GO))
            for _ in range(chance.randint(1, 4)):
                data[chance.randrange(len(data))] = chance.randrange(256)
            with self.connect() as client:
                client.sendall(bytes(data[: chance.randint(1, len(data))]))
            return 1

        self.again_and_again(once)

    def deaf(self):
        listening = []
        for _ in range(50):
            client = self.connect()
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.sendall(get(b"/api/v1/events"))
            listening.append(client)

        def once():
            with self.connect() as client:
                client.sendall(post(GO))
                client.recv(100)
            time.sleep(0.05)
            return 1

        self.again_and_again(once)


def attack(program, kind, seconds):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.Popen(
            [program, "run", SHOW, "--site", SHOW, "--report", "report.json", "--console", "localhost:0"],
            cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said, found = "", None
        while not found:
            line = run.stderr.readline()
            if not line:
                sys.exit("it does not begin: " + said)
            said += line
            found = re.search(r"localhost:(\d+)", said)
        threading.Thread(target=lambda: [None for _ in run.stderr], daemon=True).start()
        time.sleep(2)
        attacker = Attack(int(found[1]), seconds)
        threads = [threading.Thread(target=getattr(attacker, kind)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        time.sleep(11)  # whoever sends nothing is dropped after ten seconds
        answers = attacker.answers()
        run.send_signal(signal.SIGINT)
        run.wait()
        report = json.loads(Path(folder, "report.json").read_text())
    print(f"{kind}: {attacker.sent} sent, {attacker.refused} refused; {'it answers' if answers else 'NO ANSWER'} afterwards; "
          f"{report['late_frames']} of {report['frames']} frames late, yardstick {report['yardstick']['late']}", flush=True)


if __name__ == "__main__":
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    for one in sys.argv[3:] or ["nobody", "flood", "drip", "large", "junk", "deaf"]:
        attack(str(Path(sys.argv[1]).resolve()), one, float(sys.argv[2]) if len(sys.argv) > 2 else 20)
