# SPDX-License-Identifier: GPL-3.0-or-later
"""Some thirty people who say words and syllables in Debian's packages, in the form of people.py: a network that hears already lays their sounds onto the text.

python3 laid.py BUILD PLACE NETWORK.bin OUT.npz
PLACE: where klettres-data, ktuberling-data and tuxpaint-stamps-default were unpacked (`dpkg -x`). Wants python3-torch and sox. What does not fit its text is left out.
Nobody here is among those that tests/bench/hear.mjs hears.
"""
import argparse
import glob
import json
import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import torch
from make_data import frames_of
from people import HELD, read, stamps
from sounds import CLASSES, RATE, classes_of
from train import CLASSES as COUNT
from train import DELAYS, load

# Folders whose names espeak-ng does not know as a language.
ESPEAK = {'fr': 'fr-fr', 'en': 'en-us', 'en_GB': 'en-gb', 'pt_BR': 'pt-br', 'nds': None, 'wa': None, 'ml': None, 'he': None, 'gl': 'pt', 'nn': 'nb', 'sr@latin': None, 'sr@ijekavianlatin': None, 'sr@ijekavian': None}
SHOWN = {number: letters[:1] for number, (_, letters) in enumerate(CLASSES)}
FIT = 0.42  # of the likelihoods of its sounds, in the mean


def klettres(place):
    for path in sorted(glob.glob(f'{place}/usr/share/klettres/*/sounds.xml')):
        lang = os.path.basename(os.path.dirname(path))
        with open(path, encoding='utf-8') as file:
            for name, sound in re.findall(r'<sound name="([^"]+)" file="([^"]+)"', re.sub(r'<!--.*?-->', '', file.read(), flags=re.S)):
                yield {'speaker': f'klettres-{lang}', 'lang': lang, 'text': name.lower(), 'sound': f'{place}/usr/share/klettres/{sound}'}


def ktuberling(place):
    """What is said is the file's name."""
    for sound in sorted(glob.glob(f'{place}/usr/share/ktuberling/sounds/*/*.wav')):
        lang = os.path.basename(os.path.dirname(sound))
        text = re.sub(r'[_\-\d]+', ' ', os.path.basename(sound)[:-4]).strip()
        if text:
            yield {'speaker': f'ktuberling-{lang}', 'lang': lang, 'text': text, 'sound': sound}


def wanted_of(text, lang):
    """The classes of its sounds, in order; None in between where there may be a pause."""
    voice = ESPEAK.get(lang, lang)
    if not voice:
        return []
    done = subprocess.run(['espeak-ng', '-q', '--ipa=1', '-v', voice, text], capture_output=True, text=True, check=False)
    out = []
    for word in re.sub(r'\([^)]*\)', '', done.stdout).split():
        for phone in re.sub('[ˈˌ͡‍]', '', word).split('_'):
            out += [c for c in classes_of(phone) if phone and c < COUNT]
        out.append(None)
    return out[:-1]


def laid(likely, wanted):
    """[(class, first frame, last + 1)] and how well it fits; silence may be before, after and where there may be a pause."""
    states = [0]
    for c in [*wanted, None]:
        states.append(0 if c is None else c)
    least = [1 if s == 0 else 3 for s in states]
    # every state is as many frames long as it has to be at least, the last of them as often as one likes
    chain = [(i, j) for i, n in enumerate(least) for j in range(n)]
    first = {i: n for n, (i, j) in enumerate(chain) if j == 0}
    stays = np.array([0.0 if j == least[i] - 1 else -np.inf for i, j in chain])
    skips = {n: first[i - 1] - 1 for n, (i, j) in enumerate(chain) if j == 0 and i >= 2 and states[i - 1] == 0}
    to, past = np.array([*skips], int), np.array([*skips.values()], int)
    emit = np.log(np.maximum(likely, 0.01))[:, [states[i] for i, _ in chain]]
    total, count = len(likely), len(chain)
    score, back = np.full(count, -np.inf), np.zeros((total, count), int)
    score[0], score[first[1]] = emit[0, 0], emit[0, first[1]]
    for k in range(1, total):
        ways = np.full((3, count), -np.inf)
        ways[0], ways[1, 1:], ways[2, to] = score + stays, score[:-1], score[past]
        way = ways.argmax(0)
        came = np.arange(count) - (way == 1)
        came[to] = np.where(way[to] == 2, past, came[to])
        back[k], score = came, ways.max(0) + emit[k]
    n = count - 1 if score[-1] >= score[first[len(states) - 1] - 1] else first[len(states) - 1] - 1
    if not np.isfinite(score[n]):
        return [], 0.0
    path = np.zeros(total, int)
    for k in range(total - 1, -1, -1):
        path[k], n = chain[n][0], back[k, n]
    spans, sure = [], []
    for k, i in enumerate(path):
        if spans and spans[-1][0] == i:
            spans[-1][2] = k + 1
        else:
            spans.append([i, k, k + 1])
        if states[i]:
            sure.append(likely[k, states[i]])
    return [(states[i], a, b) for i, a, b in spans], float(np.mean(sure)) if sure else 0.0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('build')
    parser.add_argument('place')
    parser.add_argument('network')
    parser.add_argument('out')
    options = parser.parse_args()
    torch.set_num_threads(1)
    model, program, delay = load(options.network), f'{options.build}/server/live/hear-features', DELAYS[-1]
    items = [i for source in (klettres(options.place), ktuberling(options.place), stamps(options.place)) for i in source if i['speaker'] not in HELD]

    def heard(item):
        sound, wanted = read(item['sound']) if os.path.exists(item['sound']) else np.zeros(0, np.int16), wanted_of(item['text'], item['lang'])
        loudest = np.max(np.abs(sound / 32768), initial=0)
        if len(wanted) < 2 or not RATE / 4 < len(sound) < 20 * RATE or loudest < 0.01:
            return None
        return sound, wanted, frames_of(program, np.concatenate([np.zeros(RATE // 4), sound / 32768 / loudest * 0.7, np.zeros(RATE // 4)]))

    sounds, kept, told = [], [], {}
    with ThreadPoolExecutor(2) as pool:
        for item, found in zip(items, pool.map(heard, items)):
            count = told.setdefault(item['speaker'], [0, 0, 0.0])
            count[1] += 1
            if not found:
                continue
            sound, wanted, features = found
            with torch.no_grad():
                likely = torch.softmax(model(torch.from_numpy(features.copy())[None])[-1][0, delay:, :COUNT], -1).numpy()
            spans, fit = laid(likely, wanted)
            if fit < FIT:
                continue
            at = lambda k: max(0.0, k * 0.01 + 0.0075 - 0.25)  # noqa: E731
            phones = [{'ipa': SHOWN[c], 'start': at(a), 'end': at(b)} for c, a, b in spans if at(b) > 0]
            count[0] += 1
            count[2] += len(sound) / RATE
            sounds.append(sound)
            kept.append({'speaker': item['speaker'], 'name': item['text'], 'fit': round(fit, 2), 'samples': len(sound), 'phones': phones})
    for speaker, (some, all_, seconds) in sorted(told.items()):
        print(f'{speaker}: {some} of {all_}, {seconds:.0f} s')
    np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(kept))


if __name__ == '__main__':
    main()
