#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fetches recordings of people's lips and jaws, and prepares them for tests/bench/people.mjs.

    python3 tests/bench/people-fetch.py FOLDER [--git MIRRORS] [--films build/server/cli/faccia]

Nothing of this is in the repository: FOLDER gets the curves (NAME.csv, mm), the phones (NAME.phones.csv) and people.json,
which lists them by person. The files come from public GitHub repositories at fixed commits and must have the SHA-256 below;
--git reads them from bare clones, MIRRORS/OWNER+NAME/repo, instead of from the network. Their licences:

  Haskins production rate comparison (M. Tiede et al., 2017): GPL 3.0, as jaekookang/Python-EMA-Viewer says
  MOCHA-TIMIT (A. Wrench, Queen Margaret University College, 1999): research, educational and individual use
  Wisconsin X-ray microbeam (J. Westbury, 1994): an utterance, as its tools give it as an example
  GRID (M. Cooke, J. Barker, S. Cunningham and X. Shao, 2006): CC BY 4.0; eleven films of ten people, with --films only

The people by articulograph and microbeam are the development set: constants may be chosen on them, by leaving one out. Those on film are
marked `test` in people.json: nothing is chosen on them.

Needs nothing but Python; --films wants a built faccia, ffmpeg, and npm's packages in web/ and models/, and takes some minutes.
"""
import argparse
import csv
import hashlib
import io
import json
import math
import pathlib
import pickle
import struct
import subprocess
import sys
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "models/tools"))
import articulograph  # noqa: E402

VIEWER = "jaekookang/Python-EMA-Viewer", "4c09b275e336e52d25654d147f5d46b8560e4fca"
EXTRACTOR = "jaekookang/Articulatory-Data-Extractor", "813b8c077551a53018b8916b66eab1ff1999826f"
TONGUE = "eecqin/TongueReconstruction", "35d8a13d7d4bcf8bba2dec230440a2215be5ac68"
FPS = 100
LONGEST_GAP = 0.1  # s that are bridged

# Machine-readable phonetic alphabet of Edinburgh, as MOCHA-TIMIT labels: the names that are not their own IPA.
MRPA = {"sil": "", "breath": "", "dh": "ð", "th": "θ", "sh": "ʃ", "zh": "ʒ", "ch": "tʃ", "jh": "dʒ", "ng": "ŋ", "g": "ɡ", "y": "j",
        "i": "ɪ", "ii": "iː", "iy": "iː", "@": "ə", "@@": "ɜː", "uh": "ʌ", "u": "ʊ", "uu": "uː", "o": "ɒ", "oo": "ɔː", "aa": "ɑː",
        "a": "æ", "e": "ɛ", "ei": "eɪ", "ai": "aɪ", "oi": "ɔɪ", "ou": "əʊ", "au": "aʊ", "r": "ɹ"}


class Array:
    """A numpy array of an untrusted pickle, as plain numbers by rows."""

    def __setstate__(self, state):
        _, self.shape, kind, by_columns, data = state
        if not isinstance(data, bytes):
            self.values = list(data)
            return
        flat = [v[0] for v in struct.iter_unpack("<" + {"f8": "d", "f4": "f", "u1": "B", "u2": "H", "i2": "h", "i4": "i"}[kind], data)]
        rows, columns = (*self.shape, 1)[:2] if self.shape else (1, 1)
        self.values = [[flat[c * rows + r] if by_columns else flat[r * columns + c] for c in range(columns)] for r in range(rows)]


class Kind(str):
    def __setstate__(self, _):
        pass


def scalar(kind, data):
    return data.decode("utf-32-le") if kind[0] == "U" else struct.unpack("<" + {"f8": "d", "f4": "f", "i8": "q", "i4": "i"}[kind], data)[0]


class Plain(pickle.Unpickler):
    """Knows numpy's arrays and nothing else, so that a pickle cannot run anything."""

    def find_class(self, module, name):
        known = {"_reconstruct": lambda *_: Array(), "ndarray": Array, "dtype": lambda kind, *_: Kind(kind), "scalar": scalar}
        if module.split(".")[0] == "numpy" and name in known:
            return known[name]
        if (module, name) == ("_codecs", "encode"):
            return lambda text, coding: text.encode(coding)
        raise pickle.UnpicklingError(f"{module}.{name} is not read")


