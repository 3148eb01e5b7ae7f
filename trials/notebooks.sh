#!/usr/bin/env bash
# Executes the notebooks of tools/python/notebooks with the wheel of `just wheel`; they stay in target/wheel/notebooks (minutes).
set -euo pipefail
cd "$(dirname "$0")/.."
python=target/wheel/fresh/bin/python
[ -x "$python" ] || { echo "run \`just wheel\` first" >&2; exit 2; }
"$python" -m pip install --quiet nbclient ipykernel matplotlib
rm -rf target/wheel/notebooks && mkdir target/wheel/notebooks
for notebook in cotton your-material; do
    "$python" tools/python/tests/run_notebook.py tools/python/notebooks/$notebook.ipynb target/wheel/notebooks
done
