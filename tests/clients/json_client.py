"""Checks a stream of JSON messages against the project's schema with the PyPI package jsonschema, and prints them.

usage: json_client.py SCHEMA [FILE]

Reads lines from a file or standard input; prints each message again as one JSON line, {"invalid": reason, "line": text} for one that is not valid
JSON, ends otherwise than with \\r\\n, holds white space between its tokens, or breaks the schema.
"""

import json
import sys

import jsonschema


def no_duplicates(pairs):
    names = [name for name, _ in pairs]
    if len(names) != len(set(names)):
        raise ValueError("a name stands twice")
    return dict(pairs)


def messages(data, validator):
    for line in data.splitlines(keepends=True):
        try:
            text = line.decode("ascii")
            if not text.endswith("}\r\n"):
                raise ValueError("the line does not end in } and CR LF")
            message = json.loads(text, object_pairs_hook=no_duplicates)
            error = jsonschema.exceptions.best_match(validator.iter_errors(message))
            if error is not None:
                raise ValueError(f"{error.json_path}: {error.message}")
            yield message
        except ValueError as reason:
            yield {"invalid": str(reason), "line": line.decode("latin-1")}


def main():
    with open(sys.argv[1], encoding="ascii") as schema:
        schema = json.load(schema)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    stream = open(sys.argv[2], "rb") if len(sys.argv) > 2 else sys.stdin.buffer
    for message in messages(stream.read(), validator):
        print(json.dumps(message))


if __name__ == "__main__":
    main()