def haskins_pkl(data):
    value = Plain(io.BytesIO(data)).load()
    sensors = {k.lower(): (v["SRATE"], [tuple(row[:3]) for row in v["SIGNAL"].values]) for k, v in value.items() if k != "AUDIO"}
    said = value["AUDIO"]["PHONES"]
    return sensors, [(*times, name) for times, name in zip(said["OFFS"].values, said["LABEL"])], value["AUDIO"]["SENTENCE"]


def haskins_mat(data):
    sensors = {name.lower(): value for name, value in articulograph.read_mat(data).items()}
    for _, _, entries in articulograph.Mat(data).variables():
        for entry in entries if isinstance(entries, list) else []:
            if isinstance(entry, dict) and entry.get("NAME", ("", 0, ""))[2] == "AUDIO":
                phones = [(*p["OFFS"][2], p["LABEL"][2]) for p in entry["PHONES"][2]]
                return sensors, phones, entry["SENTENCE"][2]
    raise ValueError("there is no entry AUDIO")


def mocha(data, labels):
    rows = [[float(x) for x in line.split()] for line in data.decode().splitlines() if line.strip()]
    columns = {"jaw": (3, 8), "ul": (4, 9), "ll": (5, 10), "tt": (6, 11), "tb": (12, 17), "tr": (13, 18)}  # 1/100 mm; x points backward
    sensors = {name: (500.0, [(-row[x] / 100, 0.0, row[z] / 100) for row in rows]) for name, (x, z) in columns.items()}
    lines = [line.split() for line in labels.decode().splitlines() if line.strip()]
    return sensors, [(float(a), float(b), MRPA.get(name, name)) for a, b, name in lines], ""


def microbeam(data, labels):
    rows = [[float(x) for x in line.split()] for line in data.decode().splitlines() if line.strip()]
    columns = {"ul": 1, "ll": 3, "tt": 5, "tb": 9, "tr": 11, "jaw": 13}  # 1/1000 mm; 1000000 = not tracked

    def mm(value):
        return math.nan if value == 1e6 else value / 1000
    kept = [row for row in rows if all(row[c] != 1e6 for c in columns.values())]
    start = kept[0][0] / 1e6
    rows = [row for row in rows if kept[0][0] <= row[0] <= kept[-1][0]]
    rate = (len(rows) - 1) / (rows[-1][0] - rows[0][0]) * 1e6
    sensors = {name: (rate, [(mm(row[c]), 0.0, mm(row[c + 1])) for row in rows]) for name, c in columns.items()}
    lines = [line.split() for line in labels.decode().splitlines() if line.strip()]
    phones = [(max(0, float(a) - start), float(b) - start, "" if name == "sil" else name) for a, b, name in lines]
    return sensors, [p for p in phones if p[1] > p[0]], ""


# name, person, reader, (repository and commit), files with their SHA-256
RECORDINGS = [
    ("f01-canoe", "haskins-f01", haskins_mat, VIEWER, [("example/F01_B01_S01_R01_N.mat", "719c8b59406257d44933e67c0567915b9a6469211f2dec4cd627ab77955ea496")]),
    ("f01-canoe-fast", "haskins-f01", haskins_pkl, EXTRACTOR, [("example/F01_B01_S01_R01_F.pkl", "bea61c31c3d0e13014edf8e7e647c6d8c83ebdbe2de573782caa6713f853e0f3")]),
    ("m01-canoe", "haskins-m01", haskins_mat, VIEWER, [("example/M01_B01_S01_R01_N.mat", "0a72df9305655cb94622929a6de8f4076bad90240de4829d0ea35e1c8e7bac9d")]),
    ("m04-crate", "haskins-m04", haskins_pkl, VIEWER, [("test/M04_B02_S44_R01_N.pkl", "1b3bece68a4c8e310eea815e93975dcfed82d54b0b4c50a3db78dc84a37f09a5")]),
    ("fsew0-easy", "mocha-fsew0", mocha, TONGUE, [("dat/fsew0_001.ema", "ef602554c0e9262adde84e3831d86721c0f874f7523d0f4525220a80de4dcf45"), ("dat/fsew0_001.lab", "37627b42aaeb84c0504fcb7ced02b0f73a69f1da0a71bdb31e87e13c224bcbb6")]),
    ("jw11-sasa", "microbeam-jw11", microbeam, TONGUE, [("code/XRMBtools/dat/jw11_tp005.txy", "dc665d2e6d3b39bd3483afb8e530cf1d923f23632e7585e19e919983f6746da1"), ("dat/jw11_tp005.lab", "a8ccb1f1e5a0ab014d58f2a656aaeac28303da49e004be83150c4fd71a8bf39f")]),
]

