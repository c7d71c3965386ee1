#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes what programs and people read of the messages of clients and of the daemon, from their declaration, messages.json.

make-messages.py speak-fields|client-messages|server-messages|say-options  prints a header for the build
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
TYPES = ('text', 'string', 'tag', 'number', 'integer', 'flag', 'choice', 'structure', 'names', 'constant', 'code')


class Declaration:
    """The messages with their members, in which neither `like` nor `shares` stands any more."""

    def __init__(self, root):
        with open(os.path.join(root, 'protocol/messages.json'), encoding='utf-8') as file:
            whole = json.load(file)
        server = whole['server']
        self.defs = whole['defs']
        self.codes = whole['codes']
        self.shared = server['shared']
        said = {**server['answers'], **server['messages'], **server['shared']}
        of_client = {f'client.{name}': message for name, message in whole['client'].items()}
        self.client = self._resolved(whole['client'], whole['client'])
        self.server = self._resolved(server['messages'], {**said, **of_client})
        self.answers = self._resolved(server['answers'], {**said, **of_client})
        self.speak = self.client['speak']['members']

    def _resolved(self, messages, others):
        resolved = {}
        for name, message in messages.items():
            members = {}
            for shared in message.get('shares', []):
                members.update(self.shared[shared]['members'])
            members.update({member: self._member(f'{name}.{member}', about, others) for member, about in message['members'].items()})
            resolved[name] = {**message, 'members': members}
        return resolved

    def _member(self, place, member, others):
        if 'like' in member:
            other, of = member['like'].rsplit('.', 1)
            base = {key: value for key, value in self._member(member['like'], others[other]['members'][of], others).items() if key != 'required'}
            if 'otherwise' in member:
                base.pop('default', None)
            member = {**base, **member}
        if member['type'] not in TYPES:
            raise SystemExit(f'messages.json: {place}: no type {member["type"]}')
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
        schema.update({of: member[bound] for of, bound in (('minimum', 'min'), ('maximum', 'max')) if bound in member})
    elif kind == 'flag':
        schema['type'] = 'boolean'
    elif kind == 'names':
        schema.update({'type': 'array', 'items': {'type': 'string'}})
    elif kind == 'constant':
        schema['const'] = member['value']
    elif kind == 'code':
        schema['$ref'] = '#/$defs/code'
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


def schema_of_message(name, message, open_ended):
    """A message, or an answer, as JSON Schema. Of the client's further members are passed over, so they are allowed."""
    members = message['members']
    one = {'description': message['summary']}
    required = [member for member, about in members.items() if about.get('required')]
    if not open_ended:
        one['type'] = 'object'
        required = ['type', *required]
    if required:
        one['required'] = required
    one['properties'] = {'type': {'const': name}, **{member: schema_of(about) for member, about in members.items()}}
    if not open_ended:
        one['additionalProperties'] = False
    needs = {member: about['with'] for member, about in members.items() if 'with' in about}
    return {**one, **({'dependentRequired': needs} if needs else {}), **message.get('schema', {})}


def schema_of_side(messages, open_ended, **about):
    return flowed({
        '$schema': 'https://json-schema.org/draft/2020-12/schema',
        '$id': about['id'],
        '$comment': MADE,
        'title': about['title'],
        'description': about['description'],
        'type': 'object',
        'required': ['type'],
        'properties': {'type': {'enum': list(messages)}},
        'allOf': [{'if': {'properties': {'type': {'const': name}}}, 'then': {'$ref': f'#/$defs/{name}'}} for name in messages],
        '$defs': {**{name: schema_of_message(name, message, open_ended) for name, message in messages.items()}, **about['defs']},
    }) + '\n'


def client_schema(declared, _):
    return schema_of_side(declared.client, True, id='faccia/client.json', title='A message of the client', defs=declared.defs,
                          description='messages.md. The server ignores members that it does not know.')


def server_schema(declared, _):
    code = {'type': 'string', 'description': "Stable: README.md, section 'Error codes'. More may come.", 'enum': declared.codes}
    return schema_of_side(declared.server, False, id='faccia/server.json', title='A message of the server', defs={'code': code, **declared.defs},
                          description='messages.md. What this version sends; later ones may add members.')


def indented(document):
    return json.dumps(document, indent=2, ensure_ascii=False) + '\n'


