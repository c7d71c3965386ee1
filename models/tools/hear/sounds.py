# SPDX-License-Identifier: GPL-3.0-or-later
"""Phones by what is seen of them, and what happens to sound between a mouth and a microphone."""
import subprocess
import unicodedata

import numpy as np
from scipy import signal

RATE = 16000

# A class, and the phones (IPA) that look like it. The order is that of server/live/lip_recogniser.c.
CLASSES = [
    ('silence', ''),
    ('closed', 'pbmɓ'),
    ('teeth', 'fvɱʋ'),
    ('rounded', 'ʃʒɕʑʂʐ'),
    ('dental', 'θð'),
    ('hiss', 'sz'),
    ('tip', 'tdnɳɲʈɖ'),
    ('liquid', 'lrɹɾɻʎɭɫʀɬɽ'),
    ('back', 'kɡgŋxɣhɦχʁqcɟçʔɢħʝɰ'),
    ('open', 'aɑæʌɐɶäɒ'),
    ('middle', 'eɛəɜɚɝɤɘᵻ'),
    ('middle-round', 'oɔøœɵ'),
    ('close', 'iɪjɨɯɪ'),
    ('close-round', 'uʊywɥʏʉ'),
]
CLASS_OF = {letter: number for number, (_, letters) in enumerate(CLASSES) for letter in letters}
UNKNOWN = 255


def classes_of(ipa):
    """The classes of a phone's parts, in order: two of a diphthong, that of the release of an affricate."""
    letters = [c for c in unicodedata.normalize('NFD', ipa) if unicodedata.category(c) in ('Ll', 'Lo')]
    found = [CLASS_OF.get(c, UNKNOWN) for c in letters]
    if not ipa:
        return [0]
    if not found:
        return [UNKNOWN]
    if any(c >= 9 for c in found):
        return found
    return [found[-1]]


def labels(phones, frames, seconds_of_frame):
    """The class at the middle of each frame's window."""
    edges, classes = [], []
    for phone in phones:
        parts = classes_of(phone['ipa'])
        length = (phone['end'] - phone['start']) / len(parts)
        for i, part in enumerate(parts):
            edges.append(phone['start'] + (i + 1) * length)
            classes.append(part)
    at = np.searchsorted(edges, seconds_of_frame(np.arange(frames)), side='right')
    return np.array(classes + [0], np.uint8)[np.minimum(at, len(classes))]


def band(sound, low, high):
    return signal.sosfilt(signal.butter(4, [low, high], 'bandpass', fs=RATE, output='sos'), sound)


def coloured(rng, count, tilt):
    spectrum = np.fft.rfft(rng.standard_normal(count))
    spectrum *= np.maximum(np.arange(len(spectrum)), 8.0) ** (-tilt / 2)
    noise = np.fft.irfft(spectrum, count)
    return noise / (np.sqrt(np.mean(noise**2)) + 1e-12)


def equalised(rng, sound, most):
    """Through a microphone of its own: up to so many dB more or less at eight places of the spectrum."""
    knots = np.geomspace(80, 8000, 8)
    spectrum = np.fft.rfft(sound)
    hz = np.maximum(np.fft.rfftfreq(len(sound), 1 / RATE), 60)
    gain = np.interp(np.log(hz), np.log(knots), rng.uniform(-most, most, 8))
    return np.fft.irfft(spectrum * 10 ** (gain / 20), len(sound))


def in_room(rng, sound):
    seconds = rng.uniform(0.12, 0.6)
    count = int(seconds * RATE)
    tail = rng.standard_normal(count) * 10 ** (-3 * np.arange(count) / count)
    tail[: int(0.003 * RATE)] = 0
    tail *= 10 ** (-rng.uniform(2, 15) / 20) / np.sqrt(np.sum(tail**2))
    tail[0] = 1
    return signal.fftconvolve(sound, tail)[: len(sound)]


def telephone(rng, sound):
    low, high = (rng.uniform(60, 350), rng.uniform(3200, 3950))
    narrow = signal.resample_poly(band(sound, low, high), 1, 2)
    if rng.random() < 0.5:  # mu-law, 8 bits (ITU-T G.711)
        top = np.max(np.abs(narrow)) + 1e-9
        x = np.clip(narrow / top * rng.uniform(0.2, 1), -1, 1)
        code = np.round(np.sign(x) * np.log1p(255 * np.abs(x)) / np.log(256) * 127) / 127
        narrow = np.sign(code) * (256 ** np.abs(code) - 1) / 255
    return signal.resample_poly(narrow, 2, 1)[: len(sound)]


