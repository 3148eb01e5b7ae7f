"""A program whose runs take half a second: notes their begin and end in $NOTES, and whether their record was there already."""
import os
import pathlib
import subprocess
import sys
import time

FOLDER = pathlib.Path.cwd()  # OUT/work/KEY-ATTEMPT
KEY = FOLDER.name.split("-")[0]


def note(word):
    """Adds a line by one call, so that lines of several processes do not mix."""
    with open(os.environ["NOTES"], "ab", buffering=0) as file:
        file.write(f"{word} {KEY} {os.getppid()}\n".encode())


if (FOLDER.parents[1] / "runs" / f"{KEY}.json").exists():
    note("needless")
note("began")
time.sleep(0.5)
code = subprocess.run([sys.executable, "model.py", *sys.argv[1:]]).returncode
note("ended")
sys.exit(code)
