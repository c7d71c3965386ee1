#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes what programs and people read of the client's messages, from their declaration, messages.json.

make-messages.py speak-fields|client-messages|say-options  prints a header for the build
make-messages.py --write                                   writes the files that are kept in the repository
make-messages.py --check                                   says which of those are not what it would write; exit status 1
With --root FOLDER... the files are those of other copies of the repository.
"""
import json
import os
import re
import sys
import textwrap

# ISO language tags, and the locales of POSIX: what lang_read of server/base/lang.c takes.
TAG = (r'^(?:[A-Za-z]{2,8}(?:-[A-Za-z0-9]{1,8})*|[xXiI](?:-[A-Za-z0-9]{1,8})+|[A-Za-z]{2,3}_[A-Za-z0-9]{2})'
       r'(?:\.[A-Za-z0-9-]+(?:@[A-Za-z0-9-]+)?|@[A-Za-z0-9-]+)?$')
MADE = 'Made by protocol/make-messages.py from protocol/messages.json: change that.'
TYPES = ('text', 'string', 'tag', 'number', 'integer', 'flag', 'choice', 'structure')


class Declaration:
    """The messages with their members, in which `like` stands no more."""

    def __init__(self, root):
        with open(os.path.join(root, 'protocol/messages.json'), encoding='utf-8') as file:
            whole = json.load(file)
        self.defs = whole['defs']
        self.messages = whole['messages']
        for name, message in self.messages.items():
            message['members'] = {member: self._resolved(name, member, whole) for member in message['members']}
        self.speak = self.messages['speak']['members']

    def _resolved(self, message, name, whole):
        member = whole['messages'][message]['members'][name]
        if 'like' in member:
            other, of = member['like'].split('.')
            base = {key: value for key, value in self._resolved(other, of, whole).items() if key != 'required'}
            if 'otherwise' in member:
                base.pop('default', None)
            member = {**base, **member}
        if member['type'] not in TYPES:
            raise SystemExit(f'messages.json: {message}.{name}: no type {member["type"]}')
        return member


def words_of(member):
    """What the member may be, where that is a list."""
    return list(member.get('words') or member.get('values') or [])


def constant(word):
    """The word as the end of a constant's name in C."""
    return word.upper().replace('-', '_')


def described(member):
    """The member in a sentence or two, for the schemas."""
    parts = [member['summary']]
    if isinstance(member.get('words'), dict):
        parts.append('; '.join(f'{word}: {means}' for word, means in member['words'].items()) + '.')
    if member['type'] == 'string' and 'max' in member and 'values' not in member and 'pattern' not in member:
        parts.append(f'At most {member["max"]} bytes.')
    if 'otherwise' in member:
        parts.append(f'When left out: {member["otherwise"]}.')
    return ' '.join(parts)


def schema_of(member, description=True):
    """The member as JSON Schema."""
    kind = member['type']
    schema = {}
    if words_of(member):
        schema['enum'] = words_of(member)
    elif kind in ('text', 'string', 'tag'):
        schema['type'] = 'string'
        if member.get('min'):
            schema['minLength'] = member['min']
        if 'max' in member:
            schema['maxLength'] = member['max']
        if kind == 'tag' or 'pattern' in member:
            schema['pattern'] = TAG if kind == 'tag' else member['pattern']
    elif kind in ('number', 'integer'):
        schema['type'] = kind
        schema['minimum'] = member['min']
        schema['maximum'] = member['max']
    elif kind == 'flag':
        schema['type'] = 'boolean'
    else:
        schema.update(member['schema'])
    if 'default' in member:
        schema['default'] = member['default']
    if description:
        schema['description'] = described(member)
    return schema


# What is kept in the repository.

def flowed(value, indent=0, width=140):
    """JSON in which what fits into a line stands in one."""
    line = json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict) and value:
        line = '{ ' + ', '.join(f'{json.dumps(k, ensure_ascii=False)}: {flowed(v, 0, 10 ** 9)}' for k, v in value.items()) + ' }'
    elif isinstance(value, list):
        line = '[' + ', '.join(flowed(v, 0, 10 ** 9) for v in value) + ']'
    if len(line) + indent <= width or not isinstance(value, (dict, list)):
        return line
    inside = ' ' * (indent + 2)
    if isinstance(value, list):
        rows = [flowed(v, indent + 2, width) for v in value]
        return '[\n' + ',\n'.join(inside + row for row in rows) + '\n' + ' ' * indent + ']'
    rows = [f'{json.dumps(k, ensure_ascii=False)}: {flowed(v, indent + 2, width)}' for k, v in value.items()]
    return '{\n' + ',\n'.join(inside + row for row in rows) + '\n' + ' ' * indent + '}'


