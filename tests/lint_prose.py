#!/usr/bin/env python3
"""Checks the prose of the project: documents, comments, messages and commit subjects.

usage: tests/lint_prose.py [PATH...]    default: all files of the repository

Each complaint is one line: FILE:LINE: what is wrong: the remedy. The exit status is 1 if there are
any. The rules:

    columns   a line of prose or of a comment has at most 100 columns
    phrase    the constructions of PHRASES are not used
    sentence  a sentence of a document has at most 40 words
    path      a file or folder that a document or a comment names exists
    subject   the commits of this branch have subjects of the form `area: verb ...`
    spelling  codespell knows no correction (tests/spelling.txt lists the words that are right)
    conflict  no file has the markers of a merge conflict
"""
import functools
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COLUMNS = 100
WORDS = 40

# Constructions that are hard to understand at first reading, each with its remedy. A pattern begins
# with a literal, which makes the search fast. BE before the literal stands for a form of "to be".
BE = "BE "
PHRASES = [
    ("whoever", "name the reader, the client or the program"),
    ("who asks?(?: for)?", "name the client"),
    ("who may ask", "say which key may read it"),
    ("that which", "name the thing"),
    ("what (?:is|was|are) told", "name the data: 'the description', 'the report'"),
    (BE + "told (?:of|about|by|as|only|apart)", "'is reported', 'is distinguished'"),
    ("tells? of", "'describes', 'reports'"),
    ("lets? be", "'ignores', 'leaves unchanged'"),
    ("on (?:its|their) way already", "'already queued', 'already sent'"),
    (BE + "on (?:its|their) way", "'is queued', 'is being sent', 'is being built'"),
    ("beg[ia]ns? anew", "'restarts'"),
    ("what comes", "name what follows"),
    ("what (?:it|they) (?:has|have) learnt", "name the data"),
    (BE + "asked (?:for|about|again|of)", "'is requested', 'is queried'"),
    ("ask(?:s|ed)? again", "'retries', 'repeats the request'"),
    ("nobody (?:else )?(?:asked|asks|wants|reads)", "say 'unused', 'unread', 'idle'"),
    (BE + "looked (?:at|through|after|up again)", "'is checked', 'is scanned'"),
    ("look(?:s|ed)? through", "'scans'"),
    ("goes on (?:with|to|as|being)", "'continues'"),
    ("has it(?=[.,;])", "name the thing"),
    ("of sense", "'meaningful', 'sensible'"),
    ("what (?:it|this|that) takes", "name the cost"),
    ("what (?:it|that) is for", "'its purpose'"),
    ("as it was (?:measured|before)", "state the measurement; delete the history"),
    ("read again:", "say what changed"),
    ("(?<!there )is no (?:json|number|name|file|mesh|surface|manifold|http|origin|size|point|token|address|"
     "setting|key|object|element)", "'is not a ...'"),
    ("are no (?:numbers|names|files|meshes|surfaces|manifolds|points|vertices)", "'are not ...'"),
    ("those who", "name the persons or the programs"),
    ("one who", "name the person or the program"),
    ("nor is there", "split the sentence"),
    ("the one that (?:is|has|was)", "name the noun"),
    ("let go of", "'released', 'evicted'"),
    ("lets? go of", "'releases', 'evicts'"),
    ("in (?:its|their) stead", "'instead'"),
    ("can be had", "'is available'"),
    ("found out", "'determined', 'computed'"),
    ("but for(?! (?:each|every|all|the purpose))", "'except'"),
    ("hither|thither|thereof|whereof|wherefore", "write plain English"),
]
BEFORE = re.compile(r"(?:is|are|was|were|be|been) $")
COMPILED = [(pattern.startswith(BE), re.compile(pattern.removeprefix(BE) + r"\b"), remedy)
            for pattern, remedy in PHRASES]

# Generated files. Paths on the command line are checked anyway.
UNCHECKED = ("clients/js/types.d.ts",)

