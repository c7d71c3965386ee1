# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a network hears people who are kept for choices, as tests/bench/hear.mjs counts, and by which numbers of the decoder.

python3 judge.py FEATURES NETWORK,... PEOPLE.npz... [--search] [--equal]
Wants python3-torch. Nobody here is in the training, nor in the recordings of the bench.
"""
import argparse
import json
import re

import numpy as np
import torch
from make_data import frames_of
from people import HELD
from sounds import RATE, coloured
from train import CLASSES, DELAYS, load

KINDS = {'closed': (r'[pbm]', {1}), 'teeth': (r'[fv]', {2}), 'rounded': (r't͡ʃ|d͡ʒ|tʃ|dʒ|[ʃʒuwoɔʊ]', {3, 11, 13})}
SLACK, FIRST = 0.04, 0.0075
# As server/live/lip_recogniser.c has them; closures count wherever the lips are.
DECODER = {'closed': 1.4, 'apart': 99.0, 'teeth': 2.0, 'hold': 0.3, 'sure': 0.75, 'least': 2, 'contact': 4}
SCALES = [0.2, 0.3, 0.4, 0.5, 0.62, 0.75, 0.87, 1, 1.15, 1.35, 1.6, 2, 2.6, 3.5, 5]


def decoded(likely, gap, d):
    """lip_recogniser.c: [(class, start, end)] in frames. gap: between the lips as the network's own mouth has them, mm."""
    weight = np.ones(CLASSES)
    weight[1], weight[2] = d['closed'], d['teeth']
    likely = likely.copy()
    likely[gap > d['apart'], 1] = 0
    best = np.argmax(likely * weight, 1)
    out, now, start, end, since, following = [], 0, 0, 0, 0, 0
    for k, heard in enumerate(best):
        age, end = k - start, k + 1
        held = now in (1, 2) and (age < d['contact'] or likely[k, now] > d['hold'])
        if heard == now or (held and heard not in (1, 2)):
            since = end
            continue
        if since >= k or following != heard:
            since, following = k, heard
        if k - since + 1 < d['least'] and heard not in (1, 2) and likely[k, heard] < d['sure']:
            continue
        if since > start:
            out.append((now, start, since))
        now, start, since = heard, since, end
    return [*out, (now, start, end)]


def joined(spans):
    out = []
    for start, end in spans:
        if out and start - out[-1][1] < 0.011:
            out[-1] = (out[-1][0], end)
        else:
            out.append((start, end))
    return out


def compared(kind, phones, heard, shift=0.0):
    """said, found, shown, wrong."""
    pattern, classes = KINDS[kind]
    speech = [p for p in phones if p['ipa']]
    low, high = speech[0]['start'], speech[-1]['end']
    said = joined([(p['start'] + shift, p['end'] + shift) for p in speech if re.match(pattern, p['ipa'])])
    said = [s for s in said if s[0] >= low and s[1] <= high + 0.01]
    seen = joined([(FIRST + a / 100, FIRST + b / 100) for c, a, b in heard if c in classes])
    shown = wrong = 0
    for a, b in seen:
        times = np.arange(max(low, a), min(high, b), 0.01)
        times = times[[not any(p['start'] <= t < p['end'] for p in phones if not p['ipa']) for t in times]] if len(times) else times
        near = np.zeros(len(times), bool)
        for s in said:
            near |= (s[0] - SLACK < times) & (times < s[1] + SLACK)
        shown += len(times)
        wrong += int(np.sum(~near))
    found = sum(any(a < s[1] + SLACK and s[0] < b + SLACK for a, b in seen) for s in said)
    return np.array([len(said), found, shown, wrong])


