"""Inside the interpreter: library.zip to bare.zip, without docstrings and line numbers.

The page does not use them, and they would take a tenth of the memory image.
"""

import dis
import inspect
import marshal
import zipfile
from itertools import pairwise
from types import CodeType

HEAD_BYTES = 16  # of a compiled file, before its code
READ = {"numpy/_core/numeric.pyc"}  # numpy.ma demands these docstrings


def bare(code, *, is_read):
    """Code without line numbers and, unless ``is_read``, without docstrings, and all code in it."""
    constants = [
        bare(one, is_read=is_read) if isinstance(one, CodeType) else one for one in code.co_consts
    ]
    flags, lines = code.co_flags, nowhere(len(code.co_code) // 2)
    if not is_read and (place := docstring_place(code)) is not None:
        constants[place] = None
        flags &= ~inspect.CO_HAS_DOCSTRING
    return code.replace(co_consts=tuple(constants), co_flags=flags, co_linetable=lines)


def docstring_place(code):
    """Where the docstring stands among the constants, if it is used for nothing else."""
    of_function = bool(code.co_flags & inspect.CO_HAS_DOCSTRING)
    place = 0 if of_function else None
    if "__doc__" in code.co_names:  # of a class or a module
        for step, after in pairwise(dis.get_instructions(code)):
            is_stored = (after.opname, after.argval) == ("STORE_NAME", "__doc__")
            if is_stored and step.opname == "LOAD_CONST" and step.arg < 1 << 8:
                place = step.arg
    units = zip(code.co_code[::2], code.co_code[1::2], strict=True)
    loads = sum(unit == (dis.opmap["LOAD_CONST"], place) for unit in units)
    return place if loads == (0 if of_function else 1) else None


def nowhere(count):
    """Line table of so many code units that maps none to a line; an entry covers up to eight."""
    whole, rest = divmod(count, 8)
    return b"\xff" * whole + (bytes([0xF8 | rest - 1]) if rest else b"")


library = zipfile.ZipFile("/io/library.zip")
with zipfile.ZipFile("/io/bare.zip", "w", zipfile.ZIP_STORED) as out:
    for one in library.infolist():
        content = library.read(one)
        if one.filename.endswith(".pyc"):
            code = bare(marshal.loads(content[HEAD_BYTES:]), is_read=one.filename in READ)
            content = content[:HEAD_BYTES] + marshal.dumps(code)
        out.writestr(one, content)
