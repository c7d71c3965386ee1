# SPDX-License-Identifier: MIT
"""Writes chunks.json: media chunks with their contents, coded here from the text of README.md alone, and damaged ones with the
byte at which a decoder has to complain. "loose" chunks can be decoded, but an encoder writes them shorter.
Usage: make.py > chunks.json"""
import json
import random
import struct

random.seed(20)


def varint(d):
    z = (d << 1) if d >= 0 else (-d << 1) - 1
    out = bytearray()
    while True:
        if z < 0x80:
            out.append(z)
            return bytes(out)
        out.append(z & 0x7F | 0x80)
        z >>= 7


def encode(c):
    audio = struct.pack(f"<{len(c['audio'])}h", *c["audio"])
    head = struct.pack(
        "<BBBBIIHHIIII", 0x46, 1, 1 if c["audio"] else 0, 1 if c["frames"] else 0, c["utterance"], c["rate"],
        c["fps_hundreds"], len(c["frames"]), c["start"], c["samples"], c["first_frame"], len(audio))
    out = head + audio
    values, viseme, expression = {}, [0] * 4, [0] * 6
    for frame in c["frames"]:
        mask, body = 0, b""
        if frame["viseme"] != viseme:
            mask |= 1
            body += bytes(frame["viseme"])
        if frame["expression"] != expression:
            mask |= 2
            body += bytes(frame["expression"])
        now = {int(n): v for n, v in frame["values"].items()}
        for n in range(3, 69):
            d = now.get(n, 0) - values.get(n, 0)
            d = (d + 2**31) % 2**32 - 2**31
            if d:
                mask |= 1 << (n - 1)
                body += varint(d)
        out += mask.to_bytes(9, "little") + body
        values, viseme, expression = now, frame["viseme"], frame["expression"]
    return out


def frame(values=None, viseme=None, expression=None):
    return {"values": {str(n): v for n, v in (values or {}).items()}, "viseme": viseme or [0] * 4,
            "expression": expression or [0] * 6}


def chunk(name, frames=(), audio=(), samples=None, **more):
    c = {"name": name, "utterance": 1, "rate": 22050, "fps_hundreds": 2500, "start": 0, "first_frame": 0,
         "samples": len(audio) if samples is None else samples, "audio": list(audio), "frames": list(frames)}
    c.update(more)
    c["hex"] = encode(c).hex()
    return c


walk, faces = {n: 0 for n in range(3, 69)}, []
for _ in range(12):
    walk = {n: v + random.choice([0, 0, 1, -1, 40, -300, 5000]) for n, v in walk.items()}
    faces.append(frame({n: v for n, v in walk.items() if v}, [random.randrange(15) for _ in range(4)],
                       [random.randrange(64) for _ in range(6)]))

good = [
    chunk("silence without frames", samples=2205),
    chunk("audio alone", audio=[0, 1, -1, 32767, -32768], start=77),
    chunk("one frame, one FAP", [frame({3: 500})], samples=882),
    chunk("FAP 1 and 2, and back to nothing",
          [frame(viseme=[1, 10, 63, 0]), frame(viseme=[1, 10, 63, 0], expression=[1, 40, 0, 0, 0, 1]), frame()],
          samples=2646, first_frame=9),
    chunk("largest differences", [frame({3: 2147483647, 68: -2147483648}), frame({3: -2147483648, 68: 2147483647})],
          samples=1764),
    chunk("all fields large", [frame({68: 1})], samples=4294967295, utterance=4294967295, rate=192000,
          fps_hundreds=65535, start=4294967295, first_frame=4294967295),
    chunk("a walk of all FAPs", faces, audio=[random.randrange(-32768, 32768) for _ in range(200)], fps_hundreds=2997),
]


def recode(name, base, at, old, new):
    """The chunk `base`, in whose bytes the part at `at` is written in another way."""
    data = bytes.fromhex(base["hex"])
    assert data[at:at + len(old)] == old
    return {**base, "name": name, "hex": (data[:at] + new + data[at + len(old):]).hex()}


def damage(name, base, at, change):
    data = bytearray.fromhex(base["hex"])
    change(data)
    return {"name": name, "hex": data.hex(), "at": at}


def put(at, *values):
    def change(data):
        data[at:at + len(values)] = bytes(values)
    return change


one, sound, select = good[2], good[1], good[3]
loose = [
    recode("a value in more bytes than it needs", one, 41, varint(500), b"\xe8\x87\x80\x80\x00"),
    recode("a difference of 0", one, 32, b"\x04" + bytes(8) + varint(500),
           b"\x0c" + bytes(8) + varint(500) + varint(0)),
]
full = len(bytes.fromhex(one["hex"]))
bad = [
    {"name": "nothing", "hex": "", "at": 0},
    damage("another magic", one, 0, put(0, 0x47)),
    damage("a later version", one, 1, put(1, 2)),
    damage("an unknown audio codec", one, 2, put(2, 9)),
    damage("an unknown FAP codec", one, 3, put(3, 9)),
    damage("a header cut short", one, 20, lambda d: d.__delitem__(slice(20, None))),
    damage("sample rate 0", one, 8, put(8, 0, 0, 0, 0)),
    damage("frame rate 0", one, 12, put(12, 0, 0)),
    damage("frames without a codec", one, 14, put(3, 0)),
    damage("audio longer than the message", sound, 28, put(28, 11)),
    damage("audio that does not fit its samples", sound, 28, put(20, 6)),
    damage("a mask cut short", one, 32, lambda d: d.__delitem__(slice(38, None))),
    damage("a value cut short", one, full - 1, lambda d: d.__delitem__(slice(full - 1, None))),
    damage("FAP 1 cut short", select, 41, lambda d: d.__delitem__(slice(44, None))),
    damage("FAP 2 cut short", select, 54, lambda d: d.__delitem__(slice(59, None))),
    damage("FAP 69", one, 40, put(40, 0x10)),
    damage("a value of six bytes", one, 45, lambda d: d.__setitem__(slice(41, None), b"\xff" * 5 + b"\x00")),
    damage("a value over 32 bits", one, 45, lambda d: d.__setitem__(slice(41, None), b"\xff" * 4 + b"\x10")),
    damage("more frames than there are", one, full, put(14, 255, 255)),
    damage("a byte too many", one, full, lambda d: d.append(0)),
]
print(json.dumps({"good": good, "loose": loose, "bad": bad}, indent=1))
