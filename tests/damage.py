"""Damaged file contents: pieces replaced by tokens that break parsers."""

TOKENS = [
    *(b"", b"\n", b",", b";", b"\t", b'"', b"'", b"nan", b"1e999", b"-", b"<", b"]", b"[", b"{"),
    *(b"}", b"%", b"\0", b"\xff", b"99999999999", b"9" * 5000, b"0", b"true", b"null", b"=", b"."),
    *(b"a.b.c", b"[[", b"]]", b"\\u0000", b"\\ud800", b"#", b"e-", b"DN", b"inf", b"{}", b"[]"),
    b"[" * 3000,
]


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
