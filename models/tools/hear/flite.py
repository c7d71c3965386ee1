# SPDX-License-Identifier: GPL-3.0-or-later
"""Voices of Flite for the training, made of recordings of an American and a Scottish man, in the form of people.py.

python3 flite.py OUT.npz [--minutes N] [--seed N]
Wants flite, wamerican and python3-numpy. The words are English, and some made up of the sounds that the lips make.
"""
import argparse
import json
import os
import subprocess
import tempfile

import numpy as np
from make_data import OFTEN, words_of
from people import read
from sounds import RATE

VOICES = ['rms', 'awb']
# Flite's names are those of CMU's dictionary.
IPA = {
    'pau': '', 'aa': 'ɑ', 'ae': 'æ', 'ah': 'ʌ', 'ao': 'ɔ', 'aw': 'aʊ', 'ax': 'ə', 'axr': 'ɚ', 'ay': 'aɪ', 'b': 'b', 'ch': 'tʃ', 'd': 'd', 'dh': 'ð', 'dx': 'ɾ',
    'eh': 'ɛ', 'er': 'ɝ', 'ey': 'eɪ', 'f': 'f', 'g': 'ɡ', 'hh': 'h', 'ih': 'ɪ', 'iy': 'i', 'jh': 'dʒ', 'k': 'k', 'l': 'l', 'm': 'm', 'n': 'n', 'ng': 'ŋ',
    'ow': 'oʊ', 'oy': 'ɔɪ', 'p': 'p', 'r': 'ɹ', 's': 's', 'sh': 'ʃ', 't': 't', 'th': 'θ', 'uh': 'ʊ', 'uw': 'u', 'v': 'v', 'w': 'w', 'y': 'j', 'z': 'z', 'zh': 'ʒ',
}  # fmt: skip


def text_of(rng, words, often):
    def word():
        kind = rng.random()
        if kind < 0.3:
            return ''.join(rng.choice(['p', 'b', 'm', 'f', 'v', 't', 'k', 'n', 'l', 's', 'g', 'sh', 'r']) + rng.choice(['a', 'e', 'i', 'o', 'u', 'ee', 'ay', 'oo']) for _ in range(rng.integers(1, 4)))
        chosen = often if kind < 0.6 else words
        return chosen[rng.integers(len(chosen))]

    return ' '.join(word() + (',' if rng.random() < 0.08 else '') for _ in range(rng.integers(4, 14))).rstrip(',') + '.'


def spoken(rng, voice, text, folder):
    wav = os.path.join(folder, 'a.wav')
    options = [f'duration_stretch={rng.uniform(0.75, 1.25):.2f}', f'f0_shift={rng.uniform(0.75, 1.5):.2f}']
    command = ['flite', '-voice', voice, '-psdur', *(x for o in options for x in ('--setf', o)), '-t', text, '-o', wav]
    told = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    start, phones = 0.0, []
    for name, end in (field.rsplit(':', 1) for field in told.split()):
        phones.append({'ipa': IPA[name], 'start': start, 'end': float(end)})
        start = float(end)
    return read(wav), phones


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('out')
    parser.add_argument('--minutes', type=float, default=20, help='of speech')
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rng, words = np.random.default_rng(options.seed), words_of('en')
    sounds, items = [], []
    with tempfile.TemporaryDirectory() as folder:
        for voice in VOICES:
            had = 0.0
            while had < options.minutes * 60 / len(VOICES):
                sound, phones = spoken(rng, voice, text_of(rng, words, OFTEN['en'].split()), folder)
                sounds.append(sound)
                items.append({'speaker': f'flite-{voice}', 'name': voice, 'samples': len(sound), 'phones': phones})
                had += len(sound) / RATE
            print(voice, round(had), 's', flush=True)
    np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(items))


if __name__ == '__main__':
    main()