# Films of the GRID corpus; their names say the sentence.
LIPNET = "rizkiarm/LipNet", "bec592aa1e66378bc7ab33f6110f1c8a431b3b9a"
FILMS = [
    ("bbaf2n", "evaluation/samples/GRID/bbaf2n.mpg", "e468120039e208b5ff9b9e269f8dc96bbddc45701f8dddcf2c0ae21abc0df546"),
    ("brbk7n", "evaluation/samples/GRID/brbk7n.mpg", "2122707c6dd3b59a32b5272870afb37397dc6b20cf52241cf8ff7cfda7b3efa3"),
    ("lbax4n", "evaluation/samples/GRID/lbax4n.mpg", "8f80c8ced6a8cb47d55c5c01704d4669b410369af653f6be7fbda9003337dedf"),
    ("lbbc2a", "evaluation/samples/GRID/lbbc2a.mpg", "9447e5e0732eeaf4444b5ba1e3412c8a9e194975ba7c814fa64c4c41c83d4e4c"),
    ("lrwp9a", "evaluation/samples/GRID/lrwp9a.mpg", "1a6c86fc5e7d4e9ee66a891f188f9a648c9b8be3bdc2431d73ac7e533aa70b3f"),
    ("lwbsza", "evaluation/samples/GRID/lwbsza.mpg", "09090d1f7a8a946233a015a1b4258fafcb790ed6dbbd884ed88ae51fe36841a0"),
    ("pwij3p", "evaluation/samples/GRID/pwij3p.mpg", "a610d98c101dde3587cc66d70cb569d3b1d0111cfad90bd0037e47e21316beda"),
    ("sbia1a", "evaluation/samples/GRID/sbia1a.mpg", "768e49272122f1577839db576ea00146d08e83d778c7fe8b9ca1b194dff57c7d"),
    ("sbwe5n", "evaluation/samples/GRID/sbwe5n.mpg", "6707e709f1d713a6ff6673c85605e2fa721cfe59749c56b9f34e6d159c5fdf55"),
    ("swiz3n", "evaluation/samples/GRID/swiz3n.mpg", "080f3e1511879a3baa41cdc31aa7029981f29c71434a570de3d52ee78f9e5dd0"),
    ("id2_vcd_swwp2s", "evaluation/samples/id2_vcd_swwp2s.mpg", "3bb8cffd51399caaf0c97abcd32bcab3493b2878ffda73bd648490ea47c75cc0"),
]
SAME_MAN = {"id2_vcd_swwp2s": "pwij3p"}
GRAMMAR = [
    {"b": "bin", "l": "lay", "p": "place", "s": "set"}, {"b": "blue", "g": "green", "r": "red", "w": "white"},
    {"a": "at", "b": "by", "i": "in", "w": "with"}, None, dict(zip("z123456789", "zero one two three four five six seven eight nine".split())),
    {"a": "again", "n": "now", "p": "please", "s": "soon"},
]
SEEN = 0.25, 0.25  # corners and chin that the film does not show in this share of its pictures, with this confidence, are left out


def fetch(repository, commit, path, mirrors):
    if mirrors:
        folder = pathlib.Path(mirrors) / repository.replace("/", "+") / "repo"
        return subprocess.run(["git", "-C", folder, "cat-file", "-p", f"{commit}:{path}"], check=True, capture_output=True).stdout
    with urllib.request.urlopen(f"https://raw.githubusercontent.com/{repository}/{commit}/{path}", timeout=60) as reply:
        return reply.read()


