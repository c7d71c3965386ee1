# SPDX-License-Identifier: GPL-3.0-or-later
"""Speech with known phones, as features: synthetic voices say words from Debian's lists, and microphones of all kinds hear it.

python3 make_data.py BUILD OUT.npz [--minutes N] [--people FILE.npz] [--times N]
FILE.npz: of people.py. BUILD: where faccia was built, with server/live/hear-features and server/live/hear-curves. Wants python3-scipy, witalian, wbrazilian, wamerican, hunspell-tr, and the voices of espeak-ng and Festival. Seeds are fixed.
"""
import argparse
import json
import os
import re
import subprocess
import tempfile
import wave

import numpy as np
from scipy import signal
from music import nobodys
from people import HELD, pieces
from sounds import RATE, augmented, classes_of, coloured, labels

LISTS = {
    'it': '/usr/share/dict/italian',
    'pt': '/usr/share/dict/brazilian',
    'en': '/usr/share/dict/american-english',
    'tr': '/usr/share/hunspell/tr_TR.dic',
}
# What dictionaries have once and people say all the time.
OFTEN = {
    'it': 'il la di che e un una per non con sono del della ma più anche mi si ho va bene prego prima',
    'pt': 'o a de que e um uma não com por mais mas eu você bem muito foi para',
    'en': 'the this that they then there with both thing think mother other of and to for from have be my we you very shall much which',
    'tr': 've bir bu da ne için çok ama var ben o mı evet şu',
}
# Never heard while training: festival:kal and espeak's Spanish, for the tests.
VOICES = [
    ('festival:lp', 'it', 'it', 5), ('festival:pc', 'it', 'it', 5), ('festival:slt', 'en', 'en', 5),
    ('espeak:it', 'it', 'it', 1), ('espeak:it+f2', 'it', 'it', 1), ('espeak:pt-br', 'pt-BR', 'pt', 1), ('espeak:pt-br+f2', 'pt-BR', 'pt', 1),
    ('espeak:tr', 'tr', 'tr', 1), ('espeak:tr+f2', 'tr', 'tr', 1), ('espeak:en-us', 'en', 'en', 1), ('espeak:en-us+f2', 'en', 'en', 1),
    ('espeak:en-gb', 'en', 'en', 1), ('espeak:de', 'de', 'en', 0.7), ('espeak:fr-fr', 'fr', 'it', 0.7), ('espeak:pl', 'pl', 'it', 0.7),
    ('espeak:ro+f2', 'ro', 'it', 0.7), ('espeak:nl', 'nl', 'en', 0.7), ('espeak:sv+f2', 'sv', 'en', 0.7),
]  # voice, language, list of words, share
PIECE = 6.0  # seconds
LENGTH = int(PIECE / 1.25 * 100) - 5  # frames of the shortest


def words_of(name):
    with open(LISTS[name], encoding='utf-8', errors='ignore') as file:
        words = [line.split('/')[0].strip() for line in file]
    return [w for w in words if re.fullmatch(r'[^\W\d_]{2,11}', w) and w[1:].islower()]


def text_of(rng, words, often):
    def word():
        chosen = often if rng.random() < 0.35 else words
        return chosen[rng.integers(len(chosen))] + (',' if rng.random() < 0.12 else '')

    return ' '.join(' '.join(word() for _ in range(rng.integers(3, 12))).rstrip(',').capitalize() + '.' for _ in range(14))


def spoken(build, voice, lang, text, rng, folder):
    """Sound at RATE and its phones; None where the voice does not."""
    wav, out = os.path.join(folder, 'a.wav'), os.path.join(folder, 'a.json')
    rate, pitch = str(int(rng.uniform(115, 230))), f'{rng.uniform(0.7, 1.4):.2f}'
    done = subprocess.run(
        [f'{build}/server/cli/faccia', 'say', '-l', lang, '-v', voice, '-r', rate, '--pitch', pitch, '--wav', wav, '--json', out, text],
        capture_output=True, check=False,
    )
    if done.returncode == 2 or not os.path.exists(out):
        raise SystemExit(f'{voice}: {done.stderr.decode()[:300]}')
    with wave.open(wav) as file:
        hz, sound = file.getframerate(), np.frombuffer(file.readframes(file.getnframes()), np.int16) / 32768
    with open(out, encoding='utf-8') as file:
        phones = json.load(file)['phones']
    return signal.resample(sound, int(len(sound) * RATE / hz)), phones


def frames_of(program, sound):
    raw = np.round(sound * 32767).astype('<i2').tobytes()
    done = subprocess.run([program, str(RATE)], input=raw, capture_output=True, check=True)
    return np.frombuffer(done.stdout, '<f4').reshape(-1, 33)


def curves_of(build, classes):
    """What a mouth does meanwhile, mm: pieces x frames x parameters."""
    pack = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../speech/it.json')
    done = subprocess.run([f'{build}/server/live/hear-curves', pack, str(classes.shape[1])], input=classes.tobytes(), capture_output=True, check=True)
    return np.frombuffer(done.stdout, '<f4').reshape(*classes.shape, -1).astype(np.float16)