def client_schema(declared, _):
    defs = {}
    for name, message in declared.messages.items():
        one = {'description': message['summary']}
        required = [member for member, about in message['members'].items() if about.get('required')]
        if required:
            one['required'] = required
        one['properties'] = {'type': {'const': name}, **{m: schema_of(about) for m, about in message['members'].items()}}
        defs[name] = {**one, **message.get('schema', {})}
    whole = {
        '$schema': 'https://json-schema.org/draft/2020-12/schema',
        '$id': 'faccia/client.json',
        '$comment': MADE,
        'title': 'A message of the client',
        'description': 'messages.md. The server ignores members that it does not know.',
        'type': 'object',
        'required': ['type'],
        'properties': {'type': {'enum': list(declared.messages)}},
        'allOf': [{'if': {'properties': {'type': {'const': name}}}, 'then': {'$ref': f'#/$defs/{name}'}} for name in declared.messages],
        '$defs': {**defs, **declared.defs},
    }
    return flowed(whole) + '\n'


def indented(document):
    return json.dumps(document, indent=2, ensure_ascii=False) + '\n'


def referred(names):
    return [{'$ref': f'#/components/parameters/{name}'} for name in names]


def openapi(declared, text):
    """The parameters and bodies that have members of speak or play; all else stays as it is."""
    document = json.loads(text)
    said = [name for name, member in declared.speak.items() if name != 'text' and not member.get('once')]
    alone = [name for name in said if not declared.speak[name].get('stream')]
    parameters = {name: about for name, about in document['components']['parameters'].items() if name not in said}
    for name in said:
        member = declared.speak[name]
        parameters[name] = {'name': name, 'in': 'query', 'description': described(member), 'schema': schema_of(member, False)}
    document['components']['parameters'] = parameters
    playing = [name for name in declared.messages['play']['members'] if name in said]
    for path, method, names in (('/v1/speech', 'get', alone), ('/v1/speech', 'post', alone), ('/v1/say', 'post', said), ('/v1/play', 'post', playing)):
        operation = document['paths'][path][method]
        members = [{'$ref': f'#/components/parameters/{name}'} for name in declared.speak]
        operation['parameters'] = [one for one in operation['parameters'] if one not in members] + referred(names)
    schemas = document['components']['schemas']
    for body, names in (('speech', alone), ('say', said)):
        own = {name: about for name, about in schemas[body]['properties'].items() if name not in declared.speak}
        schemas[body]['properties'] = {'text': schema_of(declared.speak['text']), **own, **{name: schema_of(declared.speak[name]) for name in names}}
    return indented(document)


def asyncapi(declared, text):
    """The client's messages and the members of the address; all else stays as it is."""
    document = json.loads(text)
    channel = document['channels']['stream']
    components = document['components']
    kept = {key: value for key, value in components['messages'].items() if not key.startswith('client.') or key == 'client.sound'}
    made = {}
    for name, message in declared.messages.items():
        right = message.get('right')
        made[f'client.{name}'] = {
            'name': name,
            'summary': message['summary'],
            **({'description': f'Needs the right to {right}.'} if right else {}),
            'contentType': 'application/json',
            'payload': {'schemaFormat': 'application/schema+json;version=draft-2020-12', 'schema': {'$ref': f'schema/client.json#/$defs/{name}'}},
        }
    components['messages'] = {**made, **kept}
    own = [key for key in components['messages'] if key.startswith('client.')]
    others = [key for key in components['messages'] if not key.startswith('client.')]
    channel['messages'] = {key: {'$ref': f'#/components/messages/{key}'} for key in own + others}
    document['operations']['hear']['messages'] = [{'$ref': f'#/channels/stream/messages/{key}'} for key in own]
    media = declared.messages['media']['members']
    join = declared.messages['join']['members']
    query = {name: schema_of(join[name]) for name in ('room', 'watch')}
    query.update({name: schema_of(media[name]) for name in ('audio', 'fap', 'kilobits', 'events')})
    query.update({name: about for name, about in channel['bindings']['ws']['query']['properties'].items() if name in ('token', 'key')})
    query.update({name: schema_of(member) for name, member in declared.speak.items() if name != 'text' and not member.get('once')})
    channel['bindings']['ws']['query']['properties'] = query
    return indented(document)


