# SPDX-License-Identifier: MIT
"""Prints the C tables of FAPC from fapc-prior.json. Usage: make-fapc-table.py fapc-prior.json > fapc_prior.c"""
import json
import sys

prior = json.load(open(sys.argv[1]))


def braces(values):
    return "{" + ", ".join(str(v) for v in values) + "}"


print('#include "protocol/fapc/fapc_model.h"\n\nconst struct fapc_habit fapc_habits[FAP_COUNT + 1] = {')
for fap in prior["faps"]:
    models = (fap["models"] + [0, 0])[:2]
    print(f'    [{fap["number"]}] = {{{fap["group"]}, {fap["eighths"]}, {braces(models)}, {braces(fap["weights"])}, '
          f'{braces(fap["exact"])}}},')
print("};")
for name, width in (("zero", "FAPC_ZEROS"), ("sign", "FAPC_SIGNS"), ("size", "FAPC_CLASSES * FAPC_UNARY")):
    print(f"\nconst uint16_t fapc_prior_{name}[FAPC_GROUPS][{width}] = {{")
    for row in prior[name]:
        print(f"    {braces(row)},")
    print("};")
