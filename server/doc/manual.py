#!/usr/bin/env python3
"""Prints the man page geodesicd(8): its options are those that the program tells of itself.

usage: server/doc/manual.py PROGRAM
"""
import re
import subprocess
import sys

OPTION = re.compile(r"^  (--\S+)(?: (\S+))? +(\S.*)$", re.MULTILINE)

BEFORE = r""".TH GEODESICD 8 "" "geodesicd {version}" "System administration"
.SH NAME
geodesicd \- exact geodesics on surfaces, as a network service
.SH SYNOPSIS
.B geodesicd
[\fB\-\-\fIflag\fR \fIvalue\fR | \fB\-\-\fIflag\fB=\fIvalue\fR]...
.br
.B geodesicd keygen
.I NAME
[\fB\-\-role\fR read|write] [\fB\-\-tenant\fR \fINAME\fR] [\fB\-\-expires\fR \fITIME\fR|\fIDAYS\fRd] [\fB\-\-rate\fR \fIN\fR] [\fB\-\-concurrent\fR \fIN\fR]
.SH DESCRIPTION
.B geodesicd
keeps triangle meshes and smooth surfaces that are uploaded to it over HTTP, and answers questions about them: the exact distance and shortest path between
any two points, from points to a set, between curves; whole distance fields; straightest geodesics, splines and cuts. What it has computed on a mesh it
keeps in memory, within a budget, so that the next question is answered in microseconds.
.PP
The whole contract is
.I /openapi.json
on the running daemon, for people at
.IR /docs ;
a viewer to try it is at
.IR / .
.PP
Without keys it listens on loopback only. With
.B \-\-keys
it takes other addresses; each line of that file is one that
.B geodesicd keygen
prints, together with the key itself, which is kept nowhere.
.SH OPTIONS
"""

AFTER = r""".PP
Each is also read from the environment (\fBGEODESICD_MAX_BODY\fR for \fB\-\-max\-body\fR) and from the file of \fB\-\-config\fR, in lines
\fIname\fR = \fIvalue\fR. Flags win over the environment, the environment over the file. Sizes may end in KiB, MiB, GiB.
.SH SIGNALS
.TP
.BR SIGTERM ", " SIGINT
Serve on for \fB\-\-drain\-delay\-ms\fR while /readyz says 503; then take no more requests, answer those under way (for \fB\-\-drain\-ms\fR at most), and end.
.TP
.B SIGHUP
Read the keys and the certificate again. What can't be read is logged, and the old ones stay in force.
.SH EXIT STATUS
0 after a signal, and of \fB\-\-check\-store\fR when nothing is wrong; 1 when it could not start or found damage; 2 for a mistake on the command line.
.SH FILES
.TP
.I /var/lib/geodesicd
The store of a daemon that is run by root; of others
.I $XDG_DATA_HOME/geodesicd
or
.IR ~/.local/share/geodesicd .
An upload that was answered is on disk there.
.TP
.IR /metrics ", " /livez ", " /readyz
Paths for Prometheus, and for whoever starts and stops the daemon.
.SH EXAMPLES
.EX
geodesicd &
curl \-T bunny.obj localhost:8080/v1/meshes/bunny
curl \(aqlocalhost:8080/v1/meshes/bunny/path?from=v:12&to=p:0.01,0.12,0.03\(aq
.EE
.PP
On a network:
.PP
.EX
geodesicd keygen alice \-\-role write \-\-expires 90d | tee /dev/stderr | tail \-n 1 >>/etc/geodesicd/keys
geodesicd \-\-listen 0.0.0.0:8443 \-\-keys /etc/geodesicd/keys \-\-tls\-cert cert.pem \-\-tls\-key key.pem
.EE
.SH SEE ALSO
.BR curl (1),
the documents beside the source: README, server/doc, engine/doc.
"""


def escape(text):
    return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")


def main():
    program = sys.argv[1]
    told = [subprocess.run([program, flag], check=True, stdout=subprocess.PIPE, text=True).stdout for flag in ("--help", "--version")]
    print(BEFORE.replace("{version}", told[1].split()[-1]), end="")
    for name, value, text in OPTION.findall(told[0]):
        print(f".TP\n\\fB{escape(name)}\\fR" + (f" \\fI{escape(value)}\\fR" if value else "") + f"\n{escape(text[0].upper() + text[1:])}.")
    print(AFTER, end="")


if __name__ == "__main__":
    main()
