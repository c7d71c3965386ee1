#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns recordings of an articulograph into the CSV that faccia fit and faccia eval --recording read.

    articulograph.py RECORDING.mat > curves.csv
    articulograph.py --sensors 3=ul,4=ll,5=jaw,6=tt,7=tb --forward x --up z RECORDING.pos > curves.csv

.mat: MATLAB 5 to 7 (not 7.3, which is HDF5: save it with -v7), a struct array with the members NAME, SRATE and SIGNAL, as
the Haskins corpora have it: one entry for each sensor, with its coordinates in mm in the first columns. .pos: Carstens AG50x
with its header, or AG500 without (12 channels, 200 Hz): 7 values for each channel and instant, mm. Head movement must have
been taken out.

--sensors   NAME=ul,...: which sensor (its name in .mat, its number from 1 in .pos) is the upper and lower lip (ul, ll), the
            jaw (at the lower incisors), the tongue's tip and body (tt, tb, or tr further back). Left out for .mat: the sensors' own names in small letters
--forward, --up   the axis that points out of the face, and up: x, y or z, with - before it when it points the other way, as in --forward=-y (x, z)
--hz        frames a second of what is written (100)
--gap       what is missing (NaN) is bridged with straight lines; a gap of more seconds than this is an error (0.1)

