#!/usr/bin/env python3
"""Writes compile_commands.json, which editors and clangd read, from the commands of `make -nB V=1`
on stdin.

usage: make -nB V=1 build test-build | tests/compile_commands.py >build/compile_commands.json
"""
import json
import os
import shlex
import sys

entries = []
for line in sys.stdin:
    if " -c -o " in line:
        words = shlex.split(line)
        place = words.index("-o")
        entries.append({"directory": os.getcwd(), "file": words[place + 2], "output": words[place + 1], "arguments": words})
json.dump(entries, sys.stdout, indent=1)
