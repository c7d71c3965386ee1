# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the C table of viseme ids from models/shapes/viseme-ids.json. Usage: make-viseme-ids.py viseme-ids.json > viseme_id_table.c"""
import json
import sys

ids = json.load(open(sys.argv[1], encoding="utf-8"))["ids"]
print('#include "server/face/packs/shape_table.h"\n\nconst struct viseme_id viseme_ids[] = {')
for row in ids:
    for phone in row["phones"]:
        print(f'    {{{json.dumps(phone, ensure_ascii=False)}, {row["id"]}}},')
print("    {0},\n};")
