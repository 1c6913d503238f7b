#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Headers meet programs whose other headers define macros: check.sh COMPILER INCLUDE_FOLDER [-x FOLDER]... [FLAG...]
#
# What our headers include of others comes first, then the macros, then all our headers: header-only, and as with the
# compiled library. The folders after -x are left out, since the library that they need is not there.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
compiler=$1
include=$2
shift 2
left_out=()
while [[ ${1:-} == -x ]]; do
  left_out+=(-path "vernier/$2" -prune -o -path "vernier/$2.hpp" -o)
  shift 2
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# ours SUFFIX: the files with this suffix, as they are included
ours() { (cd "$include" && find vernier "${left_out[@]}" -name "*.$1" -print | LC_ALL=C sort); }

{
  ours '[hi]pp' | sed "s|^|$include/|" | xargs sed -n 's/^#include <\([^>]*\)>$/\1/p' | LC_ALL=C sort -u |
    sed 's/.*/#if __has_include(<&>)\n#include <&>\n#endif/'
  printf '#include "%s/macros.hpp"\n' "$here"
  ours hpp | sed 's/.*/#include <&>/'
} > "$work/all.cpp"
grep -q 'vernier/vernier.hpp' "$work/all.cpp" || { printf 'no header found in %s\n' "$include"; exit 1; }

failures=0
for mode in -UVERNIER_COMPILED -DVERNIER_COMPILED; do
  if ! "$compiler" -std=c++20 -w -fsyntax-only "$mode" "-I$include" "$@" "$work/all.cpp" > "$work/said" 2>&1; then
    head -n 40 "$work/said"
    failures=1
  fi
done

# The macros themselves: a name of them in a header is seen.
printf 'const int near = 1;\n' > "$work/used.hpp"
printf '#include "%s/macros.hpp"\n#include "used.hpp"\n' "$here" > "$work/used.cpp"
if "$compiler" -std=c++20 -fsyntax-only "-I$work" "$work/used.cpp" 2> /dev/null; then
  printf 'a header that uses the name of a macro compiles\n'
  failures=1
fi
exit "$failures"
