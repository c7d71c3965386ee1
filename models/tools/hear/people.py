# SPDX-License-Identifier: GPL-3.0-or-later
"""People who speak, from Debian's packages, with the phones that they say: by labels of their own, or laid onto their text by `faccia align`.

python3 people.py BUILD PLACE OUT.npz [--only WORD]
PLACE: where festvox-ru, tuxpaint-stamps-default and asterisk-prompt-it-menardi-wav were unpacked (`apt-get download PACKAGE`,
`dpkg -x PACKAGE*.deb PLACE`). Wants sox, python3-numpy, asterisk-core-sounds-it for the text of the last; with --only kal, Festival's KAL in
English instead. Nobody here is among those that
tests/bench/hear.mjs hears.
"""
import argparse
import glob
import gzip
import json
import os
import re
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from sounds import RATE

STAMPS = 'usr/share/tuxpaint/stamps'
RUSSIAN = 'usr/share/festival/voices/russian/msu_ru_nsh_clunits'
PROMPTS = 'usr/share/asterisk/sounds'
STAMPS_OF_A_LANGUAGE = 130
# Kept for choices: nobody of these is trained on.
HELD = ('tuxpaint-es', 'tuxpaint-en', 'menardi', 'kal')
# festvox-ru's names; a doubled consonant is the palatalised one.
RUSSIAN_IPA = {
    'pau': '', 'a': 'a', 'aa': 'a', 'ay': 'ʌ', 'ae': 'ə', 'e': 'e', 'ee': 'e', 'i': 'i', 'ii': 'i', 'oo': 'o', 'u': 'u', 'uu': 'u', 'ur': 'u',
    'y': 'ɨ', 'yy': 'ɨ', 'j': 'j', 'c': 's', 'ch': 'ʃ', 'sh': 'ʂ', 'sch': 'ɕ', 'zh': 'ʐ', 'h': 'x', 'hh': 'x',
}  # fmt: skip


# What Festival's KAL says, for choices in English.
SAID = (
    'My brother put the paper boat in the bath before five.', 'Every Friday we visit the village by the river.',
    'Please move the blue van from in front of my gate.', 'The baby began to laugh when the puppy barked.', 'Never leave the oven on for more than half an hour.',
    'I believe the map was published above a bookshop.', 'Perhaps the farmer will buy some sheep and a bull.', 'We climbed up the steep path with heavy bags.',
    'What have you done with the money that I gave you?', 'The chief of police found a knife behind the shelf.', 'She wore a purple velvet jumper at the office party.',
    'Both of them love fresh bread with butter and jam.', 'The number of bees in my garden has gone up again.', 'Can you help me find a cheap room for a week?',
    'Five brave women saved a family from the flood.', 'It may rain, but the film begins at half past seven.', 'Tom keeps a map of Europe pinned up in his cabin.',
    'The lamp on top of the wardrobe fell and broke.', 'Give me a moment to fasten the belt of my bag.', 'Nobody remembers when the mill was built.',
)  # fmt: skip


def kal(build):
    for k, text in enumerate(SAID):
        with tempfile.TemporaryDirectory() as folder:
            wav, out = os.path.join(folder, f'kal-{k}.wav'), os.path.join(folder, 'a.json')
            subprocess.run([f'{build}/server/cli/faccia', 'say', '-l', 'en', '-v', 'festival:kal', '--wav', wav, '--json', out, text], capture_output=True, check=True)
            with open(out, encoding='utf-8') as file:
                yield {'speaker': 'kal', 'sound': wav, 'phones': json.load(file)['phones'], 'heard': read(wav)}


def read(path):
    raw = subprocess.run(['sox', '-V0', path, '-t', 'raw', '-e', 'signed', '-b', '16', '-c', '1', '-r', str(RATE), '-'], capture_output=True, check=False)
    return np.frombuffer(raw.stdout, np.int16)


def russian(place):
    for path in sorted(glob.glob(f'{place}/{RUSSIAN}/wav/*.wav')):
        start, phones = 0.0, []
        with open(path.replace('/wav/', '/lab/').replace('.wav', '.lab'), encoding='utf-8') as file:
            for line in file:
                found = re.fullmatch(r'\s*([\d.]+)\s+\d+\s+(\w+)\s*', line)
                if found:
                    name, end = found[2], float(found[1])
                    ipa = RUSSIAN_IPA.get(name, name[0])
                    phones.append({'ipa': ipa, 'start': start, 'end': end})
                    start = end
        yield {'speaker': 'festvox-ru', 'sound': path, 'phones': phones}