def write(folder, name, sensors, phones):
    columns = {}
    for marker in ("ul", "ll", "jaw", "tt", "tb", "tr"):
        if marker in sensors:
            rate, points = sensors[marker]
            for suffix, which in (("x", 0), ("z", 2)):
                columns[f"{marker}_{suffix}"] = rate, articulograph.bridge([p[which] for p in points], rate, LONGEST_GAP, marker)
    seconds = min(len(values) / rate for rate, values in columns.values())
    with open(folder / f"{name}.csv", "w") as out:
        print(",".join(["time", *columns]), file=out)
        for k in range(int(seconds * FPS)):
            print(",".join([f"{k / FPS:.2f}", *(f"{articulograph.at(v, rate, k / FPS):.3f}" for rate, v in columns.values())]), file=out)
    with open(folder / f"{name}.phones.csv", "w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["start", "end", "phone"])
        for start, end, phone in phones:
            if end > start:
                table.writerow([f"{start:.4f}", f"{min(end, seconds):.4f}", phone])


def film(folder, name, data, faccia):
    """Lips by landmarks, phones by alignment: faccia's own commands. Returns the text."""
    code = name.split("_")[-1]
    text = " ".join(words[letter] if words else letter.upper() for words, letter in zip(GRAMMAR, code))
    (folder / f"{name}.mpg").write_bytes(data)
    (folder / f"{name}.txt").write_text(text + "\n")
    lips = pathlib.Path(__file__).resolve().parent.parent.parent / "models/tools/lips/faccia-lips.mjs"
    for command in (["ffmpeg", "-v", "error", "-y", "-i", f"{name}.mpg", "-ac", "1", "-ar", "16000", f"{name}.wav"],
                    [faccia, "align", "--lang", "en", "-q", "--text", f"{name}.txt", "--json", f"{name}.json", f"{name}.wav"],
                    ["node", lips, f"{name}.mpg", "--fps", "25", "-o", f"{name}.seen.csv"]):
        subprocess.run(command, check=True, cwd=folder)
    with open(folder / f"{name}.seen.csv", newline="") as seen:
        rows = list(csv.DictReader(seen))
    shown = [p for p in ("LI", "LS", "AR", "EM")
             if p[0] == "L" or sum(float(r[f"{p}_confidence"]) >= SEEN[1] for r in rows) >= SEEN[0] * len(rows)]
    with open(folder / f"{name}.csv", "w") as out:
        for row in [{p: p for p in ("time", *shown)}, *rows]:
            print(",".join(row[p] for p in ("time", *shown)), file=out)
    with open(folder / f"{name}.phones.csv", "w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["start", "end", "phone"])
        for p in json.loads((folder / f"{name}.json").read_text())["phones"]:
            table.writerow([p["start"], p["end"], ("", "ˌ", "ˈ")[p.get("stress", 0)] + p["ipa"]])
    return text


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--git")
    parser.add_argument("--films", metavar="FACCIA")
    o = parser.parse_args()
    o.folder.mkdir(parents=True, exist_ok=True)
    people = []
    for name, person, read, (repository, commit), files in RECORDINGS:
        data = []
        for path, wanted in files:
            data.append(fetch(repository, commit, path, o.git))
            found = hashlib.sha256(data[-1]).hexdigest()
            if found != wanted:
                raise ValueError(f"{repository}/{path}: SHA-256 is {found}, not {wanted}")
        sensors, phones, text = read(*data)
        write(o.folder, name, sensors, phones)
        people.append({"name": name, "person": person, "lang": "en", "text": text, **({"late": 30} if person.startswith("haskins") else {}), "from": f"https://github.com/{repository}"})
    for name, path, wanted in FILMS if o.films else []:
        data = fetch(*LIPNET, path, o.git)
        if hashlib.sha256(data).hexdigest() != wanted:
            raise ValueError(f"{path}: another SHA-256")
        people.append({"name": name, "person": "grid-" + SAME_MAN.get(name, name), "test": True, "lang": "en",
                       "text": film(o.folder, name, data, pathlib.Path(o.films).resolve()), "from": f"https://github.com/{LIPNET[0]}"})
    (o.folder / "people.json").write_text(json.dumps(people, indent=1, ensure_ascii=False) + "\n")
    print(f"{len(people)} recordings of {len({p['person'] for p in people})} people in {o.folder}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError, KeyError, struct.error, pickle.UnpicklingError, subprocess.CalledProcessError) as problem:
        sys.exit(f"people-fetch.py: {problem}")
