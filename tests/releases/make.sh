#!/usr/bin/env bash
# Makes files as a release writes them, for test_earlier_releases.py:
#     tests/releases/make.sh 0.2      # with that release's physgnn on the PATH
# case.vtu, loads.toml and load.json are the same for all.
set -euo pipefail
cd "$(dirname "$0")"
release=$1
work=$(mktemp -d)
cp case.vtu loads.toml load.json "$work"
here=$PWD
cd "$work"
physgnn simulate case.vtu --loads loads.toml -o loads.zarr
for model in lifted reduced; do
  physgnn train loads.zarr --model "$model" --max-epochs 2 --seed 0 -o "$model"
  physgnn predict "$model" --load load.json -o "$model.vtu" || [ $? -eq 3 ]
  find "$model" -name '*.ckpt' -delete -o -name 'events.*' -delete
done
rm -f "$here/$release.zip"
python3 -m zipfile -c "$here/$release.zip" loads.zarr lifted reduced lifted.vtu reduced.vtu
cd "$here"
rm -rf "$work"
