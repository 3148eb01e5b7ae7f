"""Puts the pages of the repository together in out/site-pages, and has mkdocs make out/site of them; a dead link is an error.

Pages keep their places, so that their links hold. Every file that a page links to comes along; a folder becomes a list of its files.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "out/site-pages"
LINK = re.compile(r"(!?\[[^\]]*\]\()([^)#\s]+)((?:#[^)\s]*)?\))")


def linked(page, text, found):
    """The text with links to folders as links to their lists; notes the files that it links to."""

    def place(match):
        before, target, after = match.groups()
        file = (page.parent / target).resolve()
        if "://" in target or not file.is_relative_to(ROOT):
            return match.group()
        if file.is_dir():
            inside = file / "README.md"
            found.add(inside if inside.exists() else file)
            return f"{before}{target.rstrip('/')}/README.md{after}"
        found.add(file)
        return match.group()

    return LINK.sub(place, text)


def main():
    shutil.rmtree(PAGES, ignore_errors=True)
    waiting, done = {*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")}, set()
    while waiting:
        file = waiting.pop()
        done.add(file)
        target, found = PAGES / file.relative_to(ROOT), set()
        if file.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            names = sorted(path.name for path in file.iterdir() if path.is_file())
            lines = "\n".join(f"- [{name}]({name})" for name in names)
            (target / "README.md").write_text(f"# {file.name}\n\n{lines}\n")
            found.update(file / name for name in names)
        elif file.suffix == ".md" and file.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(linked(file, file.read_text(), found))
        elif file.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, target)
        waiting |= found - done
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", ROOT / "docs/site/mkdocs.yml"]
    # The notice of the theme about its successor is no finding.
    sys.exit(subprocess.run(words, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}).returncode)


main()
