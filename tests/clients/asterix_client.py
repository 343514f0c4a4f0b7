"""What libasterix (PyPI, strict: CAT021 edition 2.1, CAT023 edition 1.2) understands of a byte stream.

Reads bytes from a file or standard input; prints one JSON line a record: {"category": 21, "131/LAT": 52.2, ...}. Keys are item and subitem of the
specification; quantities are in the specification's units, tables and numbers as integers, text as text. Ends with exit code 1 where a byte fits no
record.
"""

import asterix_stream
from asterix.base import Bits, RawDatablock
from asterix.generated import Cat_021_2_1, Cat_023_1_2

EDITIONS = {21: Cat_021_2_1, 23: Cat_023_1_2}


def element(variation, told):
    if hasattr(variation, "content"):
        content = variation.content
    else:
        # What it means depends on another subitem, which stands before it.
        depends_on = ("/".join(path) for path in variation.cv_rule.cv_depends_on)
        content = variation.rule.content(tuple(told[name] for name in depends_on))
    if hasattr(content, "as_quantity"):
        return content.as_quantity()
    if hasattr(content, "as_string"):
        return content.as_string()
    return content.as_uint()


def flatten(name, variation, into):
    kind = type(variation).__mro__[1].__name__
    if kind == "Element":
        into[name] = element(variation, into)
    elif kind in ("Group", "Extended", "Compound"):
        for sub in variation.cv_items_dict:
            item = variation.get_item(sub)
            if item is not None:
                flatten(f"{name}/{sub}", item.variation, into)
    elif kind == "Repetitive":
        into[name] = [repetition.as_uint() for repetition in variation.get_list()]
    else:
        raise ValueError(f"{name}: a {kind}")


def parsed_blocks(data):
    """libasterix reads a stream recursively, so it gets a block a call."""
    for block in asterix_stream.blocks(data):
        parsed = RawDatablock.parse(Bits.from_bytes(block))
        if isinstance(parsed, ValueError):
            raise parsed
        yield from parsed


def records(data):
    for block in parsed_blocks(data):
        category = block.get_category()
        parsed = EDITIONS[category].cv_uap.parse(block.get_raw_records())
        if isinstance(parsed, ValueError):
            raise parsed
        for record in parsed:
            told = {"category": category}
            for name, item in record.items_regular.items():
                flatten(name, item.variation, told)
            yield told


if __name__ == "__main__":
    asterix_stream.tell(records)
