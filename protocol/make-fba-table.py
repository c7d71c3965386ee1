# SPDX-License-Identifier: MIT
"""Prints the C tables of FBA from fba-prior.json. Usage: make-fba-table.py fba-prior.json > fba_prior.c"""
import json
import sys

prior = json.load(open(sys.argv[1]))


def braces(values):
    return "{" + ", ".join(str(v) for v in values) + "}"


print('#include "protocol/fba_model.h"\n\nconst struct fba_habit fba_habits[FAP_COUNT + 1] = {')
for fap in prior["faps"]:
    models = (fap["models"] + [0, 0])[:2]
    print(f'    [{fap["number"]}] = {{{fap["group"]}, {fap["eighths"]}, {braces(models)}, {braces(fap["weights"])}, '
          f'{braces(fap["exact"])}}},')
print("};")
for name, width in (("zero", "FBA_ZEROS"), ("sign", "FBA_SIGNS"), ("size", "FBA_CLASSES * FBA_UNARY")):
    print(f"\nconst uint16_t fba_prior_{name}[FBA_GROUPS][{width}] = {{")
    for row in prior[name]:
        print(f"    {braces(row)},")
    print("};")
