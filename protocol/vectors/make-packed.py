# SPDX-License-Identifier: MIT
"""Writes packed.json: compact chunks without media whose events are packed, coded here from the text of README.md alone, with the
events as messages; and damaged ones. Usage: make-packed.py > packed.json"""
import json


def varint(value):
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


RATE = 22050


def event(kind, sample, duration, text, start=0, utf16_start=0):
    said = text.encode()
    message = {"type": ["sentence", "word", "mark", "phone"][kind], "utterance": 3, "time": round(sample / RATE, 6), "sample": sample}
    code = bytes([kind]) + varint(sample)
    if kind != 2:
        message["duration"] = round(duration / RATE, 6)
        code += varint(duration)
    if kind < 2:
        message.update(start=start, utf16_start=utf16_start, end=start + len(said),
                       utf16_end=utf16_start + len(text.encode("utf-16-le")) // 2, text=text)
        code += varint(start) + varint(start - utf16_start)
    else:
        message["name" if kind == 2 else "ipa"] = text
    return message, code + varint(len(said)) + said


def chunk(name, *events):
    data = b"".join(code for _, code in events)
    head = bytes([0xC3 if data else 0xC2]) + varint(3) + varint(RATE) + varint(2500) + varint(0) + varint(0) + varint(4410) + b"\0\0"
    return {"name": name, "events": [message for message, _ in events], "packed": data.hex(),
            "hex": (head + (varint(len(data)) if data else b"") + data).hex()}


good = [
    chunk("none"),
    chunk("a word", event(1, 0, 4410, "La")),
    chunk("a sentence and its words", event(0, 2205, 70000, "Città è più.", 10, 9), event(1, 2205, 9000, "Città", 10, 9),
          event(1, 11205, 3000, "è", 17, 15), event(1, 14205, 8000, "più", 20, 17)),
    chunk("a mark without a name, one with, and two phones", event(2, 7, 0, ""), event(2, 44100, 0, "qui"), event(3, 44100, 900, "ʎː"),
          event(3, 45000, 900, "")),
    chunk("large numbers", event(1, 4294967295, 4294967295, "\U0001F600", 4294967291, 0)),
    chunk("a long text", event(0, 0, 1, "a" * 300)),
]


def damage(name, packed):
    base = bytes.fromhex(good[0]["hex"])
    return {"name": name, "hex": (bytes([0xC3]) + base[1:] + varint(len(packed)) + packed).hex()}


word = bytes.fromhex(good[1]["packed"])
bad = [
    damage("an unknown kind", b"\x04" + word[1:]),
    damage("a word cut short", word[:-1]),
    damage("a number cut short", word[:2]),
    damage("a number over 32 bits", b"\x02\xff\xff\xff\xff\x10\x00"),
    damage("a place before the text", b"\x01\x00\x01\x02\x03\x01a"),
    {"name": "events longer than the message", "hex": good[1]["hex"][:-2]},
    {"name": "events without their length", "hex": "c3" + good[0]["hex"][2:]},
]
print(json.dumps({"good": good, "bad": bad}, indent=1, ensure_ascii=False))
