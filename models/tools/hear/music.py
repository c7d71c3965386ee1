# SPDX-License-Identifier: GPL-3.0-or-later
"""Sounds of nobody, of our own making: instruments that there are not, drums, wind, hums, clicks. What the tests play is made elsewhere, otherwise."""
import numpy as np
from scipy import signal
from sounds import RATE, band, coloured, music


def put(out, at, sound):
    first = int(at * RATE)
    out[first : first + len(sound)] += sound[: max(0, len(out) - first)]


def scale_of(rng):
    return np.sort(rng.choice([0, 2, 3, 4, 5, 7, 8, 9, 10, 12, 14, 15, 17, 19], 7))


def string(rng, hz, seconds, damp):
    """A string that is plucked: noise that goes round in as many samples as the tone has, and is smoothed (K. Karplus, A. Strong, CMJ 1983)."""
    count, period = int(seconds * RATE), max(3, round(RATE / hz))
    noise = np.zeros(count)
    noise[:period] = rng.uniform(-1, 1, period)[:count]
    loop = np.zeros(period + 2)
    loop[0], loop[period], loop[period + 1] = 1, -damp * 0.5, -damp * 0.5
    return signal.lfilter([1], loop, noise)


def plucked(rng, count):
    out, seconds, beat = np.zeros(count), count / RATE, rng.uniform(0.09, 0.5)
    root, scale, damp, run = rng.uniform(70, 280), scale_of(rng), rng.uniform(0.96, 0.999), rng.random() < 0.5
    for k, at in enumerate(np.arange(0, seconds, beat)):
        steps = [scale[k % len(scale)]] if run else rng.choice(scale, rng.integers(0, 4))
        for step in steps:
            put(out, at + rng.uniform(0, 0.02), rng.uniform(0.4, 1) * string(rng, root * 2 ** (step / 12), min(1.5, seconds - at), damp))
    return out


def beats(rng, count, out=None):
    """Percussion over the whole spectrum, in a pattern of sixteen."""
    out, step = np.zeros(count) if out is None else out, 60 / rng.uniform(70, 180) / 4
    for _ in range(rng.integers(2, 5)):
        pattern, kind, decay, loud = rng.random(16) < rng.uniform(0.1, 0.6), rng.integers(4), rng.uniform(8, 60), rng.uniform(0.3, 1.2)
        low, high = sorted(rng.uniform(100, 7500, 2))
        t = np.arange(int(0.4 * RATE)) / RATE
        for k, at in enumerate(np.arange(0, count / RATE, step)):
            if not pattern[k % 16]:
                continue
            noise = coloured(rng, len(t), 0)
            if kind == 0:
                hit = np.sin(2 * np.pi * (low / 40 * np.exp(-30 * t) + 45 + low / 60) * t)
            elif kind == 1:
                hit = band(noise, low, max(high, low + 200)) * 2
            elif kind == 2:
                hit = 0.5 * noise + np.sin(2 * np.pi * (150 + low / 20) * t)
            else:
                hit = np.diff(noise, prepend=0)
            put(out, at, loud * rng.uniform(0.5, 1) * hit * np.exp(-decay * t))
    return out


def tune(rng, count):
    """One voice of an instrument with vibrato and swells, through resonances that stay."""
    out, seconds, at = np.zeros(count), count / RATE, 0.0
    root, scale, vibrato, rate = rng.uniform(110, 700), scale_of(rng), rng.uniform(0, 0.02), rng.uniform(3.5, 7.5)
    shape = rng.integers(3)
    while at < seconds:
        length = rng.choice([0.12, 0.2, 0.3, 0.45, 0.9, 1.5]) * rng.uniform(0.8, 1.2)
        t = np.arange(int(length * RATE)) / RATE
        hz = root * 2 ** (rng.choice(scale) / 12) * (1 + vibrato * np.sin(2 * np.pi * rate * t) * np.minimum(1, t * 3))
        phase = np.cumsum(hz) / RATE % 1
        wave = [2 * phase - 1, np.sign(phase - rng.uniform(0.2, 0.5)), 1 - 4 * np.abs(phase - 0.5)][shape]
        if rng.random() > 0.1:
            put(out, at, wave * np.minimum(1, t / rng.uniform(0.005, 0.08)) * np.minimum(1, (length - t) / 0.03))
        at += length
    for _ in range(rng.integers(0, 3)):
        middle = rng.uniform(250, 3500)
        out += rng.uniform(0.3, 2) * band(out, middle / 1.2, middle * 1.2)
    return out


def bass(rng, count):
    out, beat, root, scale = np.zeros(count), rng.uniform(0.15, 0.6), rng.uniform(38, 75), scale_of(rng)
    for at in np.arange(0, count / RATE, beat):
        t = np.arange(int(beat * RATE)) / RATE
        hz = root * 2 ** (rng.choice(scale) / 12)
        put(out, at, np.tanh(rng.uniform(1, 6) * np.sin(2 * np.pi * hz * t)) * np.exp(-rng.uniform(0, 6) * t))
    return beats(rng, count, out * rng.uniform(0.5, 2)) if rng.random() < 0.7 else out


def wind(rng, count):
    loud = np.maximum(0.05, 0.5 + np.interp(np.arange(count), np.linspace(0, count, 14), rng.standard_normal(14)) * rng.uniform(0.1, 0.6))
    low = rng.uniform(100, 1500)
    return coloured(rng, count, rng.uniform(0, 2)) * loud + rng.uniform(0, 3) * loud**2 * band(coloured(rng, count, 0), low, 1.5 * low)


def hum(rng, count):
    t, hz = np.arange(count) / RATE, rng.choice([50, 60, rng.uniform(40, 400)])
    tone = sum(n ** -rng.uniform(0.2, 2) * np.sin(2 * np.pi * (n * hz * t + rng.random())) for n in range(1, 14) if n * hz < 7900)
    return tone * (1 + rng.uniform(0, 0.6) * np.sin(2 * np.pi * rng.uniform(0.3, 12) * t)) + rng.uniform(0, 0.3) * coloured(rng, count, 1)


def clicks(rng, count):
    """A crowd of them: rain, typing, applause."""
    out, rate = np.zeros(count), np.exp(rng.uniform(np.log(4), np.log(600)))
    low = rng.uniform(200, 4000)
    t = np.arange(int(0.03 * RATE)) / RATE
    for at in rng.uniform(0, count / RATE, int(rate * count / RATE)):
        put(out, at, np.exp(rng.normal(0, 0.6)) * rng.standard_normal(len(t)) * np.exp(-rng.uniform(100, 900) * t))
    return out if rng.random() < 0.5 else out * 0.3 + band(out, low, min(7800, 2 * low))


KINDS = [(music, 3), (plucked, 3), (beats, 3), (tune, 3), (bass, 2), (wind, 1.5), (hum, 1), (clicks, 2)]


def nobodys(rng, count):
    """Some of all that, one kind or two together; at times it swells or stops. Its loudest is 1."""
    share = np.array([s for _, s in KINDS])
    out = np.zeros(count)
    for k in rng.choice(len(KINDS), rng.choice([1, 2], p=[0.6, 0.4]), replace=False, p=share / share.sum()):
        one = KINDS[k][0](rng, count)
        out += rng.uniform(0.3, 1) * one / (np.sqrt(np.mean(one**2)) + 1e-9)
    if rng.random() < 0.3:
        out *= np.interp(np.arange(count), np.linspace(0, count, 8), rng.uniform(0, 1, 8))
    return out / (np.max(np.abs(out)) + 1e-9)
