# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the C table of ARKit's shapes from models/shapes/arkit.json. Usage: make-arkit-table.py arkit.json > arkit_table.c"""
import json
import sys

shapes = json.load(open(sys.argv[1], encoding="utf-8"))["shapes"]
print('#include "server/codec/arkit_table.h"\n\nconst struct arkit_shape arkit_table[ARKIT_SHAPES] = {')
for name, shape in shapes.items():
    faps = ", ".join(f"[{fap}] = {value}" for fap, value in shape["faps"].items())
    print(f'    {{"{name}", {str(shape.get("rare", False)).lower()}, {{{faps}}}}},')
print("};")
print(f'_Static_assert({len(shapes)} == ARKIT_SHAPES, "arkit.json");')
for name in ("jawRight", "jawLeft", "jawOpen", "mouthClose", "mouthRight", "mouthLeft", "eyeBlinkLeft", "eyeBlinkRight", "tongueOut"):
    print(f'_Static_assert({list(shapes).index(name)} == ARKIT_{"".join("_" + c if c.isupper() else c.upper() for c in name)}, "arkit.json");')
