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
printf '[options]\nanchors = 0\n' > lifted.toml  # so that there is something to learn
physgnn train loads.zarr --config lifted.toml --max-epochs 30 --seed 0 -o lifted
physgnn train loads.zarr --model reduced --seed 0 -o reduced
for model in lifted reduced; do
  physgnn predict "$model" --load load.json -o "$model.vtu" || [ $? -eq 3 ]
  find "$model" -name '*.ckpt' -delete -o -name 'events.*' -delete
done
rm -f "$here/$release.zip"
python3 -m zipfile -c "$here/$release.zip" loads.zarr lifted reduced lifted.vtu reduced.vtu
cd "$here"
rm -rf "$work"