def region(text, name, lines, comment='//'):
    """Puts the lines between those that name the region."""
    begin, end = f'{comment} <{name}: made by protocol/make-messages.py>', f'{comment} </{name}>'
    pattern = re.compile(rf'(^ *){re.escape(begin)}\n.*?^ *{re.escape(end)}$', re.M | re.S)
    if len(pattern.findall(text)) != 1:
        raise SystemExit(f'no region <{name}>')
    return pattern.sub(lambda found: '\n'.join(found[1] + line for line in [begin, *lines, end]), text)


def typescript(member):
    if words_of(member):
        return ' | '.join(json.dumps(word).replace('"', "'") for word in words_of(member))
    return {'text': 'string', 'string': 'string', 'tag': 'string', 'number': 'number', 'integer': 'number', 'flag': 'boolean'}[member['type']]


def options_of(members, left_out):
    lines = []
    for name, member in members.items():
        if name not in left_out:
            lines += [f'/** {described(member)} */', f'{name}?: {typescript(member)};']
    return lines


def attributes_of(declared):
    """By the attribute's name: the member's, unless every element of a page has that already, as `normalize`, a method of nodes."""
    return {attribute if (attribute := member['attribute']) is not True else name: {**member, 'name': name}
            for name, member in declared.speak.items() if 'attribute' in member}


def element_types(declared, text):
    text = region(text, 'speak options', options_of(declared.speak, ['text', 'open']))
    text = region(text, 'voice options', options_of(declared.messages['voice']['members'], ['codec', 'rate', 'channels']))
    attributes, properties = [], []
    for name, member in attributes_of(declared).items():
        kind = 'number | string' if member['type'] in ('number', 'integer') else typescript(member)
        attributes.append(f'{name}?: {kind}' + ('' if name == 'lang' else ' | null') + ';')
        if name != 'lang':  # every element of a page has that
            properties.append(f'{name}: {typescript(member)} | null;')
    return region(region(text, 'speak attributes', attributes), 'speak properties', properties)


def element_attributes(declared, _):
    rows = [f"  {name}: {{ member: '{member['name']}', type: {'Number' if member['type'] in ('number', 'integer') else 'String'} }},"
            for name, member in attributes_of(declared).items()]
    return '\n'.join(['// SPDX-License-Identifier: MIT', f'// {MADE}', '', '/** Attributes that are defaults of `speak`: the member each stands for, and what its text is. */',
                      'export const SPEAK_ATTRIBUTES = {', *rows, '};', ''])


def inline(text, pattern, names):
    """Replaces the one list of names that the pattern's first group finds."""
    listed = ', '.join(f'`{name}`' for name in names)
    found = re.findall(pattern, text, re.M)
    if len(found) != 1:
        raise SystemExit(f'{pattern}: found {len(found)} times')
    return re.sub(pattern, lambda match: match[0].replace(match[1], listed, 1), text, flags=re.M)


def element_readme(declared, text):
    text = inline(text, r'^\| (.*?) \| defaults for `speak`;', attributes_of(declared))
    return inline(text, r'`options`: members of the \[`speak` message\]\([^)]*\) \((.*?)\)', [n for n in declared.speak if n not in ('text', 'open')])


def kind_of(member):
    """The type and range, for people."""
    kind = member['type']
    low, high = member.get('min'), member.get('max')
    if words_of(member):
        return ', '.join(f'`{word}`' for word in words_of(member))
    if kind == 'string' or kind == 'tag':
        told = 'language tag' if kind == 'tag' else 'string'
        if high is None:
            return told + (f', at least {low} byte' if low else '')
        return f'{told}, {low} to {high} bytes' if low else f'{told}, at most {high} bytes'
    if kind in ('number', 'integer'):
        return f'{kind}, {low:g} to {high}' if kind == 'number' else f'integer, {low} to {high}'
    return {'text': 'string', 'flag': 'true or false', 'structure': {'array': 'list', 'object': 'object'}.get(member.get('schema', {}).get('type'), 'any')}[kind]