def coded(rng, sound):
    """Through Opus at 8 to 16 kbit/s, as calls have it. Its length and place stay."""
    raw = np.round(np.clip(sound / (np.max(np.abs(sound)) + 1e-9) * 0.7, -1, 1) * 32767).astype('<i2').tobytes()
    form = ['-f', 's16le', '-ar', str(RATE), '-ac', '1']
    quiet = ['ffmpeg', '-v', 'error', '-threads', '1']
    rate = ['-b:a', f'{rng.integers(8, 17)}k', '-application', 'voip', '-frame_duration', str(rng.choice([20, 40, 60]))]
    packets = subprocess.run([*quiet, *form, '-i', '-', '-c:a', 'libopus', *rate, '-f', 'ogg', '-'], input=raw, capture_output=True, check=True).stdout
    back = np.frombuffer(subprocess.run([*quiet, '-i', '-', *form, '-'], input=packets, capture_output=True, check=True).stdout, '<i2') / 32768
    return np.pad(back, (0, max(0, len(sound) - len(back))))[: len(sound)]


def music(rng, count):
    """Instruments that there are not, in chords or one by one, with or without drums. Nobody sings."""
    out, seconds, beat = np.zeros(count), count / RATE, rng.uniform(0.15, 0.8)
    harmonics, decay = np.arange(1, 9), rng.uniform(0, 8)
    strength = harmonics ** -rng.uniform(0.3, 2.5) * rng.uniform(0.2, 1, 8)
    root, scale = rng.uniform(55, 330), rng.choice([0, 2, 3, 4, 5, 7, 8, 9, 10, 12, 14, 15, 17, 19], 7)
    for at in np.arange(0, seconds, beat):
        length = min(seconds - at, beat * rng.choice([0.5, 1, 1, 2, 4]))
        t = np.arange(int(length * RATE)) / RATE
        for step in rng.choice(scale, rng.integers(0, 4)):
            hz = root * 2 ** (step / 12) * (1 + rng.uniform(0, 0.01) * np.sin(2 * np.pi * rng.uniform(4, 7) * t))
            phase = 2 * np.pi * np.cumsum(hz) / RATE
            tone = sum(a * np.sin(n * phase) for n, a in zip(harmonics, strength) if n * np.max(hz, initial=0) < RATE / 2)
            out[int(at * RATE) :][: len(t)] += (tone * np.exp(-decay * t) * np.minimum(1, 1 + (t - length) / 0.02) * np.minimum(1, t / 0.01 + 0.1))[: count - int(at * RATE)]
    if rng.random() < 0.6:
        for at in np.arange(0, seconds, beat / rng.choice([1, 2])):
            t = np.arange(int(min(seconds - at, 0.3) * RATE)) / RATE
            kind = rng.integers(3)
            hit = np.sin(2 * np.pi * 60 * t) if kind == 0 else coloured(rng, max(2, len(t)), [0, -1][kind - 1])[: len(t)]
            out[int(at * RATE) :][: len(t)] += rng.uniform(0.3, 1.5) * hit * np.exp(-rng.uniform(10, 50) * t)
    return out / (np.sqrt(np.mean(out**2)) + 1e-9)


def with_noise(rng, sound, other, low, high):
    kind = rng.integers(5)
    noise = music(rng, len(sound)) if kind == 4 else coloured(rng, len(sound), [0, 1, 2, 1][kind])
    if kind == 3 and len(other) >= len(sound):  # others who talk, backwards: no phone of theirs is to be shown
        at = rng.integers(len(other) - len(sound) + 1)
        noise = other[at : at + len(sound)][::-1]
    power = np.mean(sound**2) / (np.mean(noise**2) + 1e-12)
    return sound + noise * np.sqrt(power) * 10 ** (-rng.uniform(low, high) / 20)


def augmented(rng, sound, other):
    """The sound as one of many microphones would have it. Its length stays."""
    if rng.random() < 0.6:
        sound = equalised(rng, sound, rng.uniform(2, 9))
    if rng.random() < 0.4:
        sound = in_room(rng, sound)
    if rng.random() < 0.55:
        sound = with_noise(rng, sound, other, 3, 35)
    line = rng.random()
    if line < 0.42:
        sound = telephone(rng, sound)
    elif line < 0.45:
        sound = coded(rng, sound)
    sound = sound / (np.max(np.abs(sound)) + 1e-9) * 10 ** (-rng.uniform(0, 30) / 20)
    if rng.random() < 0.1:
        sound = np.clip(sound * rng.uniform(1, 4), -np.max(np.abs(sound)), np.max(np.abs(sound)))
    return np.clip(sound, -1, 1)