Needs nothing but Python. What is written: time (s), then NAME_x (forward) and NAME_z (up) of each sensor, mm.
"""
import argparse
import math
import struct
import sys
import zlib

MARKERS = {"ul", "ll", "jaw", "tt", "tb", "tr"}
NUMBERS = {1: "b", 2: "B", 3: "h", 4: "H", 5: "i", 6: "I", 7: "f", 9: "d", 12: "q", 13: "Q", 16: "B", 17: "H"}
COMPRESSED, MATRIX, CELL, STRUCT, CHAR = 15, 14, 1, 2, 4


class Mat:
    """The elements of a MATLAB 5 file ("MAT-File Format", The MathWorks)."""

    def __init__(self, data):
        if data[:6] == b"MATLAB" and b"7.3" in data[:116] or data[:4] == b"\x89HDF":
            raise ValueError("this is MATLAB 7.3 (HDF5): save it with -v7")
        if len(data) < 128 or data[126:128] not in (b"IM", b"MI"):
            raise ValueError("this is no MATLAB 5 file")
        self.order = "<" if data[126:128] == b"IM" else ">"
        self.data = data

    def elements(self, data, at=0):
        while at + 8 <= len(data):
            kind, size = struct.unpack_from(self.order + "II", data, at)
            if kind >> 16:  # a small one: size and kind share four bytes
                kind, size, start, after = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            else:
                start = at + 8
                after = start + size + (-size % 8 if kind != COMPRESSED else 0)
            if start + size > len(data):
                raise ValueError("the file ends too early")
            yield kind, data[start:start + size]
            at = after

    def numbers(self, kind, content):
        letter = NUMBERS.get(kind)
        if not letter:
            return []
        return list(struct.unpack(f"{self.order}{len(content) // struct.calcsize(letter)}{letter}",
                                  content[:len(content) // struct.calcsize(letter) * struct.calcsize(letter)]))

    def matrix(self, content):
        """A matrix: its name, and a list of numbers by columns with its shape, a text, or a list of structs or cells."""
        if not content:
            return "", (0, 0), []
        parts = self.elements(content)
        array_class = self.numbers(*next(parts))[0] & 0xFF
        shape = tuple(self.numbers(*next(parts)))
        name = bytes(next(parts)[1]).decode("latin-1")
        if array_class == STRUCT:
            length = self.numbers(*next(parts))[0]
            names = next(parts)[1]
            fields = [names[i:i + length].split(b"\0")[0].decode("latin-1") for i in range(0, len(names), length)]
            values = [self.matrix(part) for kind, part in parts if kind == MATRIX]
            return name, shape, [dict(zip(fields, values[i:i + len(fields)])) for i in range(0, len(values), max(1, len(fields)))]
        if array_class == CELL:
            return name, shape, [self.matrix(part) for kind, part in parts if kind == MATRIX]
        values = self.numbers(*next(parts, (9, b"")))
        return name, shape, "".join(map(chr, values)) if array_class == CHAR else values

    def variables(self):
        for kind, content in self.elements(self.data, 128):
            if kind == COMPRESSED:
                kind, content = next(self.elements(zlib.decompress(content)))
            if kind == MATRIX:
                yield self.matrix(content)


def read_mat(data):
    """name -> (rate, list of (x, y, z))."""
    out = {}
    for _, _, value in Mat(data).variables():
        if not isinstance(value, list) or not value or not isinstance(value[0], dict) or "SIGNAL" not in value[0]:
            continue
        for entry in value:
            name, rate, (_, shape, signal) = entry["NAME"][2], entry["SRATE"][2], entry["SIGNAL"]
            if len(shape) == 2 and shape[1] >= 3 and rate:
                n = shape[0]
                out[str(name)] = (float(rate[0]), [(signal[i], signal[n + i], signal[2 * n + i]) for i in range(n)])
    return out


def read_pos(data):
    channels, rate, start = 12, 200.0, 0
    if data[:2] == b"AG":
        lines = data[:65536].split(b"\n")
        start = int(lines[1])
        for line in data[:start].decode("latin-1").replace("\r", "").split("\n"):
            key, _, value = line.partition("=")
            if key.strip() == "NumberOfChannels":
                channels = int(value)
            if key.strip() == "SamplingFrequencyHz":
                rate = float(value)
    frame = 7 * channels
    count = (len(data) - start) // (4 * frame)
    values = struct.unpack_from(f"<{count * frame}f", data, start)
    return {str(c + 1): (rate, [values[i * frame + 7 * c:i * frame + 7 * c + 3] for i in range(count)]) for c in range(channels)}


def bridge(values, rate, longest, name):
    """Puts straight lines across what is missing."""
    known = [i for i, v in enumerate(values) if not math.isnan(v)]
    if not known:
        raise ValueError(f"{name}: nothing was recorded")
    edges = [-1] + known + [len(values)]
    gap = max(b - a - 1 for a, b in zip(edges, edges[1:])) / rate
    if gap > longest:
        raise ValueError(f"{name}: {gap:.3f} s are missing")
    out = list(values)
    for a, b in zip(edges, edges[1:]):
        for i in range(a + 1, b):
            left, right = values[a] if a >= 0 else values[b], values[b] if b < len(values) else values[a]
            out[i] = left + (right - left) * ((i - a) / (b - a) if a >= 0 and b < len(values) else 0)
    return out


def axis(name):
    sign, letter = (-1, name[1:]) if name.startswith("-") else (1, name)
    if letter not in ("x", "y", "z"):
        raise argparse.ArgumentTypeError("x, y or z, with - before it or without")
    return sign, "xyz".index(letter)


def at(values, rate, t):
    i = min(t * rate, len(values) - 1)
    low = min(int(i), len(values) - 2) if len(values) > 1 else 0
    return values[low] + (i - low) * (values[min(low + 1, len(values) - 1)] - values[low])


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--sensors")
    parser.add_argument("--forward", type=axis, default=(1, 0))
    parser.add_argument("--up", type=axis, default=(1, 2))
    parser.add_argument("--hz", type=float, default=100)
    parser.add_argument("--gap", type=float, default=0.1)
    parser.add_argument("file")
    o = parser.parse_args()
    with open(o.file, "rb") as file:
        data = file.read()
    sensors = read_pos(data) if o.file.lower().endswith(".pos") else read_mat(data)
    wanted = dict(pair.split("=") for pair in o.sensors.split(",")) if o.sensors else \
        {name: name.lower() for name in sensors if name.lower() in MARKERS}
    missing = [name for name in wanted if name not in sensors]
    if missing or not wanted:
        raise ValueError(f"no sensor {', '.join(missing) or 'is named ul, ll, jaw, tt or tb'}: there are {', '.join(sensors)}")
    columns = {}
    for name, marker in wanted.items():
        rate, points = sensors[name]
        for suffix, (sign, which) in (("x", o.forward), ("z", o.up)):
            columns[f"{marker}_{suffix}"] = rate, [sign * v for v in bridge([p[which] for p in points], rate, o.gap, name)]
    seconds = min(len(values) / rate for rate, values in columns.values())
    print(",".join(["time", *columns]))
    for k in range(int(seconds * o.hz)):
        print(",".join([f"{k / o.hz:.4f}", *(f"{at(values, rate, k / o.hz):.3f}" for rate, values in columns.values())]))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError, KeyError, StopIteration, struct.error, zlib.error) as problem:
        sys.exit(f"articulograph.py: {problem}")
