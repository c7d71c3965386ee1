# SPDX-License-Identifier: GPL-3.0-or-later
"""Trains the network of server/hear/hear_network.h and writes it with what it answers to a piece of its data.

python3 train.py DATA.npz OUT.bin VECTORS.bin [--minutes N]
Wants python3-torch. One thread, fixed seeds; how far it gets in N minutes depends on the machine, so the card tells how many steps it had.
"""
import argparse
import time

import numpy as np
import torch
from torch import nn

INPUTS, TAPS, MIDDLE, SIZE, CLASSES = 33, 5, 64, 96, 14
DELAYS = [0, 4, 8, 12]  # frames of 10 ms, one head each
CLOSED, TEETH = 1, 2
CROP = 300  # frames of a piece at a time
LEAD = 20  # frames that the network hears before it is asked


class Hearing(nn.Module):
    def __init__(self):
        super().__init__()
        self.conv = nn.Conv1d(INPUTS, MIDDLE, TAPS)
        self.gru = nn.GRU(MIDDLE, SIZE, num_layers=2, batch_first=True)
        self.heads = nn.ModuleList(nn.Linear(SIZE, CLASSES) for _ in DELAYS)

    def forward(self, x):
        x = nn.functional.pad(x.transpose(1, 2), (TAPS - 1, 0))
        x, _ = self.gru(torch.relu(self.conv(x)).transpose(1, 2))
        return [head(x) for head in self.heads]


def loss_of(heads, classes, weight):
    total = 0
    for head, delay in zip(heads, DELAYS):
        said = head[:, LEAD:].reshape(-1, CLASSES)
        wanted = classes[:, LEAD - delay : classes.shape[1] - delay].reshape(-1)
        total = total + nn.functional.cross_entropy(said, wanted, weight=weight, ignore_index=255)
    return total / len(DELAYS)


def tell(model, features, classes):
    """What it does on pieces that it was not trained on."""
    with torch.no_grad():
        heads = model(features)
    for head, delay in zip(heads, DELAYS):
        said = head[:, LEAD:].argmax(-1).numpy()
        wanted = classes[:, LEAD - delay : classes.shape[1] - delay].numpy()
        line = f'  {10 * delay:3d} ms: {100 * np.mean(said == wanted):.1f} % of frames right'
        for name, k in (('closed', CLOSED), ('teeth', TEETH), ('rounded', 3)):
            line += f'; {name} {100 * np.mean(said[wanted == k] == k):.0f} % found, {100 * np.mean(wanted[said == k] == k):.0f} % of those right'
        print(line, flush=True)


def parts(model):
    yield model.conv.weight.permute(0, 2, 1)  # of each output: tap by tap, oldest first
    yield model.conv.bias
    for layer in range(2):
        for name in ('weight_ih', 'weight_hh', 'bias_ih', 'bias_hh'):
            yield getattr(model.gru, f'{name}_l{layer}')
    for head in model.heads:
        yield head.weight
        yield head.bias


def write(model, path):
    with open(path, 'wb') as file:
        file.write(b'FACHEAR1')
        file.write(np.array([INPUTS, TAPS, MIDDLE, SIZE, CLASSES, len(DELAYS), *DELAYS], '<u4').tobytes())
        for part in parts(model):
            file.write(part.detach().numpy().astype('<f2').tobytes())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('data')
    parser.add_argument('out')
    parser.add_argument('vectors')
    parser.add_argument('--minutes', type=float, default=15)
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(options.seed)
    rng = np.random.default_rng(options.seed)
    data = np.load(options.data)
    features, classes = torch.from_numpy(data['features']), torch.from_numpy(data['classes'].astype(np.int64))
    # the two microphones of a piece stay together
    order = rng.permutation(len(features) // 2)
    pick = lambda pairs: np.concatenate([2 * pairs, 2 * pairs + 1])  # noqa: E731
    kept, held = pick(order[40:]), pick(order[:40])
    counts = np.bincount(classes.numpy().reshape(-1), minlength=CLASSES)[:CLASSES]
    weight = torch.tensor((counts.mean() / np.maximum(counts, 1)) ** 0.3, dtype=torch.float32).clamp(0.5, 2)
    weight[CLOSED] *= 1.3  # a missed closure is worse than one too many
    model = Hearing()
    print('weights:', sum(p.numel() for p in model.parameters()), 'pieces:', len(kept), 'of', features.shape[1], 'frames', flush=True)
    optimiser = torch.optim.Adam(model.parameters(), lr=2e-3)
    began, step, recent = time.time(), 0, []
    while (done := (time.time() - began) / 60 / options.minutes) < 1:
        for group in optimiser.param_groups:  # up quickly, then down along a cosine
            group['lr'] = 3e-3 * min(1, (step + 1) / 60) * (0.5 + 0.5 * np.cos(np.pi * done)) + 1e-5
        batch, at = kept[rng.integers(len(kept), size=24)], rng.integers(features.shape[1] - CROP)
        loss = loss_of(model(features[batch, at : at + CROP].float()), classes[batch, at : at + CROP], weight)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(model.parameters(), 2.0)
        optimiser.step()
        recent.append(loss.item())
        step += 1
        if step % 100 == 0:
            print(f'{step} steps, {done * options.minutes:.1f} min, loss {np.mean(recent[-100:]):.3f}', flush=True)
            if step % 500 == 0:
                tell(model, features[held].float(), classes[held])
                write(model, options.out)
    print(f'{step} steps')
    with torch.no_grad():
        for p in model.parameters():  # what the file holds is what answers
            p.copy_(p.half().float())
    tell(model, features[held].float(), classes[held])
    write(model, options.out)
    piece = features[held[:1]].float()[:, :80]
    with torch.no_grad():
        answers = torch.stack([torch.softmax(head, -1) for head in model(piece)], 2)[0]
    with open(options.vectors, 'wb') as file:
        file.write(np.array([piece.shape[1], INPUTS, len(DELAYS), CLASSES], '<u4').tobytes())
        file.write(piece[0].numpy().astype('<f4').tobytes())
        file.write(answers.numpy().astype('<f4').tobytes())


if __name__ == '__main__':
    main()
