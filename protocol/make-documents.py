#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# The documents that a daemon serves about itself, as an array in C: make-documents.py OUT NAME=FILE...
import sys

out, *documents = sys.argv[1:]
with open(out, 'w') as c:
    c.write('#include "protocol/documents.h"\n')
    rows = []
    for i, document in enumerate(documents):
        name, file = document.split('=', 1)
        data = open(file, 'rb').read()
        lines = [','.join(str(byte) for byte in data[at:at + 32]) for at in range(0, len(data), 32)]
        c.write('static const unsigned char data%d[] = {\n%s};\n' % (i, ',\n'.join(lines)))
        rows.append('{"%s", data%d, %d}' % (name, i, len(data)))
    c.write('const struct document documents[] = {%s, {0}};\n' % ', '.join(rows))
