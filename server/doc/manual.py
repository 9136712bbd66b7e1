#!/usr/bin/env python3
"""Prints the man page geodesicd(8). Makes the OPTIONS section from the output of PROGRAM --help.

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
[\fB\-\-role\fR read|write|operator] [\fB\-\-tenant\fR \fINAME\fR]
[\fB\-\-expires\fR \fITIME\fR|\fIDAYS\fRd] [\fB\-\-rate\fR \fIN\fR] [\fB\-\-concurrent\fR \fIN\fR]
.SH DESCRIPTION
.B geodesicd
stores triangle meshes and smooth surfaces that are uploaded over HTTP, and answers queries about
them: the exact distance and the shortest path between any two points, distances to sets and curves,
distance fields, straightest geodesics, splines and cuts. It keeps distance fields in memory, within a
budget, so a repeated query takes microseconds.
.PP
The daemon serves its contract at
.IR /openapi.json ,
its documents at
.IR /docs ,
and a viewer at
.IR / .
.PP
Without keys it listens on the loopback interface only. With
.B \-\-keys
it may listen on other addresses. That flag names a file of lines that
.B geodesicd keygen
prints. The command also prints the key itself, which is stored nowhere.
.SH OPTIONS
"""

AFTER = r""".PP
Each flag is also an environment variable (\fBGEODESICD_MAX_BODY\fR for \fB\-\-max\-body\fR) and a line
\fIname\fR = \fIvalue\fR of the file of \fB\-\-config\fR. Flags override the environment, and the
environment overrides the file. Sizes may end in KiB, MiB, GiB.
.SH SIGNALS
.TP
.BR SIGTERM ", " SIGINT
Serve for \fB\-\-drain\-delay\-ms\fR while /readyz returns 503. Then accept no more requests, answer the
running ones, for at most \fB\-\-drain\-ms\fR, and exit.
.TP
.B SIGHUP
Read the keys and the certificate again. If a file cannot be read, log the error and keep the old ones.
.SH EXIT STATUS
0: a signal stopped the daemon, or \fB\-\-check\-store\fR found no damage. 1: the daemon could not
start, or found damage. 2: a mistake on the command line.
.SH FILES
.TP
.I /var/lib/geodesicd
The store of a daemon that root runs. For other users
.I $XDG_DATA_HOME/geodesicd
or
.IR ~/.local/share/geodesicd .
Acknowledged uploads are durable there.
.TP
.IR /metrics ", " /livez ", " /readyz
Paths for Prometheus, process supervisors and load balancers.
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
the documents in /usr/share/doc/geodesicd.
"""


def escape(text):
    return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")


def main():
    program = sys.argv[1]
    shown = [subprocess.run([program, flag], check=True, stdout=subprocess.PIPE, text=True).stdout for flag in ("--help", "--version")]
    print(BEFORE.replace("{version}", shown[1].split()[-1]), end="")
    for name, value, text in OPTION.findall(shown[0]):
        print(f".TP\n\\fB{escape(name)}\\fR" + (f" \\fI{escape(value)}\\fR" if value else "") + f"\n{escape(text[0].upper() + text[1:])}.")
    print(AFTER, end="")


if __name__ == "__main__":
    main()