def otherwise_of(member):
    if member.get('required'):
        return 'required'
    if 'otherwise' in member:
        return member['otherwise']
    return f'`{json.dumps(member["default"])}`'.replace('"', '') if 'default' in member else ''


def reference(declared, _):
    out = ['<!-- SPDX-License-Identifier: MIT -->', f'<!-- {MADE} -->', '# Messages of the client', '',
           'What a client may send on a stream ([README.md](README.md) tells what it means), with the right that it needs where there are tokens. Members of `speak`',
           'are parameters of `/v1/speech` and `/v1/say`, too, and of the address of a stream; of `faccia say` those with an option. Strings are counted in bytes of',
           'UTF-8. A member that breaks its type or range is a `bad-field`, a required one that is missing a `missing-field`, both with the member as `field`.', '']
    for name, message in declared.messages.items():
        right = message.get('right')
        out += [f'## {name}', '', message['summary'] + (f' Needs the right to `{right}`.' if right else ''), '']
        if not message['members']:
            out += ['No members.', '']
            continue
        out += ['| member | type | when left out | |', '|---|---|---|---|']
        for member, about in message['members'].items():
            says = about['summary']
            if isinstance(about.get('words'), dict):
                says += ' ' + '; '.join(f'`{word}`: {means}' for word, means in about['words'].items()) + '.'
            if 'see' in about:
                says += f' See [there]({about["see"]}).'
            if name == 'speak' and 'option' in about:
                says += f' Option `--{member}`.'
            if about.get('stream') and name == 'speak':
                says += ' On a stream or in a room only.'
            out.append(f'| `{member}` | {kind_of(about)} | {otherwise_of(about)} | {says} |')
        out.append('')
    return '\n'.join(out)


def python_client(declared, text):
    lines = textwrap.wrap(' '.join(declared.messages), 116, break_long_words=False)
    body = ['CLIENT_MESSAGES = frozenset('] + [f'    "{line}{"" if line is lines[-1] else " "}"' for line in lines]
    body[-1] += '.split()'
    return region(text, 'client messages', body + [')'], '#')


KEPT = {
    'protocol/schema/client.json': client_schema,
    'protocol/openapi.json': openapi,
    'protocol/asyncapi.json': asyncapi,
    'protocol/messages.md': reference,
    'web/src/talking-head.d.ts': element_types,
    'web/src/speak-attributes.mjs': element_attributes,
    'web/docs/element/reference.md': element_readme,
    'web/client/python/faccia.py': python_client,
}


def keep(root, write):
    declared = Declaration(root)
    wrong = []
    for name, make in KEPT.items():
        path = os.path.join(root, name)
        text = ''
        if os.path.exists(path):
            with open(path, encoding='utf-8') as file:
                text = file.read()
        made = make(declared, text)
        if made != text:
            wrong.append(name)
            if write:
                with open(path, 'w', encoding='utf-8') as file:
                    file.write(made)
    return wrong


# What is made while building.

def number(value):
    return repr(value) if isinstance(value, int) and abs(value) < 2 ** 31 else f'{float(value)!r}'


def row(name, member, words):
    kind = member['type'].upper()
    bounds = {'min': min(member['values']), 'max': max(member['values'])} if kind == 'INTEGER' and 'values' in member else member
    low = number(bounds.get('min', 0))
    high = number(bounds['max']) if 'max' in bounds else 'INFINITY'
    if member['type'] in ('flag', 'choice', 'text'):
        low = high = '0'
    return name, kind, low, high, words


def words_rows(name, member):
    prefix = member.get('c')
    listed = [f'[{prefix}{constant(word)}] = "{word}"' if prefix else f'"{word}"' for word in words_of(member)]
    return f'static const char *const {name}[] = {{{", ".join(listed)}, NULL}};'


def speak_fields(declared):
    """Rows of the fields of struct speech_request: FIELD(name, type, least, most, words)."""
    out = [f'/* {MADE} */']
    rows, initial = [], []
    for name, member in declared.speak.items():
        words = 'NULL'
        if member['type'] == 'choice':
            words = f'speak_{name}_words'
            out.append(words_rows(words, member))
            if words_of(member)[0] != member['default']:
                initial.append(f'.{name} = {member["c"]}{constant(member["default"])}')
        elif member['type'] in ('number', 'integer') and member.get('unset', member.get('default', 0)):
            initial.append(f'.{name} = {member.get("unset", member.get("default", 0))}')
        rows.append('    FIELD({}, {}, {}, {}, {})'.format(*row(name, member, words)))
    out.append('#define SPEAK_FIELDS(FIELD) \\\n' + ' \\\n'.join(rows))
    out.append('/* What is not given. */\n#define SPEAK_INITIAL ' + ', '.join(initial))
    return '\n'.join(out) + '\n'