class Collected:
    """Pieces of PIECE seconds as microphones hear them: features and classes, several times each."""

    def __init__(self, rng, program, times, keep, later):
        self.rng, self.program, self.times, self.keep, self.later = rng, program, times, keep, later
        self.features, self.classes = [], []

    def add(self, sound, phones, other):
        """Sound at RATE and its phones, from 0 s; somebody else's sound, for the noise."""
        for start in np.arange(0, len(sound) / RATE - PIECE, PIECE):
            if self.rng.random() > self.keep:
                continue
            piece = sound[int(start * RATE) : int((start + PIECE) * RATE)]
            for _ in range(self.times):
                # of a smaller or larger head: all that sounds higher is faster, too
                factor = float(np.clip(self.rng.normal(1, 0.1), 0.8, 1.25))
                heard = augmented(self.rng, signal.resample(piece, int(len(piece) / factor)), other)
                found = frames_of(self.program, heard)[:LENGTH]
                self.features.append(found.astype(np.float16))
                self.classes.append(labels(phones, len(found), lambda k: start - self.later + (k * 0.01 + 0.0125) * factor))  # noqa: B023


def synthetic(options, rng, collected):
    lists = {name: words_of(name) for name in LISTS}
    whole = sum(v[3] for v in VOICES)
    unknown = {}
    with tempfile.TemporaryDirectory() as folder:
        for voice, lang, name, share in VOICES:
            had = 0
            while had < options.minutes * 60 * share / whole:
                sound, phones = spoken(options.build, voice, lang, text_of(rng, lists[name], OFTEN[name].split()), rng, folder)
                had += len(sound) / RATE
                for p in phones:
                    if 255 in classes_of(p['ipa']):
                        unknown[p['ipa']] = unknown.get(p['ipa'], 0) + 1
                collected.add(sound, phones, sound)
            print(voice, round(had), 's', flush=True)
    print('phones without a class:', unknown)


def nobody(rng, collected, count):
    """Music, and noises alone: nothing is said."""
    length = int((PIECE + 0.1) * RATE)
    for k in range(count):
        sound = nobodys(rng, length) if k % 6 else coloured(rng, length, rng.integers(-1, 3)) * (0.2 + np.abs(signal.resample(rng.standard_normal(rng.integers(4, 60)), length)))
        collected.add(sound / np.max(np.abs(sound)), [{'ipa': '', 'start': 0, 'end': PIECE}], np.zeros(0))


def after_music(rng, sound, phones):
    """Nobody for a while, then speech over what goes on more softly."""
    began, length = int(rng.uniform(1, 3) * RATE), int(PIECE * RATE)
    out = []
    for start in np.arange(0, len(sound) / RATE - PIECE, PIECE):
        other = nobodys(rng, length)
        voice = np.concatenate([np.zeros(began), sound[int(start * RATE) :][: length - began]])
        loud = np.sqrt(np.mean(voice[began:] ** 2) / (np.mean(other**2) + 1e-9))
        other[:began] *= loud * 10 ** (rng.uniform(-10, 6) / 20)
        other[began:] *= loud * 10 ** (-rng.uniform(4, 40) / 20)
        moved = [{**p, 'start': max(began / RATE, p['start'] - start + began / RATE), 'end': p['end'] - start + began / RATE} for p in phones if p['end'] > start]
        out.append((np.pad(voice + other, (0, 1600)), [{'ipa': '', 'start': 0, 'end': began / RATE}, *moved]))
    return out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('build')
    parser.add_argument('out')
    parser.add_argument('--minutes', type=float, default=150, help='of synthetic speech')
    parser.add_argument('--people', nargs='*', default=[])
    parser.add_argument('--times', type=int, default=2, help='by how many microphones each piece is heard')
    parser.add_argument('--keep', type=float, default=1, help='how much of the pieces')
    parser.add_argument('--later', type=float, default=0, help='seconds by which the phones are later than is said')
    parser.add_argument('--after', action='store_true', help='music first, then people over it')
    parser.add_argument('--nobody', type=int, default=0, help='pieces of music and noise')
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    collected = Collected(rng, f'{options.build}/server/live/hear-features', options.times, options.keep, options.later)
    if options.minutes:
        synthetic(options, rng, collected)
    nobody(rng, collected, options.nobody)
    for path in options.people:
        for speaker, sound, phones, other in pieces(rng, path, PIECE):
            if speaker not in HELD:
                for one, own in after_music(rng, sound, phones) if options.after else [(sound, phones)]:
                    collected.add(one, own, other)
    classes = np.stack(collected.classes)
    print('pieces', len(classes), 'frames of each class', np.bincount(classes.reshape(-1), minlength=15)[:14])
    np.savez(options.out, features=np.stack(collected.features), classes=classes, curves=curves_of(options.build, classes))


if __name__ == '__main__':
    main()
