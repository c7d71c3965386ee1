# SPDX-License-Identifier: GPL-3.0-or-later
"""What train.py learns from: files of make_data.py, a piece at a time, each time a little otherwise."""
import os

import numpy as np
import torch

INPUTS = 33
CROP = 300  # frames of a piece at a time


class Data:
    """Of one file: pieces to train on, and some that are kept back. The microphones of a piece stay together as neighbours."""

    def __init__(self, path, share, rng):
        self.path, self.share, self.written, self.held = path, share, None, None
        self.look(rng)

    def look(self, rng):
        """Reads it, when it is new."""
        written = os.stat(self.path).st_mtime if os.path.exists(self.path) else None
        if written == self.written:
            return
        data = np.load(self.path)
        self.features, self.classes, self.curves = (torch.from_numpy(data[name]) for name in ('features', 'classes', 'curves'))
        self.written = written
        if self.held is None:
            first = 40 * rng.integers(len(self.features) // 40)
            self.held = np.arange(first, first + 40)
        self.kept = np.setdiff1d(np.arange(len(self.features)), self.held)
        print(self.path, len(self.kept), 'pieces', flush=True)

    def some(self, rng, count):
        """Spoken up to an eighth faster or slower than it was."""
        pace = rng.uniform(0.88, 1.14, (count, 1))
        at = rng.uniform(0, self.features.shape[1] - 2 - CROP * pace)
        times = torch.from_numpy(at + np.arange(CROP) * pace)
        piece, before = torch.from_numpy(self.kept[rng.integers(len(self.kept), size=(count, 1))]), times.floor().long()
        part = (times - before).float()[..., None]
        features = self.features[piece, before].float() * (1 - part) + self.features[piece, before + 1].float() * part
        nearest = times.round().long()
        return features, self.classes[piece, nearest].long(), self.curves[piece, nearest].float()


def bent(rng, features):
    """Heads of other sizes: the bands up or down by up to 6 %. The last number, the loudness, stays."""
    count, bands = len(features), INPUTS - 1
    there = np.clip(np.arange(bands) * rng.uniform(0.94, 1.06, (count, 1)) + rng.uniform(-0.3, 0.3, (count, 1)), 0, bands - 1.001)
    matrix, low = np.zeros((count, INPUTS, INPUTS), np.float32), there.astype(int)
    piece, band = np.arange(count)[:, None], np.arange(bands)[None]
    matrix[piece, low, band] = 1 - (there - low)
    matrix[piece, low + 1, band] = there - low
    matrix[:, bands, bands] = 1
    return features @ torch.from_numpy(matrix)


def masked(rng, features):
    """Some bands of each piece are not heard, so that it does not lean on any (SpecAugment: D. Park et al., Interspeech 2019)."""
    for piece in features:
        if rng.random() < 0.4:
            width = rng.integers(1, 6)
            at = rng.integers(INPUTS - width)
            piece[:, at : at + width] = 0
    return features
