# SPDX-License-Identifier: MIT
"""What a faccia server says, without a face: messages, sound, and MPEG-4 face animation parameters (FAPs).

One file; it needs the package websockets (Debian: python3-websockets).

    import asyncio, faccia

    async def main():
        async with faccia.connect("http://localhost:8080") as client:
            async for event in client.speak("La mamma parla piano.", lang="it"):
                if isinstance(event, faccia.Media):
                    ...                       # event.pcm, event.frames
                elif event["type"] == "word":
                    print(event["text"], event["time"])

    asyncio.run(main())
"""

from __future__ import annotations

import asyncio
import json
import struct
from contextlib import asynccontextmanager
from dataclasses import dataclass
from itertools import count
from typing import Any, AsyncIterator, Dict, List, Optional, Tuple, Union
from urllib.parse import parse_qsl, urlencode, urlsplit, urlunsplit

import websockets
import websockets.exceptions

__all__ = ["CLIENT_MESSAGES", "SERVER_MESSAGES", "ChunkError", "Client", "Media", "Utterance", "connect", "decode_chunk"]

#: Types of messages, by who says them (protocol/asyncapi.json).
# <client messages: made by protocol/make-messages.py>
CLIENT_MESSAGES = frozenset(
    "speak text flush close cancel stop pause resume rate jump play ask idle express media join leave authorize model "
    "ping choices choose state head lexicon calibrate consent voice backdrop said manner overhear drive hear".split()
)
# </client messages>
# <server messages: made by protocol/make-messages.py>
SERVER_MESSAGES = frozenset(
    "hello begin sentence word speaker phone mark paused resumed jumped warning error end joined left authorized model "
    "pong choices chosen asked answered heard backdrop overheard state calibrated lexicon driven head expressed consent "
    "observers".split()
)
# </server messages>

Message = Dict[str, Any]
_HALF = 1 << 31  # values are of 32 bits, and wrap
_FAPS = 69  # FAP n at index n, 1 to 68 (ISO/IEC 14496-2); 0 is not used
_HEADER = struct.Struct("<BBBBIIHHIIII")


class ChunkError(ValueError):
    """A chunk that breaks the format; `at` is the byte where."""

    def __init__(self, message: str, at: int) -> None:
        super().__init__(f"{message} (byte {at})")
        self.at = at


@dataclass(frozen=True)
class Media:
    """Sound and frames of one stretch of time."""

    utterance: int  #: 0: idling
    sample_rate: int  #: Hz
    start: int  #: its first sample, counted from the utterance's beginning
    samples: int
    fps: float
    first_frame: int  #: frame k stands at k / fps seconds
    pcm: bytes  #: signed 16 bits, little-endian, mono; empty where it is silent
    frames: List[Tuple[int, ...]]  #: FAPs in the units of ISO/IEC 14496-2, by their numbers


Event = Union[Message, Media]


def decode_chunk(data: bytes) -> Media:
    """Reads a media chunk of version 1 (protocol/README.md, "Media chunks"): PCM or silence, and plain FAPs."""
    if len(data) < _HEADER.size:
        raise ChunkError("the header is cut short", len(data))
    magic, version, audio, fap, utterance, rate, fps, frame_count, start, samples, first, size = _HEADER.unpack_from(data)
    for at, right in enumerate((magic == 0x46, version == 1, audio <= 1, fap <= 1)):
        if not right:
            raise ChunkError("not a chunk of version 1 with PCM and plain FAPs", at)
    if size > len(data) - _HEADER.size or size != (2 * samples if audio else 0):
        raise ChunkError("the audio's length is not that of its samples", 28)
    if not rate or not fps or (frame_count and not fap):
        raise ChunkError("a rate of 0, or frames without a codec", 8)
    at = _HEADER.size + size
    values = [0] * _FAPS
    frames: List[Tuple[int, ...]] = []
    for _ in range(frame_count):
        at = _read_frame(data, at, values)
        frames.append(tuple(values))
    if at != len(data):
        raise ChunkError("more than its frames", at)
    pcm = bytes(data[_HEADER.size : _HEADER.size + size])
    return Media(utterance, rate, start, samples, fps / 100, first, pcm, frames)


def _read_frame(data: bytes, at: int, values: List[int]) -> int:
    """A frame says what has changed: a mask of 68 bits, then visemes and expressions as they are, all else as differences."""
    mask = int.from_bytes(data[at : at + 9], "little")
    if len(data) < at + 9 or mask >> 68:
        raise ChunkError("a frame's mask is cut short, or names a FAP above 68", at)
    at += 9 + (4 if mask & 1 else 0) + (6 if mask & 2 else 0)
    for fap in range(3, _FAPS):
        if mask >> (fap - 1) & 1:
            change, at = _read_varint(data, at)
            values[fap] = (values[fap] + change + _HALF) % (2 * _HALF) - _HALF
    return at


def _read_varint(data: bytes, at: int) -> Tuple[int, int]:
    value = shift = 0
    while True:
        if at >= len(data) or (shift == 28 and data[at] > 0x0F):
            raise ChunkError("a value is cut short, or longer than 32 bits", min(at, len(data)))
        value |= (data[at] & 0x7F) << shift
        shift += 7
        at += 1
        if data[at - 1] < 0x80:
            return (value >> 1) ^ -(value & 1), at


