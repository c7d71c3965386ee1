# SPDX-License-Identifier: MIT
"""Prints the C table of the FAPs from fap-table.json. Usage: make-fap-table.py fap-table.json > fap_table.c"""
import json
import sys

faps = json.load(open(sys.argv[1]))["faps"]
print('#include "protocol/fap.h"\n\nconst struct fap_info fap_table[FAP_COUNT + 1] = {')
for fap in faps:
    print(
        f'    [{fap["number"]}] = {{"{fap["name"]}", "{fap["direction"]}", "{fap["fdp"]}", {fap["group"]}, '
        f'FAP_UNIT_{fap["unit"]}, {str(fap["bidirectional"]).lower()}, {fap["quant_step"]}, '
        f'{fap["min"]}, {fap["max"]}, {fap["i_steps"]}, {fap["p_steps"]}}},'
    )
print("};")
