#!/usr/bin/env python3
"""Makes NotoSansSC-GBK.otf, the screen's Chinese font, from Debian's Noto Sans CJK.

    apt-get install fonts-noto-cjk          # 1:20220127+repack1-1
    pip install fonttools==4.60.1
    python3 make.py [NotoSansCJK-Regular.ttc]

The result is the same to the byte every time; the script refuses another source, another fonttools or another result.
"""

import hashlib
import sys
from pathlib import Path

import fontTools
from fontTools import subset
from fontTools.ttLib import TTFont

FONTTOOLS = "4.60.1"
SOURCE = Path("/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc")
SOURCE_SHA256 = "b76b0433203017ca80401b2ee0dd69350349871c4b19d504c34dbdd80541690a"
FACE = 2  # Noto Sans CJK SC
RESULT = Path(__file__).resolve().parent / "NotoSansSC-GBK.otf"
RESULT_SHA256 = "8fb0fd7d23c53c708622fd796492dcdec43d93698d138b8d7da105ce9fade2a8"
RESULT_LIMIT = 5_000_000  # bytes
# 0 copyright, 1-6 names and version, 7 trademark, 13 licence, 14 its address: the licence asks that these stay.
NAMES = [0, 1, 2, 3, 4, 5, 6, 7, 13, 14]
# What the screen's English and its keys use and GBK may lack. The font has no U+2300 diameter, U+2302 house.
EXTRA = "µμ▶◀▲▼▷◁△▽←→↑↓↖↗↘↙⇧⇦⇨⇩⏎±×÷·…–—“”‘’№°℃≤≥≠≈Ø∅⌀⌂Φφ∞√✓⚠●○■□◆◇★☆─│┌┐└┘├┤┬┴┼€"


def gbk() -> set[int]:
    """Every character that GBK can write."""
    found = set()
    for lead in range(0x81, 0xFF):
        for trail in range(0x40, 0xFF):
            try:
                found.add(ord(bytes((lead, trail)).decode("gbk")))
            except UnicodeDecodeError:
                continue
    return found


def wanted() -> set[int]:
    """Code points to keep: GBK, ASCII, Latin-1 and the extras."""
    return gbk() | set(range(0x20, 0x7F)) | set(range(0xA0, 0x100)) | {ord(c) for c in EXTRA}


def make(source: Path) -> bytes:
    """The subset font file."""
    options = subset.Options()
    options.layout_features = []
    options.hinting = False
    options.desubroutinize = False
    options.notdef_outline = True
    options.name_IDs = NAMES
    options.name_languages = [0x409]
    options.recalc_timestamp = False
    options.drop_tables += ["BASE", "GDEF", "GPOS", "GSUB", "VORG", "vhea", "vmtx"]
    font = TTFont(source, fontNumber=FACE, recalcTimestamp=False)
    cut = subset.Subsetter(options)
    cut.populate(unicodes=wanted())
    cut.subset(font)
    temporary = RESULT.with_suffix(".part")
    font.save(temporary)
    made = temporary.read_bytes()
    temporary.unlink()
    return made


def check(path: Path) -> None:
    """Figures of one width; says what the font lacks."""
    font = TTFont(path)
    cmap = font.getBestCmap()
    widths = {font["hmtx"][cmap[ord(digit)]][0] for digit in "0123456789"}
    if len(widths) != 1:
        sys.exit(f"digits have several widths: {widths}")
    lacking = sorted(wanted() - cmap.keys())
    private = [c for c in lacking if 0xE000 <= c <= 0xF8FF]
    others = "".join(chr(c) for c in lacking if c not in private)
    print(f"{len(cmap)} characters; digit width {widths.pop()}; lacking: {others!r} and {len(private)} private-use")


def main() -> None:
    """Checks the source, makes the font, checks the result."""
    source = Path(sys.argv[1]) if len(sys.argv) > 1 else SOURCE
    if fontTools.version != FONTTOOLS:
        sys.exit(f"fonttools {fontTools.version} is installed; the recipe needs {FONTTOOLS}")
    digest = hashlib.sha256(source.read_bytes()).hexdigest()
    if digest != SOURCE_SHA256:
        sys.exit(f"{source} is another file: sha256 {digest}")
    made = make(source)
    digest = hashlib.sha256(made).hexdigest()
    if digest != RESULT_SHA256:
        sys.exit(f"the result differs: {len(made)} bytes, sha256 {digest}")
    if len(made) > RESULT_LIMIT:
        sys.exit(f"the result is {len(made)} bytes, over {RESULT_LIMIT}")
    RESULT.write_bytes(made)
    check(RESULT)
    print(f"{RESULT.name}: {len(made)} bytes, sha256 {digest}")


if __name__ == "__main__":
    main()
