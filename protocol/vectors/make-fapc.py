# SPDX-License-Identifier: MIT
"""Writes fapc.json: FAPC packets with their contents, coded here from the text of fapc.md alone, and damaged ones.
Usage: make-fapc.py > fapc.json"""
import copy
import json
import math
import os
import random

here = os.path.dirname(os.path.abspath(__file__))
table = {f["number"]: f for f in json.load(open(f"{here}/../fap-table.json"))["faps"]}
prior = json.load(open(f"{here}/../fapc/fapc-prior.json"))
habit = {f["number"]: f for f in prior["faps"]}
random.seed(5)


class Code:
    """The number that an arithmetic coder narrows down, as exact as it comes."""

    def __init__(self):
        self.low, self.range, self.shifts = 0, 2**32 - 1, 0

    def narrow(self, bound, bit):
        if bit:
            self.low += bound
            self.range -= bound
        else:
            self.range = bound
        while self.range < 2**24:
            self.low <<= 8
            self.range <<= 8
            self.shifts += 1

    def bytes(self):
        top = -(-self.low >> 24)
        return top.to_bytes(self.shifts + 1, "big").rstrip(b"\0")


class Coder:
    def __init__(self, quality):
        self.quality, self.number, self.begun = quality, 0, False

    def reset(self):
        self.contexts, self.mask, self.high = {}, set(), [0] * 10
        self.values = {n: [0, 0, 0] for n in range(3, 69)}  # of the frames before, the latest first
        self.activity = dict.fromkeys(range(3, 69), 16)

    def bit(self, key, bit, first=None):
        p, seen = self.contexts.get(key, (first, 6) if first else (32768, 0))
        self.code.narrow((self.code.range >> 16) * p, bit)
        rate = 655360 // (10 * seen + 16)
        p = p - p * rate // 65536 if bit else p + (65536 - p) * rate // 65536
        self.contexts[key] = (min(65472, max(64, p)), min(60, seen + 1))

    def even(self, value, bits):
        for b in reversed(range(bits)):
            self.code.narrow(self.code.range >> 1, value >> b & 1)

    def packet(self, frames, begin):
        begin |= not self.begun
        self.begun = True
        head = bytes([self.number | 128 * begin] + [self.quality] * begin)
        self.number = (self.number + 1) % 128
        if begin:
            self.reset()
        self.code = Code()
        decoded = [self.frame(f) for f in frames]
        return head + self.code.bytes(), decoded

    def frame(self, f):
        mask = {int(n) for n in f["values"]} | ({1} if "viseme" in f else set()) | ({2} if "expression" in f else set())
        self.bit("mask", mask != self.mask)
        if mask != self.mask:
            for n in range(1, 69):
                self.bit(("mask", n in self.mask), n in mask)
        self.mask = mask
        for name, first, n in (("viseme", 0, 1), ("expression", 4, 2)):
            for i, value in enumerate(f.get(name, []), first):
                self.bit(("high", i), value != self.high[i])
                if value != self.high[i]:
                    self.even(value, 8)
                self.high[i] = value
        now, errors, out = {n: v[0] for n, v in self.values.items()}, {}, {}
        for n in range(3, 69):
            if n in mask:
                out[str(n)] = now[n] = self.value(n, f["values"][str(n)], now, errors)
        for n, v in now.items():
            self.values[n] = [v] + self.values[n][:2]
        return {**f, "values": out}

    def value(self, n, value, now, errors):
        h, step = habit[n], self.step(n)
        (a, b, c), models = self.values[n], h["models"]
        moved = [now[m] - self.values[m][0] for m in models] + [0] * (2 - len(models))
        stood = [self.values[m][0] for m in models] + [0] * (2 - len(models))
        inputs = [min(2**20, max(-2**20, x)) for x in [a - b, b - c, *moved, a, *stood]]
        unit = 4096 * step
        total = 4096 * a + sum(w * x for w, x in zip(h["weights" if self.quality else "exact"], inputs))
        guess = (2 * total + unit) // (2 * unit)
        rest = total - guess * unit
        limited = min(2**24, max(-2**24, value))
        level = (abs(limited) + step // 2) // step * (-1 if limited < 0 else 1)
        e, g = level - guess, h["group"]
        s = sum(self.activity[n] >= bound for bound in (5, 16, 48, 160, 500))
        e_model = errors.get(models[0], 0) if models else 0
        w = (e_model > 0) - (e_model < 0)
        at = min(s, 3) * 6 + (3 if w else 0) + min(2, 6 * abs(rest) // unit)
        self.bit(("zero", n, at), e != 0, prior["zero"][g][at])
        if e:
            at = (w + 1) * 5 + 2 + min(2, max(-2, (10 * rest + unit) // (2 * unit)))
            self.bit(("sign", n, at), e < 0, prior["sign"][g][at])
            for place in range(min(12, abs(e))):
                at = s * 12 + place
                self.bit(("size", g, at), place < abs(e) - 1, prior["size"][g][at])
            if abs(e) > 12:
                y = abs(e) - 12
                for place in range(y.bit_length()):
                    self.bit(("long", g, place), place < y.bit_length() - 1)
                self.even(y, y.bit_length() - 1)
        self.activity[n] = (self.activity[n] * 5 >> 3) + 16 * min(255, abs(e))
        errors[n] = e
        return level * step

    def step(self, n):
        return max(1, table[n]["quant_step"] * self.quality * habit[n]["eighths"] >> 3)


def speech(t):
    """A mouth that moves, mirrored, with outer lips that follow, a head that sways, blinks and glances."""
    opening = round(300 + 250 * math.sin(t / 2))
    values = dict.fromkeys(range(3, 69), 0)
    values[3] = opening
    for faps, value in (((5, 10, 11), -opening * 0.8), ((52, 57, 58), -opening * 0.7), ((6, 7, 53, 54), 60 * math.sin(t / 3)),
                        ((19, 20), 900 if t % 20 < 3 else 10), ((48,), 5000 * math.sin(t / 15)),
                        ((23, 24), 9000 if math.sin(t / 9) > 0 else -9000)):
        for n in faps:
            values[n] = round(value)
    return {"values": values}


def wild(_):
    frame = {"values": {n: random.randrange(-2**k, 2**k) for n in range(3, 69)
                        for k in [random.randrange(25)] if random.random() < 0.5}}
    if random.random() < 0.5:
        frame["viseme"] = [random.randrange(256) for _ in range(4)]
    if random.random() < 0.5:
        frame["expression"] = [random.randrange(256) for _ in range(6)]
    return frame


def high(t):
    """A mask that changes, FAP 1 that blends."""
    frame = {"values": {3: t * 20, 31 + t // 4: t * 20}, "viseme": [1 + t // 8 % 14, 2, t * 8 % 64, 1]}
    if t > 6:
        frame["expression"] = [1, 40, 0, 0, 0, 1]
    return frame


def extremes(t):
    steps = [0, 2147483647, -2147483648, 16777216, -16777216, 1, -1]
    return {"values": {n: steps[(t + n) % 7] for n in (3, 5, 20, 47, 48)}}


streams = []
for make, quality, count, per, every in ((speech, 5, 36, 3, 6), (speech, 0, 12, 3, 2), (speech, 31, 24, 12, 9), (wild, 0, 6, 2, 2),
                                         (wild, 3, 6, 3, 9), (high, 5, 20, 4, 3), (extremes, 0, 8, 1, 3), (extremes, 7, 8, 4, 9)):
    coder, packets = Coder(quality), []
    for p, t in enumerate(range(0, count, per)):
        frames = [make(t + i) for i in range(per)]
        frames = [{**f, "values": {str(n): v for n, v in sorted(f["values"].items())}} for f in frames]
        data, decoded = coder.packet(copy.deepcopy(frames), p % every == 0)
        packets.append({"intra": p % every == 0, "bytes": data.hex(), "frames": frames, "decoded": decoded})
    streams.append({"name": make.__name__, "quality": quality, "packets": packets})

# What a decoder must refuse after the first packet of a stream; {stream, packet}: packet number `packet` of that stream, changed.
first, second = (bytes.fromhex(p["bytes"]) for p in streams[0]["packets"][:2])
bad = [
    {"name": "nothing", "bytes": ""},
    {"name": "a number too far", "bytes": (bytes([second[0] + 1]) + second[1:]).hex()},
    {"name": "the same packet again without its beginning", "bytes": (bytes([first[0] & 127]) + first[2:]).hex()},
    {"name": "no quality", "bytes": first[:1].hex()},
    {"name": "a quality of 32", "bytes": (first[:1] + b"\x20" + first[2:]).hex()},
    {"name": "bytes that nobody wrote", "bytes": (second + b"\x01" * 8).hex()},
    {"name": "ones without end", "bytes": (second[:1] + b"\xff" * 400).hex()},
]


def lines(items):
    return ",\n".join(json.dumps(item, separators=(",", ":")) for item in items)


print('{\n"title": "FAPC packets with their contents; bad: packets that must be rejected after the first packet of the first stream",\n"streams": [')
print(",\n".join(f'{{"name":"{s["name"]}","quality":{s["quality"]},"packets":[\n{lines(s["packets"])}\n]}}' for s in streams))
print(f'],\n"bad": [\n{lines(bad)}\n]\n}}')
