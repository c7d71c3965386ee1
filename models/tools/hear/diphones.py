# SPDX-License-Identifier: GPL-3.0-or-later
"""Voices of Festival that faccia has not, made of recordings of four Czech and two Finnish speakers, for the training, in the form of people.py.

python3 diphones.py OUT.npz [--minutes N] [--seed N]
Wants festvox-czech-dita, -krb, -machac, -ph, festvox-suopuhe-lj and -mv, witalian and python3-scipy. The words are Italian and made up: what counts
is each sound beside each other.
"""
import argparse
import json
import os
import subprocess
import tempfile
import wave

import numpy as np
from make_data import words_of
from scipy import signal
from sounds import RATE

VOICES = ['czech_dita', 'czech_krb', 'czech_machac', 'czech_ph', 'suo_fi_lj_diphone', 'hy_fi_mv_diphone']
IPA = {
    '#': '', '_': '', 'pau': '', 'c': 'ts', 'c~': 'tʃ', 'ch': 'x', 'd~': 'ɟ', 't~': 'c', 'dz~': 'dʒ', 'n~': 'ɲ', 'n*': 'ŋ', 'r~': 'ʒ', 'r~*': 'ʃ', 's~': 'ʃ', 'z~': 'ʒ',
    '@': 'ə', 'y': 'y', '{': 'æ', '2': 'ø', 'N': 'ŋ', 'S': 'ʃ',
}  # fmt: skip
SCHEME = """
(voice_{voice})
(Parameter.set 'Duration_Stretch {stretch})
(set! whole_unit_concat us_unit_concat)
(define (us_unit_concat utt)
  (mapcar (lambda (unit) (let ((wave (wave.copy (item.feat unit "sig")))) (wave.rescale wave 0.4 nil) (item.set_feat unit "sig" wave)))
          (utt.relation.items utt 'Unit))
  (whole_unit_concat utt))
(let ((n 0)) (mapcar (lambda (text) (let ((utt (utt.synth (eval (list 'Utterance 'Text text)))))
  (utt.save.wave utt (format nil "{folder}/%d.wav" n) 'riff) (utt.save.segs utt (format nil "{folder}/%d.lab" n)) (set! n (+ n 1)))) '({texts})))
"""


def ipa_of(name):
    return IPA.get(name) if name in IPA else IPA.get(name.rstrip(':12'), name.rstrip(':12')[:1])


def text_of(rng, words):
    def word():
        if rng.random() < 0.6:
            return words[rng.integers(len(words))].encode('ascii', 'ignore').decode()
        return ''.join(rng.choice(list('pbmfvtdnszklrjhfvpbm')) + rng.choice(list('aeiou')) + rng.choice(list('      nlrsmp')).strip() for _ in range(rng.integers(1, 4)))

    return ' '.join(word() for _ in range(rng.integers(3, 12))) + '.'


def spoken(rng, voice, words, folder):
    texts = ' '.join(f'"{text_of(rng, words)}"' for _ in range(8))
    text = SCHEME.format(voice=voice, stretch=f'{rng.uniform(0.75, 1.3):.2f}', folder=folder, texts=texts)
    with open(os.path.join(folder, 'a.scm'), 'w', encoding='iso-8859-1') as file:
        file.write(text)
    done = subprocess.run(['festival', '-b', os.path.join(folder, 'a.scm')], capture_output=True, check=False)
    for k in range(8):
        wav, lab = (os.path.join(folder, f'{k}.{e}') for e in ('wav', 'lab'))
        if not os.path.exists(wav):
            print(voice, done.stderr.decode(errors='replace')[:300])
            return
        with wave.open(wav) as file:
            hz, sound = file.getframerate(), np.frombuffer(file.readframes(file.getnframes()), np.int16).astype(float)
        start, phones = 0.0, []
        with open(lab, encoding='iso-8859-1') as file:
            for line in file:
                fields = line.split()
                if len(fields) == 3 and fields[0] != 'separator':
                    phones.append({'ipa': ipa_of(fields[2]), 'start': start, 'end': float(fields[0])})
                    start = float(fields[0])
        os.remove(wav)
        os.remove(lab)
        yield np.round(np.clip(signal.resample_poly(sound, RATE, hz), -32767, 32767)).astype(np.int16), phones


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('out')
    parser.add_argument('--minutes', type=float, default=20, help='of speech')
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rng, words = np.random.default_rng(options.seed), words_of('it')
    sounds, items = [], []
    with tempfile.TemporaryDirectory() as folder:
        for voice in VOICES:
            had = 0.0
            while had < options.minutes * 60 / len(VOICES):
                before = had
                for sound, phones in spoken(rng, voice, words, folder):
                    sounds.append(sound)
                    items.append({'speaker': voice, 'name': voice, 'samples': len(sound), 'phones': phones})
                    had += len(sound) / RATE
                if had == before:
                    break
            print(voice, round(had), 's', sorted({p['ipa'] for i in items if i['speaker'] == voice for p in i['phones']}), flush=True)
    np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(items))


if __name__ == '__main__':
    main()
