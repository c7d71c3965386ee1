# SPDX-License-Identifier: MIT
"""Writes fap/*.fap, small files in the .fap text format as tools in the field write them, and broken ones, and fap.json, which
says what a reader must find in each, and where what it passes over is, or the line and column at which it must complain (bytes, from 1).
Usage: make-fap.py, in this folder."""
import json
import pathlib

folder = pathlib.Path("fap")
folder.mkdir(exist_ok=True)
catalogue = []


def mask(*faps):
    return " ".join("1" if n in faps else "0" for n in range(1, 69))


def frame(values=None, viseme=None, expression=None):
    """What a reader finds: the FAPs of the mask with their values."""
    found = {"values": {str(n): v for n, v in (values or {}).items()}}
    if viseme:
        found["viseme"] = viseme
    if expression:
        found["expression"] = expression
    return found


def write(file, text):
    (folder / file).write_bytes(text.encode("utf-8"))


def good(file, text, frames, version="2.1", name="sample", fps=25, note=None):
    write(file, text)
    entry = {"file": file, "version": version, "name": name, "fps": fps, "frames": frames}
    if note:
        entry["note"] = {"line": note[0], "column": note[1]}
    catalogue.append(entry)


def bad(file, text, line, column):
    write(file, text)
    catalogue.append({"file": file, "error": {"line": line, "column": column}})


all_low = list(range(3, 69))
two = f"{mask(3, 5)}\n0 100 -20\n{mask(68)}\n1 7\n"
two_frames = [frame({3: 100, 5: -20}), frame({68: 7})]

good("version-2.1.fap", "2.1 sample 25 2\n" + two, two_frames)
good("version-2.0.fap", "2.0 sample 25 2\n" + two, two_frames, version="2.0")
good("spaces-in-name.fap", "2.1 C:\\My voices\\una  prova 2.wav 29.97 2\n" + two, two_frames,
     name="C:\\My voices\\una  prova 2.wav", fps=29.97)
good("accents-in-name.fap", "2.1 perché no 12.5 2\n" + two, two_frames, name="perché no", fps=12.5)
good("no-name.fap", "2.1 50 2\n" + two, two_frames, name="", fps=50)
good("no-header.fap", two, two_frames, version="", name="")
good("crlf.fap", ("2.1 sample 25 2\n" + two).replace("\n", "\r\n"), two_frames)
good("cr.fap", ("2.1 sample 25 2\n" + two).replace("\n", "\r"), two_frames)
good("byte-order-mark.fap", "\ufeff2.1 sample 25 2\n" + two, two_frames)
good("comments.fap",
     f"# one\n\n  # two\n2.1 sample 25 2\n#{mask(4)}\n{mask(3, 5)}\n# between mask and values\n0 100 -20\n\n{mask(68)}\n1 7\n# end",
     two_frames)
good("tabs.fap", ("2.1 sample 25 2\n" + two).replace(" ", "\t").replace("\n", " \t\n"), two_frames)
good("no-final-newline.fap", "2.1 sample 25 2\n" + two.rstrip("\n"), two_frames)
good("no-frames.fap", "2.1 sample 25 0\n", [])
good("more-frames-than-stated.fap", "2.1 sample 25 1\n" + two, two_frames)
good("other-frame-numbers.fap", f"2.1 sample 25 2\n{mask(3)}\n10 1\n{mask(3)}\n7 2\n", [frame({3: 1}), frame({3: 2})])
good("empty-mask.fap", f"2.1 sample 25 1\n{mask()}\n0\n", [frame()])
good("viseme.fap", f"2.1 sample 25 1\n{mask(1, 3)}\n0 1 10 63 0 -5\n", [frame({3: -5}, viseme=[1, 10, 63, 0])])
good("expression.fap", f"2.1 sample 25 1\n{mask(2)}\n0 1 40 6 20 0 1\n", [frame(expression=[1, 40, 6, 20, 0, 1])])
good("viseme-and-expression.fap", f"2.1 sample 25 1\n{mask(1, 2, 68)}\n0 14 0 32 1 3 63 0 0 1 0 9\n",
     [frame({68: 9}, viseme=[14, 0, 32, 1], expression=[3, 63, 0, 0, 1, 0])])
good("minus-infinity.fap", f"2.1 sample 25 1\n{mask(3, 4, 5)}\n0 1 -inf 3\n", [frame({3: 1, 4: 0, 5: 3})])
good("decimals.fap", f"2.1 sample 25 1\n{mask(3, 4, 5, 6)}\n0 1.4 -1.6 +7 3.\n", [frame({3: 1, 4: -2, 5: 7, 6: 3})])
good("limits.fap", f"2.1 sample 25 1\n{mask(23, 24)}\n0 2147483647 -2147483648\n",
     [frame({23: 2147483647, 24: -2147483648})])
good("all-faps.fap", f"2.1 sample 25 1\n{mask(*all_low)}\n0 {' '.join(str(n * 7 - 200) for n in all_low)}\n",
     [frame({n: n * 7 - 200 for n in all_low})])

