# SPDX-License-Identifier: GPL-3.0-or-later
"""Voices of Festival that faccia has not, made of recordings of people who speak Czech (four), Finnish (two), American, Telugu and Catalan, for the training, in the form of
people.py.

python3 diphones.py OUT.npz [--minutes N] [--seed N]
Wants festvox-czech-dita, -krb, -machac, -ph, festvox-suopuhe-lj and -mv, festvox-kdlpc16k, -te-nsk and -ca-ona-hts, wamerican, witalian and python3-scipy. The words are Italian,
English and made up: what counts is each sound beside each other.
"""
import argparse
import json
import os
import subprocess
import tempfile
import wave

import numpy as np
from flite import IPA as AMERICAN
from flite import text_of as english_of
from make_data import OFTEN, words_of
from scipy import signal
from sounds import RATE

VOICES = ['czech_dita', 'czech_krb', 'czech_machac', 'czech_ph', 'suo_fi_lj_diphone', 'hy_fi_mv_diphone', 'ked_diphone', 'telugu_NSK_diphone', 'upc_ca_ona_hts']
EUROPEAN = {
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


# β has no class: neither Catalan's b between vowels nor Telugu's v is what its letter says.
INDIAN = {
    'pau': '', '@': 'a', 'a': 'a', 'aa': 'a', 'ih': 'i', 'iy': 'i', 'uh': 'u', 'uw': 'u', 'eh': 'e', 'ee': 'e', 'ay': 'ai', 'oh': 'o', 'oo': 'o', 'aw': 'au', 'w': 'u', 'ch': 'tʃ', 'j': 'dʒ',
    'T': 'ʈ', 'D': 'ɖ', 'N': 'ɳ', 'th': 't', 'dh': 'd', 'tth': 't', 'ddh': 'd', 'td': 'ʈ', 'L': 'ɭ', 'R': 'r', 'v': 'β', 'sh': 'ʃ', 'ksh': 'ʃ', 'sri': 'ʃ', 'zh': 'ʒ', 'y': 'j', 'x': '?',
}  # fmt: skip
CATALAN = {'pau': '', 'ax': 'ə', 'E': 'ɛ', 'O': 'ɔ', 'S': 'ʃ', 'Z': 'ʒ', 'tS': 'tʃ', 'dZ': 'dʒ', 'J': 'ɲ', 'L': 'ʎ', 'N': 'ŋ', 'rr': 'r', 'w': 'w'}
OF = {'ked_diphone': AMERICAN, 'telugu_NSK_diphone': INDIAN, 'upc_ca_ona_hts': CATALAN}
LETTERS, MARKS = 'కగచజటడతదనపఫబభమయరలసశమపబమపబ', ['', 'ా', 'ి', 'ీ', 'ు', 'ూ', 'ె', 'ే', 'ొ', 'ో']


def ipa_of(name, voice):
    names = OF.get(voice, EUROPEAN)
    return names.get(name) if name in names else names.get(name.rstrip(':12'), name.rstrip(':12')[:1])


def between_vowels(phones):
    for before, phone, after in zip(phones, phones[1:], phones[2:]):
        if phone['ipa'] == 'b' and before['ipa'][:1] not in ('', 'm') and after['ipa']:
            phone['ipa'] = 'β'


def text_of(rng, voice, words):
    if voice == 'ked_diphone':
        return english_of(rng, words['en'], OFTEN['en'].split())
    if voice == 'telugu_NSK_diphone':
        return ' '.join(''.join(rng.choice(list(LETTERS)) + rng.choice(MARKS) for _ in range(rng.integers(1, 5))) for _ in range(rng.integers(3, 10))) + '.'
    return italian_of(rng, words['it'])


def italian_of(rng, words):
    def word():
        if rng.random() < 0.6:
            return words[rng.integers(len(words))].encode('ascii', 'ignore').decode()
        return ''.join(rng.choice(list('pbmfvtdnszklrjhfvpbm')) + rng.choice(list('aeiou')) + rng.choice(list('      nlrsmp')).strip() for _ in range(rng.integers(1, 4)))

    return ' '.join(word() for _ in range(rng.integers(3, 12))) + '.'


def spoken(rng, voice, words, folder):
    texts = ' '.join(f'"{text_of(rng, voice, words)}"' for _ in range(8))
    text = SCHEME.format(voice=voice, stretch=f'{rng.uniform(0.75, 1.3):.2f}', folder=folder, texts=texts)
    with open(os.path.join(folder, 'a.scm'), 'w', encoding='utf-8') as file:
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
                    phones.append({'ipa': ipa_of(fields[2], voice), 'start': start, 'end': float(fields[0])})
                    start = float(fields[0])
        if voice == 'upc_ca_ona_hts':
            between_vowels(phones)
        os.remove(wav)
        os.remove(lab)
        yield np.round(np.clip(signal.resample_poly(sound, RATE, hz), -32767, 32767)).astype(np.int16), phones


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('out')
    parser.add_argument('--minutes', type=float, default=20, help='of speech')
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rng, words = np.random.default_rng(options.seed), {lang: words_of(lang) for lang in ('it', 'en')}
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
