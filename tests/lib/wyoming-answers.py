# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives server/plugins/command/wyoming.py answers of a server that were damaged at random, in ways that can be repeated: it
ends, and has written no more than it was sent. Usage: python3 wyoming-answers.py PATH_OF_WYOMING COUNT"""
import io
import json
import random
import socket
import struct
import sys

source = compile(open(sys.argv[1]).read(), sys.argv[1], "exec")
rounds, chance = int(sys.argv[2]), random.Random(12)
SOUND = {"rate": 22050, "width": 2, "channels": 1}


def event(kind, data, payload=b"", within=False):
    body = b"" if within else json.dumps(data).encode()
    header = {"type": kind, "data_length": len(body), "payload_length": len(payload), **({"data": data} if within else {})}
    return json.dumps(header).encode() + b"\n" + body + payload


WHOLE = (event("audio-start", SOUND, within=True) + event("audio-chunk", SOUND, b"\1\2" * 50) +
         event("audio-chunk", {**SOUND, "timestamp": 5}, b"\3" * 20) + event("audio-stop", {}))
VALUES = [b"-1", b"0", b"null", b"[]", b"{}", b"1e999", b"99999999999", b"true", b'"x"', b"NaN", b"[" * 3000, b"0.5", b"65536"]


def damaged():
    out = bytearray(WHOLE)
    for _ in range(chance.randint(0, 4)):
        at = chance.randrange(len(out) + 1)
        end = min(len(out), at + chance.randint(1, 30))
        numbers = [i for i, byte in enumerate(out) if 48 <= byte <= 57]
        way = chance.randrange(5)
        if way == 0 and numbers:
            at = chance.choice(numbers)
            out[at:at + 1] = chance.choice(VALUES)
        else:
            out[at:end] = [b"", out[at:end] * 2, bytes([chance.randrange(256)]), b"\n", chance.choice(VALUES)][way]
    return bytes(out)


class Connection:
    """As much of a socket as the program uses."""
    def __init__(self, answer):
        self.stream = io.BytesIO(answer)
        self.stream.write = lambda data: len(data)

    def makefile(self, _mode):
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_args):
        pass

    def __getattr__(self, name):
        return getattr(self.stream, name) if name in ("read", "readline", "flush") else lambda *_args: None


class Out(io.BytesIO):
    buffer = property(lambda self: self)


class In:
    buffer = io.BytesIO()


spoken = 0
real = sys.stdout
sys.argv = ["wyoming.py", "host", "1", "--voice", "a"]
for number in range(rounds):
    answer = damaged() if number else WHOLE
    sys.stdin, sys.stdout = In(), Out()
    socket.create_connection = lambda *_args: Connection(answer)
    try:
        exec(source, {"__name__": "wyoming"})
        spoken += 1
    except (SystemExit, AttributeError, KeyError, TypeError, ValueError, OverflowError, RecursionError, struct.error):
        pass  # it ends with a complaint
    written = sys.stdout.getvalue()
    sys.stdout = real
    assert len(written) <= len(answer) + 44, (answer, written)
    assert not written or written[:4] == b"RIFF", answer
    assert number or len(written) == 44 + 120, written
assert 0 < spoken < rounds
print(f"{rounds} answers, {spoken} of them spoken to the end")
