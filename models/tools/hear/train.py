# SPDX-License-Identifier: GPL-3.0-or-later
"""Trains the network of server/live/lip_network.h and writes it with what it answers to a piece of its data.

python3 train.py OUT.bin VECTORS.bin DATA.npz=SHARE... [--steps N | --minutes N] [--begin NETWORK.bin] [--stays SHARE] [--size UNITS] [--middle OUTPUTS]
SHARE: how much of each step is of that file, which is read again whenever it has been written anew; until it is there the others count the more. Wants python3-torch. Fixed seeds: N steps from the same files give the same network; how far it
gets in N minutes depends on the machine, so the card tells how many steps it had.
"""
import argparse
import copy
import os
import time

import numpy as np
import torch
from data import INPUTS, Data, bent, masked
from torch import nn

TAPS, MIDDLE, SIZE, CLASSES = 5, 64, 96, 14
# Of each articulatory parameter (LI LS AR PI PS EM TH TA TB, mm) how far it usually is from its mean; an error counts by that.
SPREAD = [2.5, 1.0, 4.7, 0.9, 1.2, 2.5, 3.1, 2.0, 3.2]
CURVES = len(SPREAD)
DELAYS = [0, 4, 8, 12]  # frames of 10 ms, one head each
SHARES = [0.6, 0.8, 2.0, 0.6]  # how much each counts
CURVES_COUNT = 0.4  # beside the classes
DROPPED = 0.1
# Where a phone begins is not known to the frame: so a frame is partly of its neighbours' classes.
BLUR = [1 / 9, 2 / 9, 3 / 9, 2 / 9, 1 / 9]
CLOSED, TEETH = 1, 2
LEAD = 20  # frames that the network hears before it is asked


class Hearing(nn.Module):
    def __init__(self, taps=TAPS, middle=MIDDLE, size=SIZE):
        super().__init__()
        self.conv = nn.Conv1d(INPUTS, middle, taps)
        self.dropped = nn.Dropout(DROPPED)
        self.gru = nn.GRU(middle, size, num_layers=2, batch_first=True, dropout=DROPPED)
        # of each: first the classes, then the parameters in mm
        self.heads = nn.ModuleList(nn.Linear(size, CLASSES + CURVES) for _ in DELAYS)
        # whether anybody speaks: of the memory, its running mean, and how far it lies from that of late; see voice.py
        self.voice = nn.Linear(3 * size, 1)
        nn.init.zeros_(self.voice.weight)
        nn.init.ones_(self.voice.bias)

    VOICE_PACE = 0.04  # of the way to what is new, a frame; at first more

    def memory(self, x):
        x = nn.functional.pad(x.transpose(1, 2), (self.conv.kernel_size[0] - 1, 0))
        return self.gru(self.dropped(torch.relu(self.conv(x))).transpose(1, 2))[0]

    def forward(self, x):
        x = self.memory(x)
        return [head(x) for head in self.heads]

    def pooled(self, memory):
        """What the voice's head sees: pieces x frames x three times the units."""
        mean = off = torch.zeros_like(memory[:, 0])
        out = []
        for k, now in enumerate(memory.unbind(1)):
            pace = max(self.VOICE_PACE, 1 / (k + 1))
            mean = mean + pace * (now - mean)
            off = off + pace * ((now - mean).abs() - off)
            out.append(torch.cat([now, mean, off], -1))
        return torch.stack(out, 1)