greta = f"{mask(3, 5)} 0\n0 100 -20\n{mask(68)} 0\n1 7\n"
good("mask-of-69.fap", "2.1 sample 25 2\n" + greta, two_frames, note=(2, 137))
good("mask-of-69-later.fap", f"2.1 sample 25 2\n{mask(3, 5)}\n0 100 -20\n{mask(68)} 0\n1 7\n", two_frames, note=(4, 137))
good("mask-of-69-no-header.fap", greta, two_frames, version="", name="", note=(1, 137))
good("count-alone.fap", "2\n" + two, two_frames, version="", name="")
good("count-of-one-alone.fap", f"1\n{mask(3)}\n0 4\n", [frame({3: 4})], version="", name="")
good("count-of-nothing-alone.fap", "0\n", [], version="", name="")
good("count-alone-of-69.fap", "2 \n" + greta, two_frames, version="", name="", note=(2, 137))
good("rate-and-count.fap", "12.5\t2\n" + two, two_frames, version="", name="", fps=12.5)

head = "2.1 sample 25 1\n"
bad("empty.fap", "", 1, 1)
bad("comments-only.fap", "# nothing\n\n", 3, 1)
bad("another-version.fap", "3.0 sample 25 1\n" + two, 1, 1)
bad("another-format.fap", "<fap>\n</fap>\n", 1, 1)
bad("header-without-count.fap", "2.1 sample 25\n" + two, 1, 14)
bad("header-of-one-word.fap", "2.1\n" + two, 1, 4)
bad("frame-rate-0.fap", "2.1 sample 0 2\n" + two, 1, 12)
bad("frame-rate-with-comma.fap", "2.1 sample 29,97 2\n" + two, 1, 12)
bad("frame-rate-in-hex.fap", "2.1 sample 0x19 2\n" + two, 1, 12)
bad("count-negative.fap", "2.1 sample 25 -2\n" + two, 1, 15)
bad("count-broken.fap", "2.1 sample 25 2.5\n" + two, 1, 15)
bad("nul-in-name.fap", "2.1 sam\0ple 25 2\n" + two, 1, 8)
bad("mask-of-67.fap", f"{head}{mask(3)[:-2]}\n0 1\n", 2, 134)
bad("mask-of-69-set.fap", f"{head}{mask(3)} 1\n0 1\n", 2, 137)
bad("mask-of-69-no-flag.fap", f"{head}{mask(3)} 2\n0 1\n", 2, 137)
bad("mask-of-70.fap", f"{head}{mask(3)} 0 0\n0 1\n", 2, 139)
bad("count-alone-too-high.fap", "3\n" + two, 6, 1)
bad("count-alone-broken.fap", "2.5\n" + two, 1, 1)
bad("rate-and-count-too-fast.fap", "1001 2\n" + two, 1, 1)
bad("flag-2.fap", f"{head}{mask(3)[:8]}2{mask(3)[9:]}\n0 1\n", 2, 9)
bad("flags-glued.fap", f"{head}{mask(3).replace(' ', '')}\n0 1\n", 2, 1)
bad("mask-without-values.fap", f"{head}{mask(3)}\n", 3, 1)
bad("value-missing.fap", f"{head}{mask(3, 4)}\n0 1 \n", 3, 5)
bad("value-too-many.fap", f"{head}{mask(3, 4)}\n0 1 2 3\n", 3, 7)
bad("value-no-number.fap", f"{head}{mask(3, 4)}\n0 1 2x\n", 3, 5)
bad("value-in-hex.fap", f"{head}{mask(3)}\n0 0x10\n", 3, 3)
bad("value-sign-only.fap", f"{head}{mask(3)}\n0 -\n", 3, 3)
bad("value-too-large.fap", f"{head}{mask(3)}\n0 2147483648\n", 3, 3)
bad("value-of-400-digits.fap", f"{head}{mask(3)}\n0 {'9' * 400}\n", 3, 3)
bad("viseme-too-large.fap", f"{head}{mask(1)}\n0 1 256 0 0\n", 3, 5)
bad("viseme-cut-short.fap", f"{head}{mask(1)}\n0 1 2 3\n", 3, 8)
bad("expression-negative.fap", f"{head}{mask(2)}\n0 1 -2 0 0 0 0\n", 3, 5)
bad("frame-number-negative.fap", f"{head}{mask(3)}\n-1 1\n", 3, 1)
bad("fewer-frames-than-stated.fap", "2.1 sample 25 3\n" + two, 6, 1)
bad("crlf-value-missing.fap", f"{head}{mask(3)}\n0\n".replace("\n", "\r\n"), 3, 2)

with open("fap.json", "w", encoding="utf-8") as file:
    file.write("[\n " + ",\n ".join(json.dumps(entry, ensure_ascii=False) for entry in catalogue) + "\n]\n")
