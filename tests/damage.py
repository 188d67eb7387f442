"""Damaged file contents: pieces replaced by tokens that break parsers, flips, cuts and sizes."""

import re

TOKENS = [
    *(b"", b"\n", b",", b";", b"\t", b'"', b"'", b"nan", b"1e999", b"-", b"<", b"]", b"[", b"{"),
    *(b"}", b"%", b"\0", b"\xff", b"99999999999", b"9" * 5000, b"0", b"true", b"null", b"=", b"."),
    *(b"a.b.c", b"[[", b"]]", b"\\u0000", b"\\ud800", b"#", b"e-", b"DN", b"inf", b"{}", b"[]"),
    b"[" * 3000,
]
SIZES = (0, 1, 2, 5, 127, 128, 255, 2**15, 2**16 - 1, 2**24, 2**31 - 1, 2**31, 2**32 - 1, 2**40)
WORDS = (b"-1", b"0", b"1", b"3", b"9" * 12, b"9" * 400, b"1e400", b"nan", b"{", b"}", b"[", b'"',
         b"\0", b"null", b"<f8", b"|O", b"bsq", b"um", b"None", b"True", b"\xff", b"\n", b"x",
         b"X,Y", b"BEGIN_DATA", b"ENVI", b"radiance", b"\x0e\0\0\0")  # fmt: skip
INTERNALS = re.compile(
    r"<[\w.]* ?\w+ object|<class|<ast|<COMPRESSION|Traceback|object at 0x|__[a-z]\w+__"
)
"""What no sentence may contain, because it is about our parsers."""


def mutated(content, edits):
    """Content with pieces replaced: (place from 0 to 1, length, token) each."""
    for place, length, token in edits:
        at = int(place * len(content))
        content = content[:at] + token + content[at + length :]
    return content


def random_edits(rng):
    """One to six edits for `mutated`."""
    return [
        (
            rng.random(),
            int(rng.integers(0, 40)),
            TOKENS[rng.integers(len(TOKENS))]
            if rng.random() < 0.5
            else rng.bytes(int(rng.integers(0, 7))),
        )
        for _ in range(rng.integers(1, 7))
    ]


def damaged(content, rng):
    """One to three faults: flipped, cut, inserted, left out, sizes, words; half in the header."""
    content = bytearray(content)
    head = min(len(content), 2000) if rng.random() < 0.5 else len(content)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        at, kind = int(rng.integers(0, head + 1)), rng.integers(0, 7)
        if kind == 0 and at < len(content):
            content[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1 and rng.random() < 0.4:
            del content[at:]
        elif kind == 2:
            content[at:at] = rng.bytes(int(rng.integers(1, 9)))
        elif kind == 3:
            del content[at : at + int(rng.integers(1, 17))]
        elif kind == 4:
            width = int(rng.choice([1, 2, 4, 8]))
            size = int(rng.choice(SIZES)) % 2 ** (8 * width)
            at -= at % width
            content[at : at + width] = size.to_bytes(width, str(rng.choice(["little", "big"])))
        elif kind == 5:
            content[at : at + int(rng.integers(0, 5))] = WORDS[rng.integers(len(WORDS))]
        elif numbers := list(re.finditer(rb"\d+", bytes(content[:head]))):
            found = numbers[rng.integers(len(numbers))]
            content[found.start() : found.end()] = str(int(rng.choice(SIZES))).encode()
    return bytes(content)
