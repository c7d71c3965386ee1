# SPDX-License-Identifier: GPL-3.0-or-later
"""Speaks by a server of the Wyoming protocol (https://github.com/rhasspy/wyoming), as those of Piper or Home
Assistant are: the text comes from standard input, the sound goes to standard output as it arrives, as WAV.

Usage: python3 wyoming.py HOST PORT [--voice NAME] [--speaker NAME] [--lang TAG]

An event is a line of JSON {"type", "data", "data_length", "payload_length"}, then data_length bytes of JSON that
are merged into data, then payload_length bytes. We send "synthesize"; "audio-start", "audio-chunk"s, "audio-stop"
or "error" come back.
"""
import argparse
import json
import socket
import struct
import sys

DATA_MAX = 1 << 20
PAYLOAD_MAX = 16 << 20
SECONDS = 60  # without a sign of life


def write_event(stream, kind, data):
    body = json.dumps(data).encode()
    stream.write(json.dumps({"type": kind, "data_length": len(body)}).encode() + b"\n" + body)
    stream.flush()


def read_bytes(stream, length, most):
    if not isinstance(length, int) or not 0 <= length <= most:
        sys.exit(f"the server sends an event of {length} bytes")
    got = stream.read(length)
    if len(got) < length:
        sys.exit("the server hung up within an event")
    return got


def read_event(stream):
    """Gives its type, its data and its payload."""
    line = stream.readline(DATA_MAX)
    if not line.endswith(b"\n"):
        sys.exit("the server hung up before the end of the sound")
    header = json.loads(line)
    data = header.get("data") or {}
    data.update(json.loads(read_bytes(stream, header.get("data_length") or 0, DATA_MAX) or b"{}"))
    return header["type"], data, read_bytes(stream, header.get("payload_length") or 0, PAYLOAD_MAX)


def write_header(out, data):
    """Of a WAV file that ends where the stream ends: its lengths are 0."""
    rate, width, channels = (int(data[key]) for key in ("rate", "width", "channels"))
    frame = width * channels
    out.write(struct.pack("<4sI8sIHHIIHH4sI", b"RIFF", 0, b"WAVEfmt ", 16, 1, channels, rate,
                          rate * frame, frame, 8 * width, b"data", 0))


def main():
    parser = argparse.ArgumentParser()
    for name in ("host", "port", "--voice", "--speaker", "--lang"):
        parser.add_argument(name)
    args = parser.parse_args()
    voice = {"name": args.voice, "speaker": args.speaker, "language": args.lang}
    request = {"text": sys.stdin.buffer.read().decode(), "voice": {k: v for k, v in voice.items() if v}}
    out, begun, kind = sys.stdout.buffer, False, ""
    connection = socket.create_connection((args.host, args.port), SECONDS)
    with connection, connection.makefile("rwb") as stream:
        write_event(stream, "synthesize", request)
        while kind != "audio-stop":
            kind, data, payload = read_event(stream)
            if kind == "error":
                sys.exit(str(data.get("text", "the server failed")))
            if kind in ("audio-start", "audio-chunk") and not begun:
                write_header(out, data)
                begun = True
            if kind == "audio-chunk":
                out.write(payload)
                out.flush()


main()
