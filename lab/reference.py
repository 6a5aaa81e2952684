#!/usr/bin/env python3
"""Prints docs/reference.md from the help of `srbf`: `python3 lab/reference.py > docs/reference.md`, once the program is built."""
import os
import re
import subprocess

SRBF = os.environ.get("CARGO_TARGET_DIR", "target") + "/release/srbf"
WIDTH = 100
HEAD = """# Every option

The help of each command, as `srbf COMMAND --help` prints it. [command-line.md](command-line.md) has the commands by task.
`python3 lab/reference.py > docs/reference.md` makes this page, and `.ci/checks/68-reference` compares it with the program."""


def help_of(*command):
    text = subprocess.run([SRBF, *command, "--help"], check=True, capture_output=True, text=True, env={**os.environ, "COLUMNS": str(WIDTH)}).stdout
    print(f"\n## {' '.join(['srbf', *command])}\n\n```text")
    print("\n".join(line.rstrip() for line in text.rstrip().splitlines()))
    print("```")
    return text


print(HEAD)
commands = help_of().split("\nCommands:\n")[1].split("\n\n")[0]
for command in re.findall(r"^  ([a-z]\S*)", commands, re.MULTILINE):
    if command != "help":
        help_of(command)