def right_of(message):
    """The right that it needs, as a sentence; the server's messages need none."""
    return '' if message.get('right', 'none') == 'none' else f'{message.get("right_of", "It")} needs the right to `{message["right"]}`.'


def referred(names):
    return [{'$ref': f'#/components/parameters/{name}'} for name in names]


def answers_of(declared):
    """The JSON that a request is answered with, as components of OpenAPI."""
    schemas = {}
    problem = declared.shared['problem']['members']
    for name, answer in declared.answers.items():
        schemas[name] = schema_of_message(name, answer, False)
        schemas[name]['properties']['warnings'] = {'type': 'array', 'items': {'$ref': '#/components/schemas/warning'}, 'description': 'What was passed over.'}
    schemas['warning'] = {
        'type': 'object',
        'required': [name for name, member in problem.items() if member.get('required')],
        'properties': {name: {'type': 'string', 'description': described(member)} if member['type'] == 'code' else schema_of(member) for name, member in problem.items()},
        'additionalProperties': False,
    }
    return schemas


def answered(declared, paths):
    """Has the operations refer to their answers."""
    of = {}
    for name, answer in declared.answers.items():
        for place in answer['of']:
            of.setdefault(place, []).append({'$ref': f'#/components/schemas/{name}'})
    for place, names in of.items():
        method, path, status = place.split(' ')
        paths[path][method]['responses'][status]['content'] = {'application/json': {'schema': names[0] if len(names) == 1 else {'oneOf': names}}}


def openapi(declared, text):
    """The parameters and bodies that have members of speak or play, and the answers; all else stays as it is."""
    document = json.loads(text)
    said = [name for name, member in declared.speak.items() if name != 'text' and not member.get('once')]
    alone = [name for name in said if not declared.speak[name].get('stream')]
    parameters = {name: about for name, about in document['components']['parameters'].items() if name not in said}
    for name in said:
        member = declared.speak[name]
        parameters[name] = {'name': name, 'in': 'query', 'description': described(member), 'schema': schema_of(member, False)}
    document['components']['parameters'] = parameters
    playing = [name for name in declared.client['play']['members'] if name in said]
    for path, method, names in (('/v1/speech', 'get', alone), ('/v1/speech', 'post', alone), ('/v1/coach', 'post', alone), ('/v1/films', 'post', alone), ('/v1/say', 'post', said), ('/v1/play', 'post', playing)):
        operation = document['paths'][path][method]
        members = [{'$ref': f'#/components/parameters/{name}'} for name in declared.speak]
        operation['parameters'] = [one for one in operation['parameters'] if one not in members] + referred(names)
    schemas = document['components']['schemas']
    for body, names in (('speech', alone), ('say', said)):
        own = {name: about for name, about in schemas[body]['properties'].items() if name not in declared.speak}
        schemas[body]['properties'] = {'text': schema_of(declared.speak['text']), **own, **{name: schema_of(declared.speak[name]) for name in names}}
    made = answers_of(declared)
    document['components']['schemas'] = {**{name: about for name, about in schemas.items() if name not in made}, **made}
    answered(declared, document['paths'])
    return indented(document)


def asyncapi(declared, text):
    """The messages and the members of the address; all else stays as it is."""
    document = json.loads(text)
    channel = document['channels']['stream']
    components = document['components']
    sides = {'client': ('hear', declared.client, 'client.sound'), 'server': ('tell', declared.server, 'server.media')}
    messages = {}
    for side, (operation, declarations, binary) in sides.items():
        for name, message in declarations.items():
            messages[f'{side}.{name}'] = {
                'name': name,
                'summary': message['summary'],
                **({'description': right_of(message)} if right_of(message) else {}),
                'contentType': 'application/json',
                'payload': {'schemaFormat': 'application/schema+json;version=draft-2020-12', 'schema': {'$ref': f'schema/{side}.json#/$defs/{name}'}},
            }
        messages[binary] = components['messages'][binary]
        document['operations'][operation]['messages'] = [{'$ref': f'#/channels/stream/messages/{key}'} for key in messages if key.startswith(f'{side}.')]
    components['messages'] = messages
    channel['messages'] = {key: {'$ref': f'#/components/messages/{key}'} for key in messages}
    media = declared.client['media']['members']
    join = declared.client['join']['members']
    query = {name: schema_of(join[name]) for name in ('room', 'watch')}
    query.update({name: schema_of(media[name]) for name in ('audio', 'fap', 'kilobits', 'events')})
    query.update({name: about for name, about in channel['bindings']['ws']['query']['properties'].items() if name in ('token', 'key')})
    query.update({name: schema_of(member) for name, member in declared.speak.items() if name != 'text' and not member.get('once')})
    channel['bindings']['ws']['query']['properties'] = query
    return indented(document)


