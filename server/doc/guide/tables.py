"""Tables of the reference, read from the sources that hold their contents."""
import ast
import pathlib
import re

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
METHODS = ("get", "head", "put", "post", "patch", "delete")
METRIC_SOURCES = ("server/exchange/metrics.c", "server/gauges.c", "server/access/access.c")
C_STRINGS = r'"(?:\\.|[^"\\])*"(?:\s*"(?:\\.|[^"\\])*")*'
LEAST_LIST = 8  # shorter bounds are the dimension of a value, not a limit of a request


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


def c_value(literal):
    """Returns the text of adjacent C string literals."""
    return "".join(ast.literal_eval(part) for part in re.findall(r'"(?:\\.|[^"\\])*"', literal))


def escaped(text):
    return re.sub(r"<", "&lt;", text).replace("|", "\\|")


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def contract():
    return yaml.load(text_of("proto/openapi.yaml"), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))


# --- flags ----------------------------------------------------------------------------------------


def option_rows():
    """Returns (name, argument, default, help) of each row of the table in
    server/config/config.c."""
    source = text_of("server/config/config.c")
    rows = re.search(r"struct option options\[\] = \{(.*?)^\};", source, re.S | re.M).group(1)
    row = re.compile(rf'\{{\s*"([a-z-]+)",\s*(NULL|"[^"]*"),\s*\w+\((.*?)\),\s*({C_STRINGS})\s*\}}', re.S)
    for name, argument, settings, text in row.findall(rows):
        standard = re.search(r'"([^"]*)"', settings)
        yield name, "" if argument == "NULL" else c_value(argument), standard.group(1) if standard else "", c_value(text)


def flags():
    rows = [(f"`--{name}`" + (f" `{argument}`" if argument else ""), f"`{standard}`" if standard else "", escaped(text[0].upper() + text[1:]) + ".")
            for name, argument, standard, text in option_rows()]
    return table(("Flag", "Default", "Meaning"), [(flag.replace("|", "\\|"), standard, text) for flag, standard, text in rows])


# --- problems -------------------------------------------------------------------------------------


def problem_codes():
    """Returns the rows (status, code, title) of PROTO_PROBLEM_MAP."""
    return re.findall(r'X\((\d+), \w+, (\w+), "([^"]+)"\)', text_of("proto/json/problem.h"))


# Sentences for the codes that have no sentence of their own in the contract's shared responses.
CAUSES = {
    "conflict": "The name is in use, the job or batch has not ended, or a maximum number is reached.",
    "method_not_allowed": "The path does not support the method. The header `Allow` lists those that it does.",
    "overloaded": "The queue is full. Retry after `Retry-After` seconds.",
    "draining": "The daemon is ending. Retry after `Retry-After` seconds, or at another node.",
}


def problem_causes(document):
    """Returns the sentences of the contract's shared responses that begin with a code."""
    causes = dict(CAUSES)
    for response in document["components"]["responses"].values():
        for code, text in re.findall(r"`(\w+)`: (.*?)(?=(?: `\w+`: )|$)", response.get("description", ""), re.S):
            sentence = " ".join(text.split())
            causes.setdefault(code, sentence[:1].upper() + sentence[1:])
    return causes


def problems():
    causes = problem_causes(contract())
    rows = [(f"`{code}`", status, title, escaped(causes.get(code, ""))) for status, code, title in problem_codes()]
    return table(("Code", "Status", "Title", "Cause"), rows)


# --- metrics --------------------------------------------------------------------------------------


def metric_rows():
    """Returns (name, kind, help) of each metric."""
    for source in map(text_of, METRIC_SOURCES):
        for name, text in re.findall(rf'\{{"([a-z_]+)",\s*({C_STRINGS}),\s*[(\w!]', source):
            yield name, "counter" if name.endswith("_total") else "gauge", c_value(text)
        for name, kind, text in re.findall(rf'write_head\(writer, "([a-z_]+)", "(\w+)",\s*({C_STRINGS})\)', source):
            yield name, kind, c_value(text)
        for name, kind, text in re.findall(rf'\{{"([a-z_]+)", "(counter|gauge)",\s*({C_STRINGS}),', source):
            yield name, kind, c_value(text)


def metrics():
    rows = sorted({f"`geodesicd_{name}`": (kind, escaped(text)) for name, kind, text in metric_rows()}.items())
    return table(("Metric", "Kind", "Meaning"), [(name, *rest) for name, rest in rows])


# --- operations and their limits ------------------------------------------------------------------


def operations():
    rows = [(f"`{method.upper()} {path}`", escaped(operation["summary"]))
            for path, item in contract()["paths"].items() for method, operation in item.items()
            if method in METHODS and not operation.get("deprecated")]
    return table(("Operation", "Result"), rows)


def bounds(schema, name):
    """Returns (member, bound) of each long list and each bounded number within a schema."""
    if isinstance(schema, list):
        for each in schema:
            yield from bounds(each, name)
    if not isinstance(schema, dict):
        return
    if schema.get("maxItems", 0) >= LEAST_LIST:
        yield name, f"{schema['maxItems']:,} items"
    if isinstance(schema.get("maximum"), int) and schema["maximum"] >= LEAST_LIST:
        yield name, f"{schema['maximum']:,}"
    for key, child in schema.items():
        if key == "properties":
            for member, value in child.items():
                yield from bounds(value, f"{name}.{member}")
        elif key in ("items", "oneOf", "anyOf", "allOf"):
            yield from bounds(child, name)


def limits():
    schemas = contract()["components"]["schemas"]
    rows = sorted({row for name, schema in schemas.items() if name.endswith(("Request", "Query")) for row in bounds(schema, name)})
    return table(("Member of a request", "At most"), [(f"`{name}`", bound) for name, bound in rows])


TABLES = {"flags": flags, "problems": problems, "metrics": metrics, "operations": operations, "limits": limits}