C_LIKE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|`(?:\\.|[^`\\])*`', re.S)
PYTHON = re.compile(r'#[^\n]*|"""(?:\\.|[^\\])*?"""|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
C_SUFFIXES = {".c", ".h", ".cc", ".ts", ".js", ".mjs", ".css"}
HASH_SUFFIXES = {".sh", ".mk", ".bash", ".cfg"}
HASH_NAMES = {"Makefile", "Dockerfile", "geodesic"}
TEXT_SUFFIXES = C_SUFFIXES | HASH_SUFFIXES | {".md", ".py", ".yaml", ".html", ".1", ".3"}
KNOWN_SUFFIXES = r"(?:c|h|cc|py|md|ts|js|mjs|yaml|mk|sh|json|svg|txt|css|html|in|cfg|service)"
TOP = r"(?:engine|proto|server|clients|tests|docker)"
MADE_BY_USERS = {"docker/keys", "docker/metrics-key", "docker/.env"}
# A path from the root in a comment. `server/doc/015` abbreviates the note of this number.
ROOT_PATH = re.compile(rf"(?<![\w./$-]){TOP}/[\w.-]+(?:/[\w.-]+)*/?")
CODE_SPAN = re.compile(r"`([^`\s]+)`")
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")


class Text:
    """A block of prose: a paragraph, a comment, a message. Each part is (line number, text)."""

    def __init__(self, parts, is_comment=True):
        self.parts, self.is_comment = parts, is_comment
        self.joined = " ".join(text for _, text in parts)

    def line_at(self, offset):
        for number, text in self.parts:
            if offset <= len(text):
                return number
            offset -= len(text) + 1
        return self.parts[-1][0]


# --- reading --------------------------------------------------------------------------------------


def strip_comment(line):
    return re.sub(r"^\s*(?:/\*+|\*(?!/)|//+!?|#+!?)?\s?|\s*\*+/\s*$", "", line).strip()


def numbered(first, raw):
    return [(first + i, strip_comment(line)) for i, line in enumerate(raw.split("\n"))]


def c_texts(source):
    """Returns comments, and string literals with a blank in them. Adjacent line comments are one
    text."""
    texts, line, end = [], 1, 0
    for match in C_LIKE.finditer(source):
        line += source.count("\n", end, match.start())
        gap, end, raw = source[end:match.start()], match.start(), match.group()
        if raw[0] == "/":
            parts = numbered(line, raw)
            joins = raw[1] == "/" and texts and texts[-1].is_comment and not gap.strip().strip("\n")
            joins = joins and texts[-1].parts[-1][0] == line - 1
            texts = texts[:-1] + [Text(texts[-1].parts + parts)] if joins else texts + [Text(parts)]
        elif " " in raw:
            texts.append(Text([(line + i, part) for i, part in enumerate(raw[1:-1].split("\n"))], False))
        line += raw.count("\n")
        end = match.end()
    return texts


def python_texts(source):
    """Returns comments, docstrings, and strings with a blank in them."""
    texts, line, end = [], 1, 0
    for match in PYTHON.finditer(source):
        line += source.count("\n", end, match.start())
        raw, before = match.group(), source.rfind("\n", 0, match.start()) + 1
        if raw[0] == "#":
            part = (line, strip_comment(raw))
            joins = texts and texts[-1].is_comment and texts[-1].parts[-1][0] == line - 1
            texts = texts[:-1] + [Text(texts[-1].parts + [part])] if joins else texts + [Text([part])]
        elif " " in raw:
            is_docstring = raw.startswith('"""') and not source[before:match.start()].strip(" r")
            parts = [(line + i, part.strip(" \"'")) for i, part in enumerate(raw.split("\n"))]
            texts.append(Text(parts, is_docstring))
        line += raw.count("\n")
        end = match.end()
    return texts


def hash_texts(source):
    texts = []
    for number, line in enumerate(source.split("\n"), 1):
        match = re.search(r"(?:^|\s)#+\s(.*)", line)
        if match and not (texts and texts[-1].parts[-1][0] == number - 1):
            texts.append(Text([(number, match.group(1))]))
        elif match:
            texts[-1] = Text(texts[-1].parts + [(number, match.group(1))])
    return texts


def paragraphs(source):
    """Returns the texts of a document without code blocks; a list item, a table row and a heading
    are texts."""
    texts, parts, is_code = [], [], False
    for number, line in enumerate(source.split("\n") + [""], 1):
        fence = line.lstrip().startswith("```")
        starts = not line.strip() or fence or re.match(r"\s*(?:[-*|#>]|\d+\.)\s?", line)
        if starts and parts:
            texts.append(Text(parts))
            parts = []
        is_code ^= fence
        if not is_code and not fence and line.strip() and not re.match(r"\[[^\]]+\]: ", line):
            parts.append((number, re.sub(r"^\s*(?:[-*#>]+|\d+\.)\s", "", line).strip()))
    return texts


def yaml_texts(source):
    return [Text([(number, line.strip())]) for number, line in enumerate(source.split("\n"), 1) if " " in line.strip()]


def texts_of(path, source):
    if path.suffix in C_SUFFIXES:
        return c_texts(source)
    if path.suffix == ".py":
        return python_texts(source)
    if path.suffix == ".md":
        return paragraphs(source)
    if path.suffix == ".yaml":
        return yaml_texts(source)
    if path.suffix in HASH_SUFFIXES or path.name in HASH_NAMES:
        return hash_texts(source)
    return [Text([(number, line)]) for number, line in enumerate(source.split("\n"), 1) if line.strip()]


# --- rules ----------------------------------------------------------------------------------------


def check_columns(path, lines, texts):
    """Reports long lines of prose. A table row, the help of a make target, values of YAML and HTML,
    and an address need not be wrapped."""
    prose = sorted({number for text in texts if text.is_comment for number, _ in text.parts})
    for number in prose:
        line = lines[number - 1]
        value = {".yaml": r"\{.*\}|expr:", ".html": r'="'}.get(path.suffix, "^$")
        is_value = re.search(value, line)
        is_whole = is_value or path.suffix == ".md" and line.startswith("|") or " ## " in line
        if len(line) > COLUMNS and not is_whole and " " in line.strip():
            yield number, f"{len(line)} columns: wrap at {COLUMNS}"


def check_phrases(texts):
    for text in texts:
        prose = text.joined.lower()
        if "`" in prose:
            prose = re.sub(r"`[^`]*`", lambda code: "x" * len(code.group()), prose)
        for needs_be, pattern, remedy in COMPILED:
            for match in pattern.finditer(prose):
                start = match.start()
                is_word = start == 0 or not (prose[start - 1].isalnum() or prose[start - 1] == "_")
                if is_word and (not needs_be or BEFORE.search(prose, max(0, start - 6), start)):
                    yield text.line_at(start), f"'{match.group()}': {remedy}"


def check_sentences(texts):
    for text in texts:
        if text.joined.startswith("|"):
            continue
        offset = 0
        for sentence in re.split(r"(?<=[.:;?!])[*)\"]*\s", text.joined):
            count = len(sentence.split())
            if count > WORDS:
                yield text.line_at(offset), f"a sentence of {count} words: split it (at most {WORDS})"
            offset += len(sentence) + 1


@functools.cache
def exists(place):
    """Returns whether a path exists. It may be a glob, or the beginning of a numbered note's
    name."""
    if (ROOT / place).exists() or place in MADE_BY_USERS:
        return True
    folder, name = ROOT / pathlib.Path(place).parent, pathlib.Path(place).name
    pattern = name if "*" in name else name + "-*" if re.fullmatch(r"\d{3}", name) else name + ".*"
    return any(folder.glob(pattern)) if "*" not in str(folder) else any(ROOT.glob(place))


def check_source_paths(texts):
    for text in texts:
        if text.is_comment:
            for match in ROOT_PATH.finditer(text.joined):
                place = match.group().rstrip(".-")
                if not exists(place):
                    yield text.line_at(match.start()), f"{place} does not exist: name the file of today"


def is_named_path(code):
    is_file = re.fullmatch(rf"[\w.*/-]+/[\w.*-]+\.{KNOWN_SUFFIXES}", code)
    return not code.startswith("build/") and (is_file or re.fullmatch(rf"{TOP}/[\w.*/-]+", code))


def check_document_paths(path, texts):
    """Reports paths that exist neither from the root nor from the document's folder, nor from the
    folder above it (engine/doc)."""
    places = [pathlib.Path(), path.parent, path.parent.parent, pathlib.Path("engine/include")]
    for text in texts:
        for match in [*CODE_SPAN.finditer(text.joined), *LINK.finditer(text.joined)]:
            named = match.group(1)
            is_link = match.re is LINK
            if (is_link and "://" not in named and not named.startswith("/")) or (not is_link and is_named_path(named)):
                starts = [path.parent] if is_link else places
                if not any(exists((start / named).as_posix()) or (ROOT / start / named).exists() for start in starts):
                    yield text.line_at(match.start()), f"{named} does not exist: name the file of today"


def check_file(path):
    source = (ROOT / path).read_text(encoding="utf-8")
    lines, texts = source.split("\n"), texts_of(path, source)
    is_document = path.suffix == ".md"
    complaints = [*check_columns(path, lines, texts), *check_phrases(texts)]
    if is_document:
        complaints += [*check_sentences(texts), *check_document_paths(path, texts)]
    else:
        complaints += check_source_paths(texts)
    return [f"{path}:{number}: {complaint}" for number, complaint in sorted(complaints)]


# --- commits and spelling -------------------------------------------------------------------------


def run(*command):
    return subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def check_subject(subject):
    if len(subject) > 72:
        return f"{len(subject)} characters: at most 72"
    if not re.match(r"[a-z0-9][\w./, -]*: [a-z`]", subject):
        return "write `area: imperative verb ...`"
    if re.search(r"\d\s?(?:%|ms|s|µs|times|MB|GB|MiB|GiB)\b", subject):
        return "figures belong in the body"
    return "no full stop at the end" if subject.endswith(".") else None


def check_commits():
    """Checks the commits that main does not have. On main, checks the last commit."""
    ahead = run("git", "log", "--no-merges", "--format=%h %s", "main..HEAD")
    log = ahead.stdout or run("git", "log", "-1", "--no-merges", "--format=%h %s").stdout
    for line in log.splitlines():
        commit, subject = line.split(" ", 1)
        complaint = check_subject(subject)
        if complaint:
            yield f"commit {commit}: '{subject}': {complaint}"


def check_spelling(paths):
    if not shutil.which("codespell"):
        print("lint_prose.py: no codespell here, so spelling is not checked: make setup-test installs it", file=sys.stderr)
        return []
    words = ROOT / "tests" / "spelling.txt"
    done = run("codespell", "-I", str(words), *[str(path) for path in paths])
    return [line.removeprefix("./") for line in done.stdout.splitlines()]


def check_conflicts():
    marked = run("git", "grep", "-nE", "^(<{7}|>{7}) ").stdout
    return [f"{line}: resolve the merge conflict" for line in marked.splitlines()]


def main(arguments):
    listed = [pathlib.Path(name) for name in run("git", "ls-files", "--", *arguments).stdout.splitlines()]
    paths = [path for path in listed if (path.suffix in TEXT_SUFFIXES or path.name in HASH_NAMES)
             and path.name != "lint_prose.py" and (ROOT / path).is_file()]
    if not arguments:
        paths = [path for path in paths if not path.as_posix().startswith(UNCHECKED)]
    complaints = [complaint for path in paths for complaint in check_file(path)]
    complaints += check_spelling(paths) if paths else []
    if not arguments:
        complaints += [*check_conflicts(), *check_commits()]
    print(*complaints, sep="\n", end="\n" if complaints else "")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
