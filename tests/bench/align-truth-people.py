# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of people whose words and phones have known times, for tests/bench/align-truth.mjs.

python3 tests/bench/align-truth-people.py PLACE OUT
PLACE: clones of the repositories below, each named as its last part (`git clone https://github.com/IPS-LMU/emuR PLACE/emuR`...); what is not there is left
out. Files are compared with the hashes of those measured. Wants sox, ffmpeg, python3-numpy, python3-scipy, pocketsphinx with pocketsphinx-en-us, and
Debian's pocketsphinx-testdata, asterisk-core-sounds-en and -en-g722, festvox-ru. Nothing of it may be copied into this repository.

| person | source | times |
|---|---|---|
| msajc | IPS-LMU/emuR, an Australian man | by hand |
| mary, bobby, damon | timmahrt/praatIO | by hand |
| H | bbTomas/rPraat, Czech | by hand |
| F01, M01, M04 | jaekookang/Python-EMA-Viewer (Haskins production rate comparison) | the corpus's: an aligner, corrected |
| cas7D | MLSpeech/AutoVOT, spontaneous British English | the corpus's: an aligner |
| ru | Debian's festvox-ru, a man | the voice's |
| spk1, spk2, sa1, austen, allison | speechbrain/speechbrain, lingjzhu/charsiu, pocketsphinx-testdata, asterisk-core-sounds-en-g722 | pocketsphinx, sentence by sentence |
"""
import argparse
import gzip
import hashlib
import io
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io

RATE = 16000
GAP = 0.35  # s of faint noise after each sentence
RUSSIAN = '/usr/share/festival/voices/russian/msu_ru_nsh_clunits'
ENGLISH = '/usr/share/pocketsphinx/model/en-us'
READER = '/usr/share/pocketsphinx/test/data/librivox'
PROMPTS = '/usr/share/asterisk/sounds/en_US_f_Allison'
# The first 16 digits of SHA-256 of all that is taken from a repository, in order.
HASHES = {
    'emuR': '32661fdc32287798', 'praatIO': '62c11853c3e294f8', 'rPraat': 'ebbc49fdd815a116', 'Python-EMA-Viewer': 'f1b282cdceb874a7', 'AutoVOT': '6547f9a70f1e9d98',
    'speechbrain': '03a4598ea7f3463c', 'charsiu': 'b46b9852f95af042',
}  # fmt: skip


class Source:
    """Files of a clone, working or bare."""

    def __init__(self, place, name):
        self.folder, self.name, self.hash = os.path.join(place, name), name, hashlib.sha256()

    def there(self):
        return os.path.isdir(self.folder)

    def git(self, *args):
        return subprocess.run(['git', '-C', self.folder, *args], capture_output=True, check=True).stdout

    def list(self, folder, ending):
        return sorted(n for n in self.git('ls-tree', '-r', '--name-only', 'HEAD', folder).decode().split('\n') if n.endswith(ending))

    def read(self, path):
        data = self.git('show', f'HEAD:{path}')
        self.hash.update(data)
        return data

    def check(self):
        found = self.hash.hexdigest()[:16]
        if HASHES.get(self.name) != found:
            print(f'{self.name}: other files than those measured ({found})', file=sys.stderr)


def sound(data, kind='wav', rate=None):
    more = ['-r', str(rate), '-e', 'signed', '-b', '16', '-c', '1'] if kind == 'raw' else []
    raw = subprocess.run(['sox', '-V0', '-t', kind, *more, '-', '-t', 'raw', '-e', 'signed', '-b', '16', '-c', '1', '-r', str(RATE), '-'], input=data, capture_output=True, check=True)
    return np.frombuffer(raw.stdout, np.int16)


def scaled(signal, rate):
    signal = np.asarray(signal, float).ravel()
    return sound((signal / np.abs(signal).max() * 20000).astype(np.int16).tobytes(), 'raw', int(rate))


def grid(text):
    """Tiers of a TextGrid: {name: [(start, end, label)]}, without empty labels and pauses."""
    values = [(number and float(number), text) for text, number in re.findall(r'"((?:[^"]|"")*)"|(-?\d+\.?\d*(?:e-?\d+)?)(?=\s|$)', re.sub(r'\[\d*\]', '', text))]
    at = [text for _, text in values].index('TextGrid') + 3
    tiers = {}
    count, at = int(values[at][0]), at + 1
    for _ in range(count):
        points, name, size = values[at][1] != 'IntervalTier', values[at + 1][1], int(values[at + 4][0])
        step, at = 2 if points else 3, at + 5
        rows = [(values[i][0], values[i + step - 2][0], values[i + step - 1][1]) for i in range(at, at + size * step, step)]
        tiers[name] = [row for row in rows if row[2] and row[2] not in ('sil', 'sp', 'SIL', '*') and row[2][0] != '{']
        at += size * step
    return tiers


def sentence(words):
    text = ' '.join(word for _, _, word in words)
    return text[:1].upper() + text[1:] + '.'


def lowered(words):
    return [(start, end, word.lower()) for start, end, word in words]


class Writer:
    def __init__(self, out):
        self.out = out
        os.makedirs(out, exist_ok=True)

    def write(self, name, split, by, sentences, lang='en', person=None):
        """sentences: [(samples, text, words, phones)], times in seconds."""
        sounds, texts, at = [], [], 0
        truth = {'lang': lang, 'by': by, 'split': split, 'person': person or name, 'words': [], 'phones': []}
        for samples, text, words, phones in sentences:
            for key, label, list_ in (('words', 'text', words), ('phones', 'label', phones)):
                truth[key] += [{label: what, 'start': round(at / RATE + start, 4), 'end': round(at / RATE + end, 4)} for start, end, what in list_]
            level = max(1, int(np.percentile(np.abs(samples.astype(int)), 5)))
            faint = np.random.default_rng(1).integers(-level, level + 1, int(GAP * RATE)).astype(np.int16)
            sounds += [samples, faint]
            at += len(samples) + len(faint)
            texts.append(text)
        path = os.path.join(self.out, name)
        subprocess.run(['sox', '-V0', '-t', 'raw', '-e', 'signed', '-b', '16', '-c', '1', '-r', str(RATE), '-', f'{path}.wav'], input=np.concatenate(sounds).tobytes(), check=True)
        with open(f'{path}.txt', 'w', encoding='utf-8') as file:
            file.write('\n'.join(texts) + '\n')
        with open(f'{path}.truth.json', 'w', encoding='utf-8') as file:
            json.dump(truth, file, ensure_ascii=False)
        print(f'{name}: {split}, {len(texts)} sentences, {at / RATE:.0f} s, {len(truth["words"])} words, {len(truth["phones"])} phones')


def by_hand(place, writer):
    source = Source(place, 'emuR')
    if source.there():
        some, folder = [], 'inst/extdata/rawDemoData'
        for number in ('003', '010', '012', '015', '022', '023', '057'):
            tiers = grid(source.read(f'{folder}/annotationFiles/msajc{number}.TextGrid').decode())
            some.append((sound(source.read(f'{folder}/wavFiles/msajc{number}.wav')), sentence(tiers['Text']), tiers['Text'], tiers['Phoneme']))
        writer.write('msajc', 'dev', 'hand', some)
        source.check()
    source = Source(place, 'praatIO')
    if source.there():
        for name, split, wav, words, word_tier, phones, phone_tier in (
            ('mary', 'dev', 'mary', 'mary', 'word', 'mary', 'phone'),
            ('bobby', 'test', 'bobby', 'bobby_words', 'word', 'bobby_phones', 'phone'),
            ('damon', 'test', 'damon_set_test', 'damon_set_test', 'words', 'damon_set_test', 'phons'),
        ):
            said, sounds = (grid(source.read(f'examples/files/{file}.TextGrid').decode())[tier] for file, tier in ((words, word_tier), (phones, phone_tier)))
            writer.write(name, split, 'hand', [(sound(source.read(f'examples/files/{wav}.wav')), sentence(lowered(said)), lowered(said), sounds)])
        source.check()
    source = Source(place, 'rPraat')
    if source.there():
        tiers = grid(source.read('inst/extdata/H.TextGrid').decode())
        writer.write('H', 'test', 'hand', [(sound(source.read('tests/testthat/H.wav')), tiers['phrase'][0][2] + '.', tiers['word'], tiers['phone'])], 'cs')
        source.check()


class Arrays(pickle.Unpickler):
    """Reads arrays only: a pickle could otherwise run code."""

    def find_class(self, module, name):
        if module.startswith('numpy') and name in ('_reconstruct', 'ndarray', 'dtype', 'scalar', '_frombuffer'):
            return super().find_class(module.replace('numpy._core', 'numpy.core'), name)
        raise pickle.UnpicklingError(f'{module}.{name}')


def arrays(data):
    return Arrays(io.BytesIO(data)).load()


def by_others(place, writer):
    source = Source(place, 'Python-EMA-Viewer')
    if source.there():
        for name, split in (('F01', 'dev'), ('M01', 'test')):
            data = scipy.io.loadmat(io.BytesIO(source.read(f'example/{name}_B01_S01_R01_N.mat')), struct_as_record=False, squeeze_me=True)
            voice = next(value for key, value in data.items() if key[0] != '_')[0]
            words, phones = ([(x.OFFS[0], x.OFFS[1], x.LABEL) for x in list_ if x.LABEL != 'sp'] for list_ in (voice.WORDS, voice.PHONES))
            writer.write(name, split, 'corpus', [(scaled(voice.SIGNAL, voice.SRATE), str(voice.SENTENCE), lowered(words), phones)])
        voice = arrays(source.read('test/M04_B02_S44_R01_N.pkl'))
        voice = voice['AUDIO'] if 'AUDIO' in voice else next(iter(voice.values()))['AUDIO']
        words, phones = ([(at[0], at[1], label) for label, at in zip(voice[key]['LABEL'], voice[key]['OFFS']) if label != 'sp'] for key in ('WORDS', 'PHONES'))
        writer.write('M04', 'test', 'corpus', [(scaled(voice['SIGNAL'], voice['SRATE']), voice['SENTENCE'], lowered(words), phones)])
        source.check()
    source = Source(place, 'AutoVOT')
    if source.there():
        some = []
        for name in source.list('experiments/data/tutorialExample', '.wav')[::4][:48]:
            tiers = grid(source.read(f'{name[:-4]}.TextGrid').decode())
            some.append((sound(source.read(name)), sentence(lowered(tiers['words'])), lowered(tiers['words']), tiers['phones']))
        writer.write('cas7D', 'test', 'corpus', some)
        source.check()


def russian(writer):
    if not os.path.isdir(RUSSIAN):
        return
    with open(f'{RUSSIAN}/etc/txt.done.data', encoding='utf-8') as file:
        texts = dict(re.findall(r'\( (ru_\d+) "(.*)" \)', file.read()))
    keys = sorted(key for key in texts if os.path.exists(f'{RUSSIAN}/lab/{key}.lab'))
    for part in range(3):
        some = []
        for key in keys[20 * part : 20 * part + 20]:
            phones, at = [], 0.0
            with open(f'{RUSSIAN}/lab/{key}.lab', encoding='utf-8') as file:
                rows = [line.split() for line in file.read().split('#', 1)[1].split('\n')]
            for end, _, name in (row for row in rows if len(row) == 3):
                if name != 'pau':
                    phones.append((at, float(end), name))
                at = float(end)
            with open(f'{RUSSIAN}/wav/{key}.wav', 'rb') as file:
                some.append((sound(file.read()), texts[key].replace('+', ''), [], phones))
        writer.write(f'ru{part}', 'dev', 'corpus', some, 'ru', 'ru')


def words_of(text):
    return re.findall(r"[a-z']+", text.lower())


def by_pocketsphinx(sentences):
    """Forced alignment of [(samples, text)]; leaves out those with words that the dictionary lacks."""
    with open(f'{ENGLISH}/cmudict-en-us.dict', encoding='utf-8') as file:
        known = {line.split()[0] for line in file}
    sentences = [(samples, text) for samples, text in sentences if words_of(text) and all(word in known for word in words_of(text))]
    silence, found = np.zeros(RATE // 10, np.int16), []
    with tempfile.TemporaryDirectory() as folder:
        for i, (samples, text) in enumerate(sentences):
            words = words_of(text)
            np.concatenate([silence, samples]).tofile(f'{folder}/u{i}.raw')
            with open(f'{folder}/u{i}.fsg', 'w', encoding='utf-8') as file:
                file.write(f'FSG_BEGIN u{i}\nNUM_STATES {len(words) + 1}\nSTART_STATE 0\nFINAL_STATE {len(words)}\n')
                file.write(''.join(f'TRANSITION {k} {k + 1} 1.0 {word}\n' for k, word in enumerate(words)) + 'FSG_END\n')
        with open(f'{folder}/ctl', 'w', encoding='utf-8') as file:
            file.write(''.join(f'u{i}\n' for i in range(len(sentences))))
        options = {'hmm': f'{ENGLISH}/en-us', 'dict': f'{ENGLISH}/cmudict-en-us.dict', 'ctl': f'{folder}/ctl', 'cepdir': folder, 'cepext': '.raw', 'adcin': 'yes',
                   'fsgctl': f'{folder}/ctl', 'fsgdir': folder, 'fsgext': '.fsg', 'hypseg': f'{folder}/seg', 'beam': '1e-100', 'wbeam': '1e-80', 'pbeam': '1e-100',
                   'remove_silence': 'no', 'logfn': '/dev/null'}  # fmt: skip
        subprocess.run(['pocketsphinx_batch', *(part for key, value in options.items() for part in (f'-{key}', value))], check=True, stdout=subprocess.DEVNULL)
        with open(f'{folder}/seg', encoding='utf-8') as file:
            lines = file.read().strip().split('\n')
    for line in lines:
        samples, text = sentences[int(line[1 : line.index(' ')])]
        parts = re.split(r' L -?\d+ ', line)[1].split()
        starts, names, last = [int(x) for x in parts[0:-1:4]], parts[3::4], int(parts[-1])
        rows = [(start / 100 - 0.1, end / 100 - 0.1, re.sub(r'\(\d+\)$', '', name)) for start, end, name in zip(starts, [*starts[1:], last], names) if name[0] not in '<[+']
        if [word for _, _, word in rows] == words_of(text):
            found.append((samples, text, rows, []))
    return found


def json_of(data):
    return json.loads(re.sub(r',\s*([}\]])', r'\1', data.decode()))


def by_recogniser(place, writer):
    source = Source(place, 'speechbrain')
    if source.there():
        about = json_of(source.read('tests/samples/annotation/ASR_train.json')) | json_of(source.read('tests/samples/annotation/ASR_dev.json'))
        for person, split in (('spk1', 'dev'), ('spk2', 'test')):
            some = [(sound(source.read(f'tests/samples/ASR/{key}.wav')), about[key]['wrd'].capitalize() + '.') for key in sorted(about) if key.startswith(f'{person}_snt')]
            writer.write(person, split, 'pocketsphinx', by_pocketsphinx(some))
        source.check()
    source = Source(place, 'charsiu')
    if source.there():
        some = [(sound(source.read('local/SA1.WAV'), 'sph'), 'She had your dark suit in greasy wash water all year.')]
        writer.write('sa1', 'test', 'pocketsphinx', by_pocketsphinx(some))
        source.check()
    if os.path.isdir(READER):
        some = []
        with open(f'{READER}/transcription', encoding='utf-8') as file:
            for text, name in re.findall(r'<s> (.*?) </s> \((\S+)\)', file.read()):
                with open(f'{READER}/{name}.wav', 'rb') as wav:
                    some.append((sound(wav.read()), text.strip().capitalize() + '.'))
        writer.write('austen', 'dev', 'pocketsphinx', by_pocketsphinx(some))
    if os.path.isdir(PROMPTS):
        some = []
        with gzip.open('/usr/share/doc/asterisk-core-sounds-en/core-sounds-en.txt.gz', 'rt', errors='replace') as file:
            for name, text in re.findall(r'^([\w/-]+):\s+(.*\S)\s*$', file.read(), re.M):
                path = f'{PROMPTS}/{name}.g722'
                if not re.search(r'[\[\](){}<>*#/0-9]|: |\.\.', text) and len(text.split()) >= 4 and os.path.exists(path):
                    raw = subprocess.run(['ffmpeg', '-v', 'quiet', '-f', 'g722', '-i', path, '-ar', str(RATE), '-ac', '1', '-f', 's16le', '-'], capture_output=True, check=True)
                    some.append((np.frombuffer(raw.stdout, np.int16), text))
        writer.write('allison', 'dev', 'pocketsphinx', by_pocketsphinx(some)[:25])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('place')
    parser.add_argument('out')
    args = parser.parse_args()
    writer = Writer(args.out)
    by_hand(args.place, writer)
    by_others(args.place, writer)
    russian(writer)
    by_recogniser(args.place, writer)


main()
