# SPDX-License-Identifier: GPL-3.0-or-later
"""Trains what tells beside a network's memory whether anybody speaks at all, and writes both into one file; the network stays as it is.

python3 voice.py NETWORK.bin OUT.bin VECTORS.bin --speech DATA.npz... --nobody DATA.npz... [--after DATA.npz...]
DATA: of make_data.py; of `nobody` nothing is speech, of `after` nothing before the first sound is. Silence between sounds counts nothing. Wants python3-torch.
Fixed seeds.
"""
import argparse

import numpy as np
import torch
from torch import nn
from train import load, vectors, write

SKIPPED = 10  # frames, until something has been heard
SPEECH = 4  # what is said and taken for music costs so much more than the reverse
HELD = 8  # of so many pieces one is kept back


def asked(classes, kind):
    """Of each frame: 1 somebody speaks, 0 nobody does, -1 it does not count."""
    wanted = torch.where(classes > 0, 1, -1)
    wanted[classes == 255] = -1
    if kind == 'nobody':
        wanted[:] = 0
    if kind == 'after':
        wanted[(classes > 0).cumsum(1) == 0] = 0
    return wanted


def collected(model, files, most, rng):
    """Pooled memory and what is asked, of pieces to learn from and of those kept back."""
    out = {True: ([], []), False: ([], [])}
    for kind, path in files:
        data = np.load(path)
        chosen = rng.permutation(len(data['features']))[:most]
        for n in range(0, len(chosen), 16):
            pieces = np.sort(chosen[n : n + 16])
            with torch.no_grad():
                pooled = model.pooled(model.memory(torch.from_numpy(data['features'][pieces]).float()))
            wanted = asked(torch.from_numpy(data['classes'][pieces].astype(np.int64)), kind)
            wanted[:, :SKIPPED] = -1
            x, y = out[n // 16 % HELD == HELD - 1]
            every = torch.arange(wanted.shape[1])[None].expand_as(wanted) % 3 == 0
            x.append(pooled[every & (wanted >= 0)])
            y.append(wanted[every & (wanted >= 0)].float())
    return [tuple(map(torch.cat, out[held])) for held in (False, True)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('network')
    parser.add_argument('out')
    parser.add_argument('vectors')
    parser.add_argument('--speech', nargs='+', required=True)
    parser.add_argument('--nobody', nargs='+', required=True)
    parser.add_argument('--after', nargs='*', default=[])
    parser.add_argument('--most', type=int, default=360, help='pieces of each file')
    options = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(1)
    rng = np.random.default_rng(1)
    model = load(options.network)
    files = [(kind, path) for kind in ('speech', 'nobody', 'after') for path in getattr(options, kind)]
    (x, y), (held_x, held_y) = collected(model, files, options.most, rng)
    mean, spread = x.mean(0), x.std(0) + 1e-3
    head = nn.Linear(x.shape[1], 1)
    # whatever there is more of
    weight = torch.where(y > 0, SPEECH * 0.5 / (y > 0).float().mean(), 0.5 / (y == 0).float().mean())
    optimiser = torch.optim.Adam(head.parameters(), lr=3e-3, weight_decay=1e-4)
    for step in range(3000):
        some = torch.randint(len(x), (2048,))
        loss = nn.functional.binary_cross_entropy_with_logits(head((x[some] - mean) / spread)[:, 0], y[some], weight[some])
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        for group in optimiser.param_groups:
            group['lr'] = 3e-3 * (0.5 + 0.5 * np.cos(np.pi * step / 3000)) + 1e-5
    with torch.no_grad():
        model.voice.weight.copy_(head.weight / spread)
        model.voice.bias.copy_(head.bias - (head.weight * mean / spread).sum(1))
    write(model, options.out)
    model = load(options.out)
    with torch.no_grad():
        told = model.voice(held_x)[:, 0]
    print(f'{len(x)} frames; of {len(held_x)} kept back: speech taken for none {100 * (told[held_y > 0] < 0).float().mean():.1f} %, none for speech {100 * (told[held_y == 0] > 0).float().mean():.1f} %')
    vectors(model, torch.from_numpy(np.load(options.speech[0])['features'][:1, :80]).float(), options.vectors)


if __name__ == '__main__':
    main()