def client_messages(declared):
    """Tables of the messages, of their own fields, and of those that they share with speak."""
    out = [f'/* {MADE} */']
    rows = []
    for name, message in declared.messages.items():
        fields, shared = [], []
        for member, about in message['members'].items():
            if name == 'speak' or about.get('like') == f'speak.{member}':
                shared.append(f'"{member}"')
                continue
            if about['type'] == 'structure':
                continue  # what reads it checks it
            words = 'NULL'
            if about['type'] == 'choice':
                words = f'{name}_{member}_words'
                out.append(words_rows(words, {**about, 'c': None}))
            _, kind, low, high, words = row(member, about, words)
            fields.append(f'    {{"{member}", FIELD_{kind}, {low}, {high}, {words}, {"true" if about.get("required") else "false"}}},')
        if fields:
            out += [f'static const struct field {name}_fields[] = {{', *fields, '};']
        if shared and name != 'speak':
            out.append(f'static const char *const {name}_shared[] = {{{", ".join(shared)}, NULL}};')
        if fields or (shared and name != 'speak'):
            rows.append(f'    {{"{name}", {f"{name}_fields, {len(fields)}" if fields else "NULL, 0"}, {f"{name}_shared" if shared else "NULL"}}},')
    out += ['/* Messages with members; speak is read by struct speech_request alone. */', 'static const struct client_message client_messages[] = {', *rows, '};']
    return '\n'.join(out) + '\n'


def help_of(name, member):
    option = member['option']
    value = '' if member['type'] == 'flag' else ' ' + (option.get('value') or '|'.join(words_of(member)))
    left = ('  -{}, '.format(option['letter']) if 'letter' in option else ' ' * 6) + f'--{name}{value}'
    lines = textwrap.wrap(option['summary'], 76)
    first = f'{left:<21}  {lines[0]}' if len(left) <= 21 else None
    return ([first] if first else [left, ' ' * 23 + lines[0]]) + [' ' * 23 + line for line in lines[1:]]


def say_options(declared):
    """Help and options of faccia say: SPEAK_HELP_name, SPEAK_HELP of all, SPEAK_OPTIONS for getopt_long."""
    out = [f'/* {MADE} */']
    having = {name: member for name, member in declared.speak.items() if 'option' in member}
    for name, member in having.items():
        lines = [json.dumps(line + '\n', ensure_ascii=False) for line in help_of(name, member)]
        out.append(f'#define SPEAK_HELP_{name.upper()} ' + ' \\\n    '.join(lines))
    out.append('#define SPEAK_HELP ' + ' \\\n    '.join(f'SPEAK_HELP_{name.upper()}' for name in having))
    rows = []
    for name, member in having.items():
        letter = member['option'].get('letter')
        rows.append(f'    {{"{name}", {0 if member["type"] == "flag" else 1}, NULL, {letter and chr(39) + letter + chr(39) or 1}}},')
    out.append('/* An option without a letter has the value 1. */\n#define SPEAK_OPTIONS \\\n' + ' \\\n'.join(rows))
    out.append('#define SPEAK_LETTERS "' + ''.join(m['option']['letter'] + ':' for m in having.values() if 'letter' in m['option']) + '"')
    return '\n'.join(out) + '\n'


BUILT = {'speak-fields': speak_fields, 'client-messages': client_messages, 'say-options': say_options}


def main(words):
    roots = [os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))]
    if '--root' in words:
        at = words.index('--root')
        roots = words[at + 1:]
        del words[at:]
    if len(words) == 1 and words[0] in BUILT:
        sys.stdout.write(BUILT[words[0]](Declaration(roots[0])))
        return 0
    if words not in (['--write'], ['--check']):
        sys.stderr.write(__doc__)
        return 2
    write = words == ['--write']
    wrong = [os.path.join(root, name) for root in roots for name in keep(root, write)]
    for name in wrong:
        print(f'{name} {"written" if write else "is not what messages.json says: protocol/make-messages.py --write"}')
    return 1 if wrong and not write else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