def people(paths, program, db, most):
    """[(speaker, phones, features)]"""
    rng, out, counts = np.random.default_rng(5), [], {}
    for path in paths:
        data = np.load(path)
        items, at = json.loads(str(data['items'])), 0
        sounds = data['sounds']
        for item in items:
            at += item['samples']
            counts[item['speaker']] = counts.get(item['speaker'], 0) + 1
            if item['speaker'] in HELD and counts[item['speaker']] <= most and any(p['ipa'] for p in item['phones']):
                sound = sounds[at - item['samples'] : at] / 32768
                if db is not None:
                    sound = sound + coloured(rng, len(sound), 0) * np.sqrt(np.mean(sound**2)) * 10 ** (-db / 20)
                sound = np.concatenate([np.clip(sound, -1, 1), np.zeros(int(0.2 * RATE))])
                out.append((item['speaker'], item['phones'], frames_of(program, sound)))
    return out


def likelihoods(model, told, delay):
    out = []
    with torch.no_grad():
        for speaker, phones, features in told:
            heads = model(torch.from_numpy(features.copy())[None])
            head = heads[DELAYS.index(delay)][0, delay:]
            out.append((speaker, phones, torch.softmax(head[:, :CLASSES], -1).numpy(), head[:, CLASSES : CLASSES + 2].sum(-1).numpy()))
    return out


def table(heard, decoder, shifts=(-0.2, 0.2)):
    sums = {}
    for speaker, phones, likely, gap in heard:
        spans = decoded(likely, gap, decoder)
        for kind in KINDS:
            for name in (speaker, 'all'):
                a = sums.setdefault((name, kind), np.zeros(6))
                a[:4] += compared(kind, phones, spans)
                for shift in shifts:
                    a[4:] += compared(kind, phones, spans, shift)[:2]
    return sums


def cell(a):
    return f'{100 * a[1] / max(1, a[0]):3.0f} %, {100 * a[3] / max(1, a[2]):3.0f} % ({100 * a[5] / max(1, a[4]):.0f})'


def curves(heard):
    """(speaker, kind): what is false and what is found, %, as closures and teeth count less or more, both together."""
    told = [table(heard, {**DECODER, **{kind: DECODER[kind] * scale for kind in ('closed', 'teeth')}}, ()) for scale in SCALES]
    return {key: [(100 * a[3] / max(1, a[2]), 100 * a[1] / max(1, a[0])) for a in (sums[key] for sums in told)] for key in told[0]}


def found_at(curve, false):
    """What is found where so much is false."""
    there, found = zip(*sorted(curve))
    return np.interp(false, there, np.maximum.accumulate(found))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('features')
    parser.add_argument('networks')
    parser.add_argument('people', nargs='+')
    parser.add_argument('--search', action='store_true')
    parser.add_argument('--equal', action='store_true', help='besides, what is found where as much is false as with the first network')
    parser.add_argument('--noise', type=float, default=None, help='white, so many dB below')
    parser.add_argument('--most', type=int, default=60, help='recordings of each speaker')
    parser.add_argument('--delays', default='8')
    options = parser.parse_args()
    torch.set_num_threads(1)
    told = people(options.people, options.features, options.noise, options.most)
    first = {}
    for network in options.networks.split(','):
        model = load(network)
        for delay in map(int, options.delays.split(',')):
            heard = likelihoods(model, told, delay)
            sums = table(heard, DECODER)
            for name in sorted({n for n, _ in sums}):
                print(network, f'{10 * delay:3d} ms {name:12s}', ' | '.join(f'{kind} {cell(sums[name, kind])}' for kind in KINDS), flush=True)
            if options.equal:
                for key, curve in sorted(curves(heard).items()):
                    false = first.setdefault((delay, *key), curve[SCALES.index(1)][0])
                    if key[1] != 'rounded':
                        print(network, *key, f'{found_at(curve, false):.1f} % found where {false:.1f} % is false', flush=True)
            if options.search:
                for closed, teeth, apart in [(c, t, 99) for c in (1, 1.4, 2) for t in (1, 1.4, 2, 3)] + [(1.4, 2, a) for a in (3.5, 4, 4.5, 5)]:
                    sums = table(heard, {**DECODER, 'closed': closed, 'apart': apart, 'teeth': teeth})
                    print(closed, teeth, apart, ' | '.join(f'{name} {kind} {cell(a)}' for (name, kind), a in sums.items() if kind != 'rounded'), flush=True)


if __name__ == '__main__':
    main()
