#!/usr/bin/env bash
# Make a virtual environment with the first suitable Python of those named, by default the newest.
set -euo pipefail
folder=$1
shift
[ $# -gt 0 ] || set -- python3.13 python3.12 python3.11 python3 python
for name in "$@"; do
  if command -v "$name" > /dev/null &&
    "$name" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2> /dev/null; then
    python=$name
    break
  fi
done
if [ -z "${python:-}" ]; then
  echo "osculate needs Python 3.11, 3.12 or 3.13; none was found on this machine (tried $*)." >&2
  exit 1
fi
if ! "$python" -m venv "$folder" > /dev/null 2>&1; then
  # Debian and Ubuntu keep venv in a package of its own
  rm -rf "$folder"
  version=$("$python" -c 'import sys; print(f"{sys.version_info[0]}.{sys.version_info[1]}")')
  if command -v apt-get > /dev/null && [ "$(id -u)" = 0 ]; then
    apt-get update -qq && apt-get install -y -qq "python$version-venv" > /dev/null
  elif command -v apt-get > /dev/null; then
    echo "Install venv first: sudo apt-get install python$version-venv" >&2
    exit 1
  fi
  "$python" -m venv "$folder"
fi