def stamps(place):
    counts = {}
    paths = sorted(glob.glob(f'{place}/{STAMPS}/**/*_desc*.ogg', recursive=True), key=lambda p: hash_of(os.path.basename(p)))
    for path in paths:
        found = re.fullmatch(r'(.*)_desc(?:_(\w+))?\.ogg', path)
        if not found or not os.path.exists(found[1] + '.txt'):
            continue
        base, lang = found.groups()
        with open(base + '.txt', encoding='utf-8') as file:
            lines = file.read().splitlines()
        text = lines[0] if not lang else next((line.split('=', 1)[1] for line in lines if line.startswith(f'{lang}.utf8=')), None)
        lang = lang or 'en'
        if text and not re.search(r'[\d($]', text) and counts.get(lang, 0) < STAMPS_OF_A_LANGUAGE:
            counts[lang] = counts.get(lang, 0) + 1
            yield {'speaker': f'tuxpaint-{lang}', 'sound': path, 'lang': lang, 'text': text}


def hash_of(name):
    return sum((i + 1) * ord(c) for i, c in enumerate(name)) * 2654435761 % 2**32


def menardi(place):
    """Her words are not always those of the list, which is another's: the aligner refuses her then."""
    with gzip.open('/usr/share/doc/asterisk-core-sounds-it/core-sounds-it.txt.gz', 'rt', encoding='utf-8', errors='replace') as file:
        for line in file:
            found = re.fullmatch(r'([\w/-]+):\s+(.*\S)\s*', line.strip())
            path = f'{place}/{PROMPTS}/it_IT_f_Menardi/{found[1]}.wav' if found else ''
            if os.path.exists(path) and not re.search(r'\w\?|[\[\](){}<>*#/]|: ', found[2]) and len(found[2].split()) >= 3:
                yield {'speaker': 'menardi', 'sound': path, 'lang': 'it', 'text': found[2].replace('..', ' ')}


def aligned(build, item):
    """Its phones; None where the words are not those."""
    if 'phones' in item:
        return item['phones']
    with tempfile.TemporaryDirectory() as folder:
        text, out = os.path.join(folder, 'a.txt'), os.path.join(folder, 'a.json')
        with open(text, 'w', encoding='utf-8') as file:
            file.write(re.sub(r'[“”«»„"*_]', ' ', item['text']))
        subprocess.run([f'{build}/server/cli/faccia', 'align', '-q', item['sound'], '--text', text, '-l', item['lang'], '--json', out], capture_output=True, check=False)
        if not os.path.exists(out) or not os.path.getsize(out):
            return None
        with open(out, encoding='utf-8') as file:
            return json.load(file)['phones']


def pieces(rng, path, least):
    """Of a file that main() wrote: (speaker, sound, phones, somebody else's sound); what is shorter than `least` s is joined by pauses."""
    data = np.load(path)
    sounds, items = data['sounds'], json.loads(str(data['items']))
    ends = np.cumsum([item['samples'] for item in items])
    order = sorted(range(len(items)), key=lambda i: (items[i]['speaker'], rng.random()))
    joined, phones, speaker = np.zeros(0), [], None
    for i in [*order, None]:
        if phones and (i is None or items[i]['speaker'] != speaker or len(joined) >= 4 * least * RATE):
            at = rng.integers(max(1, len(sounds) - len(joined)))
            yield speaker, np.pad(joined, (0, int(-len(joined) % (least * RATE)) + 1)), phones, sounds[at : at + len(joined)] / 32768
            joined, phones = np.zeros(0), []
        if i is None:
            break
        speaker = items[i]['speaker']
        sound = sounds[ends[i] - items[i]['samples'] : ends[i]] / 32768
        start = len(joined) / RATE
        phones += [{**p, 'start': p['start'] + start, 'end': p['end'] + start} for p in items[i]['phones']]
        joined = np.concatenate([joined, sound / (np.max(np.abs(sound)) + 1e-9) * 0.7, np.zeros(int(rng.uniform(0, 0.4) * RATE))])
        phones.append({'ipa': '', 'start': phones[-1]['end'], 'end': len(joined) / RATE})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('build')
    parser.add_argument('place')
    parser.add_argument('out')
    parser.add_argument('--only', default='', help='speakers whose name has this in it')
    options = parser.parse_args()
    sources = [russian(options.place), stamps(options.place), menardi(options.place), *([kal(options.build)] if options.only == 'kal' else [])]
    items = [i for source in sources for i in source if options.only in i['speaker']]
    sounds, kept, told = [], [], {}
    with ThreadPoolExecutor(2) as pool:
        for item, phones in zip(items, pool.map(lambda i: aligned(options.build, i), items)):
            count = told.setdefault(item['speaker'], [0, 0, 0.0])
            count[1] += 1
            if phones:
                sound = item['heard'] if 'heard' in item else read(item['sound'])
                count[0] += 1
                count[2] += len(sound) / RATE
                sounds.append(sound)
                kept.append({'speaker': item['speaker'], 'name': os.path.basename(item['sound']), 'samples': len(sound), 'phones': phones})
    for speaker, (some, all_, seconds) in sorted(told.items()):
        print(f'{speaker}: {some} of {all_}, {seconds:.0f} s')
    np.savez(options.out, sounds=np.concatenate(sounds), items=json.dumps(kept))


if __name__ == '__main__':
    main()