def region(text, name, lines, comment='//', close=''):
    """Puts the lines between those that name the region."""
    begin, end = f'{comment} <{name}: made by protocol/make-messages.py>{close}', f'{comment} </{name}>{close}'
    pattern = re.compile(rf'(^ *){re.escape(begin)}\n.*?^ *{re.escape(end)}$', re.M | re.S)
    if len(pattern.findall(text)) != 1:
        raise SystemExit(f'no region <{name}>')
    return pattern.sub(lambda found: '\n'.join(found[1] + line for line in [begin, *lines, end]), text)


def typescript(member):
    if words_of(member):
        return ' | '.join(json.dumps(word).replace('"', "'") for word in words_of(member))
    if member['type'] == 'structure':
        return member['ts']
    if member['type'] == 'constant':
        return json.dumps(member['value'])
    return {'text': 'string', 'string': 'string', 'tag': 'string', 'code': 'string', 'names': 'string[]', 'number': 'number', 'integer': 'number', 'flag': 'boolean'}[member['type']]


def options_of(members, left_out):
    lines = []
    for name, member in members.items():
        if name not in left_out:
            lines += [f'/** {described(member)} */', f'{name}?: {typescript(member)};']
    return lines


def capital(name):
    return f'Server{name[0].upper()}{name[1:]}'


def events_of(declared):
    """The server's messages that the element tells the page, as interfaces; and what its events carry."""
    interfaces, events = [], []
    for name, message in declared.server.items():
        if 'event' not in message:
            continue
        interfaces += [f'/** {message["summary"]} */', f'export interface {capital(name)} {{', f"  type: '{name}';"]
        for member, about in message['members'].items():
            there = about.get('required') and not (member == 'stream' and message.get('packed'))  # those that come packed have no stream
            interfaces += [f'  /** {described(about)} */', f'  {member}{"" if there else "?"}: {typescript(about)};']
        interfaces.append('}')
        if message['event'] is True:
            events.append(f'{name}: CustomEvent<{capital(name)}>;')
    return interfaces, events


def attributes_of(declared):
    """By the attribute's name: the member's, unless every element of a page has that already, as `normalize`, a method of nodes."""
    return {attribute if (attribute := member['attribute']) is not True else name: {**member, 'name': name}
            for name, member in declared.speak.items() if 'attribute' in member}


def element_types(declared, text):
    text = region(text, 'speak options', options_of(declared.speak, ['text', 'open']))
    text = region(text, 'voice options', options_of(declared.client['voice']['members'], ['codec', 'rate', 'channels']))
    interfaces, events = events_of(declared)
    text = region(region(text, 'server messages', interfaces), 'server events', events)
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
        if low is None or high is None:
            return kind + (f', at least {low:g}' if low is not None else '')
        return f'{kind}, {low:g} to {high}' if kind == 'number' else f'integer, {low} to {high}'
    if kind == 'constant':
        return f'`{json.dumps(member["value"])}`'
    return {'text': 'string', 'code': 'string', 'names': 'list of strings', 'flag': 'true or false',
            'structure': {'array': 'list', 'object': 'object'}.get(member.get('schema', {}).get('type'), 'any')}[kind]


def otherwise_of(member):
    if member.get('required'):
        return 'required'
    if 'otherwise' in member:
        return member['otherwise']
    return f'`{json.dumps(member["default"])}`'.replace('"', '') if 'default' in member else ''


def says(member):
    text = member['summary']
    if isinstance(member.get('words'), dict):
        text += ' ' + '; '.join(f'`{word}`: {means}' for word, means in member['words'].items()) + '.'
    if 'see' in member:
        text += f' See [there]({member["see"]}).'
    return text


