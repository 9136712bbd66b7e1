#!/usr/bin/env python3
"""Prints the man page geodesic(1). Commands and options come from the program's --help.

usage: clients/cli/manual.py PROGRAM
"""
import os
import re
import subprocess
import sys

ITEM = re.compile(r"^  (\S.*?)(?:  +(\S.*))?$")

BEFORE = r""".TH GEODESIC 1 "" "geodesicd {version}" "User commands"
.SH NAME
geodesic \- query exact geodesics on surfaces from a geodesicd daemon
.SH SYNOPSIS
.B geodesic
[\fB\-\-url\fR \fIURL\fR] [\fB\-\-key\fR \fIKEY\fR] \fICOMMAND\fR ...
.SH DESCRIPTION
.B geodesic
uploads meshes to a
.BR geodesicd (8)
daemon and queries distances, shortest paths and the other operations of the daemon.
.PP
A point is a vertex
.RB ( 12 " or " v:12 ),
a point of an edge
.RB ( e:3\-9:0.25 )
or of a face
.RB ( f:34:0.2,0.3,0.5 ),
or the point of the surface that is nearest to a point in space
.RB ( p:1,2,3 ).
"""

AFTER = r""".SH ENVIRONMENT
.TP
.BR GEODESICD_URL ", " GEODESICD_KEY
The address of the daemon, and the access key.
.SH EXAMPLES
.EX
geodesic upload bunny.obj
geodesic distance bunny v:12 p:0.01,0.12,0.03
geodesic field bunny v:12 >distances.csv
.EE
.SH SEE ALSO
.BR geodesicd (8)
"""


def escape(text):
    return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")


def told(program, *arguments):
    """Runs the program and returns its output, with lines of any length."""
    return subprocess.run([program, *arguments], check=True, stdout=subprocess.PIPE, text=True, env=dict(os.environ, COLUMNS="1000")).stdout


def items(text):
    """Returns the pairs (name, explanation) of a help text. An explanation may be on the line after
    its name."""
    return [match.groups("") for line in re.sub(r"\n {10,}", "  ", text).splitlines() if (match := ITEM.match(line.replace("    ", "  ", 1)))]


def sentence(text):
    """Returns the text as a sentence. Capitalises the first word, unless this word is a literal."""
    return escape(re.sub(r"^([a-z]+ |default:)", lambda match: match[1].capitalize(), text)) + "."


def print_items(pairs):
    """Prints the items that have an explanation."""
    for name, text in pairs:
        if text:
            print(f".TP\n.B {escape(name)}\n{sentence(text)}")


def main():
    program = sys.argv[1]
    commands, options = told(program, "--help").split("\noptions:\n")
    print(BEFORE.replace("{version}", told(program, "--version").split()[-1]), end="")
    print(".SH OPTIONS")
    print_items(items(options))
    for name, text in items(commands.partition("COMMAND\n")[2]):
        help_text = told(program, name, "--help")
        usage, _, details = help_text.partition("\n\n")
        print(f".SS {escape(name)}\n.B {escape(usage.removeprefix('usage: '))}\n.PP\n{sentence(text)}")
        print_items(pair for pair in items(details) if not pair[0].startswith("-h"))
    print(AFTER, end="")


if __name__ == "__main__":
    main()