def loss_of(heads, classes, curves, weight):
    """Cross entropy beside blurred classes; an unknown one (255) counts nothing. And how far the curves are off, in units of their spread."""
    wanted = nn.functional.one_hot(classes.clamp(max=CLASSES), CLASSES + 1)[..., :CLASSES].float().transpose(1, 2)
    wanted = nn.functional.conv1d(wanted.reshape(-1, 1, wanted.shape[2]), torch.tensor(BLUR)[None, None], padding=len(BLUR) // 2).reshape(wanted.shape)
    wanted = wanted.transpose(1, 2) * weight
    total = 0
    for head, delay, share in zip(heads, DELAYS, SHARES):
        then = slice(LEAD - delay, classes.shape[1] - delay)
        there, of_classes, of_curves = wanted[:, then], head[:, LEAD:, :CLASSES], head[:, LEAD:, CLASSES:]
        off = (of_curves - curves[:, then]) / torch.tensor(SPREAD)
        total = total + share / sum(SHARES) * (CURVES_COUNT * (off**2).mean() - (there * torch.log_softmax(of_classes, -1)).sum() / there.sum())
    return total


def tell(model, features, classes, curves):
    """What it does on pieces that it was not trained on."""
    with torch.no_grad():
        heads = model.eval()(features)
    for head, delay in zip(heads, DELAYS):
        said = head[:, LEAD:, :CLASSES].argmax(-1).numpy()
        wanted = classes[:, LEAD - delay : classes.shape[1] - delay].numpy()
        line = f'  {10 * delay:3d} ms: {100 * np.mean(said == wanted):.1f} % of frames right'
        for name, k in (('closed', CLOSED), ('teeth', TEETH), ('rounded', 3)):
            line += f'; {name} {100 * np.mean(said[wanted == k] == k):.0f} % found, {100 * np.mean(wanted[said == k] == k):.0f} % of those right'
        off = head[:, LEAD:, CLASSES:] - curves[:, LEAD - delay : classes.shape[1] - delay]
        print(line, '; curves off by', ' '.join(f'{x:.2f}' for x in (off**2).mean((0, 1)).sqrt()), 'mm', flush=True)


def parts(model):
    yield model.conv.weight.permute(0, 2, 1)  # of each output: tap by tap, oldest first
    yield model.conv.bias
    for layer in range(2):
        for name in ('weight_ih', 'weight_hh', 'bias_ih', 'bias_hh'):
            yield getattr(model.gru, f'{name}_l{layer}')
    for head in model.heads:
        for rows in (slice(CLASSES), slice(CLASSES, None)):
            yield head.weight[rows]
            yield head.bias[rows]
    yield model.voice.weight.view(3, -1)  # a row for each third
    yield model.voice.bias


def rounded(model):
    """The weights as the file has them, row by row in whole numbers from -127 to 127; biases in half precision."""
    with torch.no_grad():
        for p in parts(model):
            if p.dim() == 1:
                p.copy_(p.half().float())
            else:
                rows = p.reshape(len(p), -1)
                one = rows.abs().amax(1, keepdim=True).clamp(min=1e-9) / 127
                p.copy_(((rows / one).round() * one).reshape(p.shape))
    return model


def write(model, path):
    with open(path, 'wb') as file:
        file.write(b'FACHEAR3')
        middle, _, taps = model.conv.weight.shape
        file.write(np.array([INPUTS, taps, middle, model.gru.hidden_size, CLASSES, CURVES, len(DELAYS), *DELAYS], '<u4').tobytes())
        for part in parts(model):
            values = part.detach().numpy()
            if values.ndim == 1:
                file.write(values.astype('<f2').tobytes())
                continue
            for row in values.reshape(len(values), -1):
                one = np.float32(max(np.abs(row).max(), 1e-9) / 127)
                file.write(one.astype('<f4').tobytes() + np.round(row / one).astype('<i1').tobytes())


def load(path):
    with open(path, 'rb') as file:
        data = file.read()
    _, taps, middle, size, _, _, _ = np.frombuffer(data, '<u4', 7, 8)
    model, at = Hearing(int(taps), int(middle), int(size)).eval(), 36 + 4 * len(DELAYS)
    with torch.no_grad():
        for part in parts(model):
            if part.dim() == 1:
                values = np.frombuffer(data, '<f2', len(part), at).astype(np.float32)
                at += 2 * len(part)
            else:
                row = np.dtype([('one', '<f4'), ('whole', '<i1', part[0].numel())])
                rows = np.frombuffer(data, row, len(part), at)
                values = rows['one'][:, None] * rows['whole'].astype(np.float32)
                at += row.itemsize * len(part)
            part.copy_(torch.from_numpy(values).reshape(part.shape))
    return model


def vectors(model, piece, path):
    """What it answers to a piece, for the tests of what runs it."""
    with torch.no_grad():
        memory = model.eval().memory(piece)
        told = (head(memory) for head in model.heads)
        answers = torch.stack([torch.cat([torch.softmax(one[..., :CLASSES], -1), one[..., CLASSES:]], -1) for one in told], 2)[0]
        voice = model.voice(model.pooled(memory))[0, :, 0]
    with open(path, 'wb') as file:
        file.write(np.array([piece.shape[1], INPUTS, len(DELAYS), CLASSES, CURVES], '<u4').tobytes())
        for values in (piece[0], answers, voice):
            file.write(values.numpy().astype('<f4').tobytes())


def widened(old, size):
    """A network of more units that answers as the old one: what is new is heard by nobody yet."""
    (middle, _, taps), had = old.conv.weight.shape, old.gru.hidden_size
    new = Hearing(taps, middle, size)
    new.conv.load_state_dict(old.conv.state_dict())
    with torch.no_grad():
        for layer in range(2):
            for name in ('weight_ih', 'weight_hh', 'bias_ih', 'bias_hh'):
                a, b = getattr(old.gru, f'{name}_l{layer}'), getattr(new.gru, f'{name}_l{layer}')
                for gate in range(3):
                    rows = slice(gate * size, gate * size + had)
                    if b.dim() == 1:
                        b[rows] = a[gate * had : (gate + 1) * had]
                    else:
                        b[rows] = 0
                        b[rows, : a.shape[1]] = a[gate * had : (gate + 1) * had]
        new.voice.bias.copy_(old.voice.bias)
        for k in range(3):
            new.voice.weight[:, k * size : k * size + had] = old.voice.weight[:, k * had : (k + 1) * had]
        for a, b in zip(old.heads, new.heads):
            b.weight.zero_()
            b.weight[:, :had] = a.weight
            b.bias.copy_(a.bias)
    return new


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('out')
    parser.add_argument('vectors')
    parser.add_argument('data', nargs='+')
    parser.add_argument('--steps', type=int, default=0, help='in place of minutes')
    parser.add_argument('--minutes', type=float, default=15, help="of the processor's time")
    parser.add_argument('--clock', action='store_true', help='minutes of the clock instead, whatever else the machine does')
    parser.add_argument('--begin', help='a network to go on from')
    parser.add_argument('--stays', type=float, default=0, help='how much of the network that it begins with is in the weights that are written')
    parser.add_argument('--size', type=int, default=0, help='units of a recurrent layer; 96, or as the network has that it begins with')
    parser.add_argument('--middle', type=int, default=MIDDLE, help='outputs of the convolution of a new network')
    parser.add_argument('--rate', type=float, default=3e-3)
    parser.add_argument('--batch', type=int, default=64)
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(options.seed)
    rng = np.random.default_rng(options.seed)
    files = [Data(name.rsplit('=')[0], float(name.rsplit('=')[1]), rng) for name in options.data]

    def there():
        return [f for f in files if f.written]

    counts = sum(f.share * np.bincount(f.classes.numpy().reshape(-1), minlength=256)[:CLASSES] / f.classes.numel() for f in there())
    weight = torch.tensor((counts.mean() / np.maximum(counts, 1e-6)) ** 0.3, dtype=torch.float32).clamp(0.5, 2)
    weight[CLOSED] *= 1.3  # a missed closure is worse than one too many
    weight[TEETH] *= 1.5  # most of them were taken for closures
    model = load(options.begin) if options.begin else Hearing(middle=options.middle, size=options.size or SIZE)
    if options.size and options.size != model.gru.hidden_size:
        model = widened(model, options.size)
    begun = copy.deepcopy(model)
    print('weights:', sum(p.numel() for p in model.parameters()), 'share of each class:', np.round(counts, 3), flush=True)

    model.train()
    mean = copy.deepcopy(model).eval()  # of the last some hundred steps: this is what is written

    def judge():
        for file in there():
            print(os.path.basename(file.path))
            tell(mean, file.features[file.held].float(), file.classes[file.held].long(), file.curves[file.held].float())

    optimiser = torch.optim.Adam(model.parameters(), lr=2e-3)
    now = time.monotonic if options.clock else time.process_time
    began, step, recent = now(), 0, []
    while (done := step / options.steps if options.steps else (now() - began) / 60 / options.minutes) < 1:
        for group in optimiser.param_groups:  # up quickly, then down along a cosine
            group['lr'] = options.rate * min(1, (step + 1) / 60) * (0.5 + 0.5 * np.cos(np.pi * done)) + 1e-5
        whole = sum(f.share for f in there())
        batches = [f.some(rng, round(options.batch * f.share / whole)) for f in there()]
        features, classes, curves = (torch.cat([b[i] for b in batches]) for i in range(3))
        loss = loss_of(model(masked(rng, bent(rng, features))), classes, curves, weight)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(model.parameters(), 2.0)
        optimiser.step()
        with torch.no_grad():
            for a, b in zip(mean.parameters(), model.parameters()):
                a.lerp_(b, max(0.003, 1 / (step + 1)))
        recent.append(loss.item())
        step += 1
        if step % 50 == 0:
            print(f'{step} steps, {(now() - began) / 60:.1f} min, loss {np.mean(recent[-50:]):.3f}', flush=True)
            for file in files:
                file.look(rng)
            if step % 100 == 0:
                write(mean, options.out)
    print(f'{step} steps')
    with torch.no_grad():  # what was known is forgotten less (M. Wortsman et al., CVPR 2022)
        for a, b in zip(mean.parameters(), begun.parameters()):
            a.lerp_(b, options.stays)
    rounded(mean)  # what the file holds is what answers
    judge()
    mean.eval()
    write(mean, options.out)
    vectors(mean, files[0].features[files[0].held[:1]].float()[:, :80], options.vectors)


if __name__ == '__main__':
    main()
