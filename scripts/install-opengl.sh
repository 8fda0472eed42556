#!/usr/bin/env bash
# OpenGL for films: Debian and Ubuntu keep it in packages of their own. Without it everything else
# works and the tests of films are skipped, so nothing here may fail.
set -u
python=$1
packages="libegl1 libgl1 libgl1-mesa-dri"
has() { "$python" -c "import ctypes; [ctypes.CDLL(name) for name in '$1'.split()]" 2> /dev/null; }
if [ "$(uname)" != Linux ] || has "libEGL.so.1 libGL.so.1" || has "libOSMesa.so.8"; then
  exit 0
fi
if command -v apt-get > /dev/null && [ "$(id -u)" = 0 ]; then
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086
  { apt-get update -qq && apt-get install -y -qq --no-install-recommends $packages; } > /dev/null ||
    echo "OpenGL could not be installed ($packages): tests of films are skipped." >&2
elif command -v apt-get > /dev/null; then
  echo "Films need OpenGL: sudo apt-get install $packages" >&2
else
  echo "Films need OpenGL (libEGL.so.1 and libGL.so.1), which is missing here." >&2
fi
exit 0
