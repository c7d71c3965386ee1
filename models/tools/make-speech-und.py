#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes models/speech/und.json, the lips of every language that has no pack of its own.

    make-speech-und.py > models/speech/und.json

Each letter of the International Phonetic Alphabet gets its shape from its articulatory features, as
models/speech/alphabets/ipa.json has them: a vowel's lips from its height and rounding, a consonant's from its place and manner,
in the terms of the Italian pack, whose measured shapes they borrow. Letters that the Italian pack has are left to it. Diphthongs
and most affricates need no entry: the run time cuts a name into its letters, each with an equal share of the time.
"""
import json
import pathlib

SPEECH = pathlib.Path(__file__).resolve().parent.parent / "speech"
HEIGHTS = ["close", "near-close", "close-mid", "mid", "open-mid", "near-open", "open"]
DEPTHS = ["front", "near-front", "central", "near-back", "back"]

# The cardinal vowels that Italian has, from close to open, two heights apart; what lies between is their mean.
SPREAD = ["i", "e", "ɛ", "a"]
ROUND = ["u", "o", "ɔ", "ɒ"]
# Tongue advance (mm): the Italian vowels' on the front line, close and open, and on the back line. A vowel elsewhere moves there.
FRONT, BACK = (0.5, -2.0), -4.5
# Unrounded back vowels are spread a fifth as far as front ones (as Turkish /ɯ/ beside /i/).
SPREAD_LOST = 0.8

# Places in the order of the pack; for each manner the letter whose shape is borrowed, and what is different:
# (like, gain, shift, other keys).
TIP_BACK = {"TA": -3.0, "TB": 1.0}  # the tip curled back behind the ridge
FLAT = {"AR": 0.6, "PI": 0.6, "PS": 0.6}  # sibilants that protrude less than Italian /ʃ/
FLATTER = {"AR": 0.35, "PI": 0.35, "PS": 0.35}
# Lips that nearly touch: /p/'s are 1.5 mm beyond it.
NEARLY = dict(shift={"LI": 2.2, "LS": 0.7}, contact={"kind": "none"})
VOICED = {"p": "b", "t": "d", "k": "ɡ", "f": "v", "θ": "ð", "s": "z", "ʃ": "ʒ"}
PLACES = {
    "bilabial": {"plosive": ("p", {}), "nasal": ("m", {}), "trill": ("p", {}), "fricative": ("p", NEARLY)},
    "labiodental": {"*": ("f", {})},
    "dental": {"fricative": ("θ", {}), "plosive": ("t", {"shift": {"TA": 1.0}})},
    "alveolar": {
        "plosive": ("t", {}), "nasal": ("n", {}), "trill": ("r", {}), "tap": ("r", {}), "fricative": ("s", {}),
        "lateral": ("l", {}), "approximant": ("r", {}),
    },
    "postalveolar": {"*": ("ʃ", {})},
    "retroflex": {
        "plosive": ("t", {"shift": TIP_BACK}), "nasal": ("n", {"shift": TIP_BACK}), "tap": ("r", {"shift": TIP_BACK}),
        "lateral": ("l", {"shift": TIP_BACK}), "approximant": ("r", {"shift": TIP_BACK}), "fricative": ("ʃ", {"gain": FLAT}),
    },
    "palatal": {
        "plosive": ("k", {"shift": {"TA": 3.0}}), "nasal": ("ɲ", {}), "lateral": ("ʎ", {}), "*": ("j", {}),
    },
    "velar": {"nasal": ("ŋ", {}), "*": ("k", {})},
    "uvular": {"nasal": ("ŋ", {"shift": {"TA": -2.0}}), "*": ("k", {"shift": {"TA": -2.0}})},
    "pharyngeal": {"*": ("h", {})},
    "glottal": {"*": ("h", {})},
    "labial-velar": {"*": ("w", {})},
    "labial-palatal": {"*": ("w", {"shift": {"TA": 4.0, "TB": 1.0}})},
}
# Where the features alone do not say it.
OWN = {
    # r-coloured vowels are half rounded, if that
    "ɚ": {"like": {"ə": 0.7, "ʊ": 0.3}},
    "ɝ": {"like": {"ə": 0.6, "ʊ": 0.2, "ɔ": 0.2}},
    # sibilants of the blade, with lips at ease
    "ɕ": {"like": "ʃ", "gain": FLATTER},
    "ʑ": {"like": "ʒ", "gain": FLATTER},
    "ɧ": {"like": {"ʃ": 0.5, "x": 0.5}},
    # English /w/ without voice and with friction
    "ʍ": {"like": "w"},
    # fricatives of the soft palate are opener than its plosives
    "ɣ": {"like": "ɡ", "shift": {"TB": -2.0}},
    "ɰ": {"like": "ɡ", "shift": {"TB": -2.0}},
}
# What is written with more than a letter of the alphabet, or with another one.
MORE = {
    "tɕ": ("ts\\", {"like": "tʃ", "gain": FLATTER}),
    "dʑ": ("dz\\", {"like": "dʒ", "gain": FLATTER}),
    "ʈʂ": ("t`s`", {"like": "tʃ", "gain": FLAT}),
    "ɖʐ": ("d`z`", {"like": "dʒ", "gain": FLAT}),
    "tʂ": ("ts`", {"like": "tʃ", "gain": FLAT}),
    "dʐ": ("dz`", {"like": "dʒ", "gain": FLAT}),
    "ʦ": ("ts", {"like": "ts"}),
    "ʣ": ("dz", {"like": "dz"}),
    "ʧ": ("tS", {"like": "tʃ"}),
    "ʤ": ("dZ", {"like": "dʒ"}),
    "ʨ": ("ts\\", {"like": "tɕ"}),
    "ʥ": ("dz\\", {"like": "dʑ"}),
    # two closures at once: the lips have one
    "kp": ("k_p", {"like": "p"}),
    "ɡb": ("g_b", {"like": "b"}),
    "ŋm": ("N_m", {"like": "m"}),
    # a rounded release, after whatever it follows
    "ʷ": ("_w", {"like": "w"}),
    # Japanese /u/: the lips come together without coming forward
    "ɯᵝ": ("M_B", {"like": {"u": 0.5, "ɯ": 0.5}, "gain": {"PI": 0.3, "PS": 0.3, "AR": 0.6}}),
    # a Czech /r/ with the friction of /ʒ/, whose lips it has
    "r̝": ("r_r", {"like": {"ʒ": 0.6, "r": 0.4}}),
    # syllabic vowels after Chinese sibilants
    "ɿ": ("z_=", {"like": "ɨ"}),
    "ʅ": ("z`_=", {"like": "ɨ"}),
    # letters that voices use for others that look like them
    "ä": ("a_\"", {"like": "a"}),
    "ε": ("E", {"like": "ɛ"}),
    "Φ": ("p\\", {"like": "ɸ"}),
}
def sampa_names():
    """X-SAMPA (J. C. Wells 1995) by letter."""
    names = """
        ɨ 1  ʉ }  ɯ M  ʏ Y  ᵻ I\\  ᵿ U\\  ø 2  ɘ @\\  ɵ 8  ɤ 7  ɚ @`  œ 9  ɜ 3  ɝ 3`  ɞ 3\\  ʌ V  æ {  ɐ 6  ɶ &  ɑ A
        ɓ b_<  ʙ B\\  ɸ p\\  β B  ʋ P  ⱱ v_d  ɗ d_<  ɬ K  ɮ K\\  ɹ r\\  ɫ 5  ɺ l\\  ʈ t`  ɖ d`  ɳ n`  ɽ r`  ʂ s`  ʐ z`
        ɻ r\\`  ɭ l`  ɕ s\\  ʑ z\\  c c  ɟ J\\  ʄ J\\_<  ç C  ʝ j\\  ɥ H  g g  ɠ g_<  ɣ G  ɰ M\\  ʟ L\\  ɧ x\\  ʍ W  q q
        ɢ G\\  ʛ G\\_<  ɴ N\\  ʀ R\\  χ X  ʁ R  ħ X\\  ʕ ?\\  ʜ H\\  ʢ <\\  ʡ >\\  ɦ h\\  ʘ O\\  ǀ |\\  ǃ !\\  ǂ =\\  ǁ |\\|\\
    """.split()
    return dict(zip(names[::2], names[1::2]))


def rounded(x):
    return round(x + 0.0, 3)


def between(anchors, height):
    """Weights of the two anchors that a height lies between."""
    place = height / 2
    low = min(int(place), len(anchors) - 2)
    share = place - low
    return {a: w for a, w in ((anchors[low], 1 - share), (anchors[low + 1], share)) if w > 0}


def vowel(features):
    height, depth = HEIGHTS.index(features["height"]), DEPTHS.index(features["depth"]) / 4
    front = FRONT[0] + (FRONT[1] - FRONT[0]) * height / 6
    if features["lips"] == "unrounded":
        weights, gain, advance = between(SPREAD, height), {"AR": rounded(1 - SPREAD_LOST * depth)}, depth * (BACK - front)
    else:
        weights, gain = between(ROUND, height), {}
        close = weights.pop("u", 0)
        advance = (1 - close) * (1 - depth) * (front - BACK)
        weights = {"u": close * depth, "y": close * (1 - depth), **weights}
    like = {a: rounded(w) for a, w in weights.items() if w > 0}
    phone = {"like": like if len(like) > 1 else next(iter(like))}
    if gain.get("AR", 1) != 1:
        phone["gain"] = gain
    if advance:
        phone["shift"] = {"TA": rounded(advance)}
    return phone


def consonant(letter, features):
    manners = PLACES[features["place"]]
    model, changes = manners.get(features["manner"]) or manners["*"]
    if features["voice"] == "voiced":
        model = VOICED.get(model, model)
    if model == letter:
        raise SystemExit(f"{letter}: is described by itself")
    return {"like": model, **changes}


def main():
    alphabet = json.loads((SPEECH / "alphabets/ipa.json").read_text())
    italian = json.loads((SPEECH / "it.json").read_text())["phones"]
    sampa, phones = sampa_names(), {}
    for letter, features in {**alphabet["vowels"], **alphabet["consonants"]}.items():
        if letter in italian:
            continue
        phone = OWN.get(letter) or (vowel(features) if "height" in features else consonant(letter, features))
        phones[letter] = {"sampa": sampa[letter], **phone}
    for name, (sampa_name, phone) in MORE.items():
        phones[name] = {"sampa": sampa_name, **phone}
    pack = {
        "tag": "und",
        "name": "International Phonetic Alphabet",
        "inherits": "it",
        "sources": [
            "Written by models/tools/make-speech-und.py from the articulatory features of alphabets/ipa.json; shapes borrowed from"
            " the Italian pack."
        ],
        "voices": [],
        "abbreviations": ["dr", "prof", "st", "vol", "fig", "tel", "etc", "cf"],
    }
    text = json.dumps(pack, ensure_ascii=False, indent=2)[:-2] + ',\n  "phones": {\n'
    text += ",\n".join(f"    {json.dumps(k, ensure_ascii=False)}: {json.dumps(v, ensure_ascii=False)}" for k, v in phones.items())
    print(text + "\n  }\n}")


if __name__ == "__main__":
    main()