def reference(declared, _):
    out = ['<!-- SPDX-License-Identifier: MIT -->', f'<!-- {MADE} -->', '# Messages', '',
           '[Messages of the client](#messages-of-the-client) · [Messages of the server](#messages-of-the-server). [README.md](README.md) tells what they mean.', '',
           '## Messages of the client', '',
           'What a client may send on a stream, with the right that it needs where there are tokens. Members of `speak` are parameters of `/v1/speech` and `/v1/say`, too, and of the',
           'address of a stream; of `faccia say` those with an option. Strings are counted in bytes of UTF-8. A member that breaks its type or range is a `bad-field`, a required one',
           'that is missing a `missing-field`, both with the member as `field`.', '']
    for name, message in declared.client.items():
        out += [f'### {name}', '', message['summary'] + (f' {right_of(message)}' if right_of(message) else ''), '']
        if not message['members']:
            out += ['No members.', '']
            continue
        out += ['| member | type | when left out | |', '|---|---|---|---|']
        for member, about in message['members'].items():
            text = says(about)
            if name == 'speak' and 'option' in about:
                text += f' Option `--{member}`.'
            if about.get('stream') and name == 'speak':
                text += ' On a stream or in a room only.'
            out.append(f'| `{member}` | {kind_of(about)} | {otherwise_of(about)} | {text} |')
        out.append('')
    out += ['## Messages of the server', '', 'What the daemon sends on a stream, and as server-sent events of a room. A member that is not always there is in some of them only.', '']
    for name, message in declared.server.items():
        out += [f'### server: {name}', '', says(message), '', '| member | type | there | |', '|---|---|---|---|']
        for member, about in message['members'].items():
            there = 'always' if about.get('required') else ''
            out.append(f'| `{member}` | {kind_of(about)} | {there} | {says(about)} |')
        out.append('')
    return '\n'.join(out)


def protocol_readme(declared, text):
    """The list of the server's messages, and the members of hello."""
    rows = ['| `type` | meaning | members |', '|---|---|---|']
    for name, message in declared.server.items():
        about = declared.shared['utterance']['members'] if 'utterance' in message.get('shares', []) else ()
        members = ', '.join(f'`{member}`' for member in message['members'] if member not in about)
        rows.append(f'| [`{name}`](messages.md#server-{name}) | {message["summary"]} | {members} |')
    hello = ['| member | value |', '|---|---|'] + [f'| `{member}` | {says(about).replace("(README.md#", "(#")} |' for member, about in declared.server['hello']['members'].items()]
    return region(region(text, 'server messages', rows, '<!--', ' -->'), 'hello', hello, '<!--', ' -->')


def python_client(declared, text):
    for side, messages in (('client', declared.client), ('server', declared.server)):
        lines = textwrap.wrap(' '.join(messages), 116, break_long_words=False)
        body = [f'{side.upper()}_MESSAGES = frozenset('] + [f'    "{line}{"" if line is lines[-1] else " "}"' for line in lines]
        body[-1] += '.split()'
        text = region(text, f'{side} messages', body + [')'], '#')
    return text


KEPT = {
    'protocol/schema/client.json': client_schema,
    'protocol/schema/server.json': server_schema,
    'protocol/openapi.json': openapi,
    'protocol/asyncapi.json': asyncapi,
    'protocol/messages.md': reference,
    'protocol/README.md': protocol_readme,
    'web/element/talking-head.d.ts': element_types,
    'web/element/speak-attributes.mjs': element_attributes,
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
    for name, message in declared.client.items():
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
    out += ['/* The right that each message needs, 0: none. */', 'static const struct message_right message_rights[] = {',
            *(f'    {{"{name}", {0 if message["right"] == "none" else "RIGHT_" + message["right"].upper()}}},' for name, message in declared.client.items()), '};']
    return '\n'.join(out) + '\n'


def server_messages(declared):
    """What the plain text protocol prints of the server's messages: struct text_line {type, members}."""
    rows = []
    for name, message in declared.server.items():
        printed = [f'"{member}"' for member, about in message['members'].items() if about.get('line')]
        if printed or message.get('line'):
            rows.append(f'    {{"{name}", {{{", ".join([*printed, "NULL"])}}}}},')
    return '\n'.join([f'/* {MADE} */', '#define SERVER_LINES \\', *(row + ' \\' for row in rows[:-1]), rows[-1]]) + '\n'


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


BUILT = {'speak-fields': speak_fields, 'client-messages': client_messages, 'server-messages': server_messages, 'say-options': say_options}


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