class Utterance:
    """One thing that is said: iterate over what comes of it, in order, up to its `end`."""

    def __init__(self, client: "Client", id: str) -> None:
        self.client = client
        self.id = id
        self.number: Optional[int] = None  #: what media name; None until `begin`
        self._events: "asyncio.Queue[Event]" = asyncio.Queue()

    def __aiter__(self) -> AsyncIterator[Event]:
        return self._iterate()

    async def _iterate(self) -> AsyncIterator[Event]:
        while True:
            event = await self._events.get()
            yield event
            if not isinstance(event, Media) and event["type"] == "end":
                return

    async def done(self) -> Message:
        """Its `end`: `reason` is done, stopped, failed, or lost (the connection was)."""
        async for event in self:
            if not isinstance(event, Media) and event["type"] == "end":
                return event
        raise AssertionError("an utterance without an end")

    async def write(self, text: str) -> None:
        """More of a text that was begun with `open`."""
        await self.client.send({"type": "text", "id": self.id, "text": text})

    async def sound(self, data: bytes) -> None:
        """More of what was begun with `voice`, as it is spoken."""
        self.client._waiting.put_nowait(data)

    async def close(self) -> None:
        """All of it has been written, or said."""
        await self.client.send({"type": "close", "id": self.id})

    async def cancel(self) -> None:
        """It is not said, or not to its end."""
        await self.client.send({"type": "cancel", "id": self.id})

    def _concerns(self, event: Event) -> bool:
        if isinstance(event, Media):
            return self.number == event.utterance
        return event.get("id") == self.id or (self.number is not None and event.get("utterance") == self.number)


class Client:
    """A stream of a server: `async for event in client` gives all that comes (messages and media) from then on."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket
        self._waiting: "asyncio.Queue[Union[Message, bytes]]" = asyncio.Queue()
        self._utterances: Dict[str, Utterance] = {}
        self._listeners: "List[asyncio.Queue[Optional[Event]]]" = []
        self._numbers = count(1)
        self._sending = asyncio.ensure_future(self._send_all())
        self._reading = asyncio.ensure_future(self._read())
        self.hello: Message = {}  #: what the server has said of itself

    def speak(self, text: str = "", **members: Any) -> Utterance:
        """Says a text; members as of `speak` in the protocol: lang, voice, markup, mode, open..."""
        return self._say({"type": "speak", "text": text, **members})

    def open(self, **members: Any) -> Utterance:
        """Something that is written word by word: write(), close()."""
        return self._say({"type": "speak", "open": True, **members})

    def play(self, name: str, **members: Any) -> Utterance:
        """A recording of the server's folder."""
        return self._say({"type": "play", "name": name, **members})

    def voice(self, rate: int, **members: Any) -> Utterance:
        """Somebody speaks himself: sound(), close(); members as of `voice`: lang, codec, channels, lookahead, mode..."""
        return self._say({"type": "voice", "rate": rate, **members})

    async def send(self, message: Message) -> None:
        """Any message of the protocol."""
        self._waiting.put_nowait(message)

    def __aiter__(self) -> AsyncIterator[Event]:
        events: "asyncio.Queue[Optional[Event]]" = asyncio.Queue()
        self._listeners.append(events)
        return self._iterate(events)

    async def _iterate(self, events: "asyncio.Queue[Optional[Event]]") -> AsyncIterator[Event]:
        try:
            while True:
                event = await events.get()
                if event is None:
                    return
                yield event
        finally:
            self._listeners.remove(events)

    def _say(self, message: Message) -> Utterance:
        utterance = Utterance(self, message.setdefault("id", f"py-{id(self):x}-{next(self._numbers)}"))
        self._utterances[utterance.id] = utterance
        if self._reading.done():
            self._lose()
        else:
            self._waiting.put_nowait(message)
        return utterance

    async def _send_all(self) -> None:
        while True:
            message = await self._waiting.get()
            await self._socket.send(message if isinstance(message, bytes) else json.dumps(message))

    async def _read(self) -> None:
        try:
            async for data in self._socket:
                self._hear(json.loads(data) if isinstance(data, str) else decode_chunk(data))
        except websockets.exceptions.ConnectionClosed:
            pass
        finally:
            self._lose()

    def _hear(self, event: Event) -> None:
        for listener in self._listeners:
            listener.put_nowait(event)
        for utterance in list(self._utterances.values()):
            if not utterance._concerns(event):
                continue
            if not isinstance(event, Media):
                if event["type"] == "begin":
                    utterance.number = event["utterance"]
                if event["type"] == "end":
                    del self._utterances[utterance.id]
            utterance._events.put_nowait(event)

    def _lose(self) -> None:
        for utterance in self._utterances.values():
            utterance._events.put_nowait({"type": "end", "id": utterance.id, "reason": "lost"})
        self._utterances.clear()
        for listener in self._listeners:
            listener.put_nowait(None)

    async def close(self) -> None:
        """Ends the connection; what is being said ends, lost."""
        self._sending.cancel()
        await self._socket.close()
        await asyncio.gather(self._sending, self._reading, return_exceptions=True)


def _address(server: str, members: Dict[str, Any]) -> str:
    parts = urlsplit(server)
    scheme = {"http": "ws", "https": "wss"}.get(parts.scheme, parts.scheme)
    path = "/v1/stream" if parts.path in ("", "/") else parts.path
    query = {**dict(parse_qsl(parts.query)), "audio": "pcm", "fap": "plain", **{k: str(v) for k, v in members.items() if v is not None}}
    if members.get("room"):
        query["key"] = str(members["room"])
    return urlunsplit((scheme, parts.netloc, path, urlencode(query), ""))


@asynccontextmanager
async def connect(server: str, **members: Any) -> AsyncIterator[Client]:
    """Opens a stream and waits until the server greets. Members: what its address may say (lang, voice, room, token...)."""
    async with websockets.connect(_address(server, members), subprotocols=["faccia.v1"], max_size=None) as socket:  # type: ignore[attr-defined]
        hello = json.loads(await socket.recv())
        client = Client(socket)
        client.hello = hello
        try:
            yield client
        finally:
            await client.close()
