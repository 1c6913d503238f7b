#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the compiler says about a user's mistakes: check.sh COMPILER FOLDER [FLAG...]
#
# A case is a file FOLDER/*.cpp. Compiled with -DMISTAKE it must fail, and each of its lines `// expect: <text>` must occur
# among the first ten lines of the errors. Compiled without, it must pass: the mistake alone is what the compiler refuses.
# `// flags: <flag>...` are those of the mistake, `// compiler: <name>` the one compiler that knows them. "In file included from" lines are not counted.
set -uo pipefail
export LC_ALL=C  # the texts are those of compilers that speak English
compiler=$1
cases=$(realpath "$2")
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Declarations alone, as with the compiled library: the templates that say the sentences are the same, and it takes half.
flags=(-std=c++20 -Werror -DVERNIER_COMPILED "$@")

# What the cases include, parsed once for all of them.
headers=$work/headers.hpp
grep -L '^// flags: ' "$cases"/*.cpp | xargs -r sed -n '/^#include </p' | sort -u > "$headers"
if [[ $("$compiler" --version) == *clang* ]]; then
  "$compiler" "${flags[@]}" -fpch-instantiate-templates -x c++-header "$headers" -o "$headers.pch" || exit 1
  parsed=(-include-pch "$headers.pch")
else
  "$compiler" "${flags[@]}" -x c++-header "$headers" -o "$headers.gch" || exit 1
  parsed=(-include "$headers")
fi

failures=0
complain() {
  printf '%s: %s\n' "$name" "$1"
  sed 's/^/    /' "$work/all" | head -n 25
  failures=$((failures + 1))
}

# Without their mistakes, all cases of these headers compile together, each in a namespace; if not, each says so itself.
sound=$work/sound.cpp
grep -L '^// flags: ' "$cases"/*.cpp | awk '{printf "namespace case_%d {\n#include \"%s\"\n}\n", NR, $0}' > "$sound"
together=no
"$compiler" "${flags[@]}" "${parsed[@]}" -fsyntax-only "$sound" > "$work/all" 2>&1 && together=yes

for file in "$cases"/*.cpp; do
  name=$(basename "$file")
  mapfile -t expected < <(sed -n 's|^// expect: ||p' "$file")
  own=$(sed -n 's|^// flags: ||p' "$file")
  only=$(sed -n 's|^// compiler: ||p' "$file")
  [[ $(basename "$compiler") == "$only"* ]] || continue
  if [[ ${#expected[@]} == 0 ]]; then
    : > "$work/all"
    complain "has no line '// expect: <text>'"
    continue
  fi

  if [[ $together == no || -n $own ]] &&
    ! "$compiler" "${flags[@]}" "${parsed[@]}" -fsyntax-only "$file" > "$work/all" 2>&1; then
    complain "must compile without the mistake"
    continue
  fi

  if [[ -n $own ]]; then  # other flags than those of the precompiled header
    read -ra mistake <<< "$own"
  else
    mistake=("${parsed[@]}")
  fi
  if "$compiler" "${flags[@]}" "${mistake[@]}" -DMISTAKE -fsyntax-only "$file" > "$work/all" 2>&1; then
    complain "must not compile with the mistake"
    continue
  fi
  grep -Ev '^(In file included from| +from )' "$work/all" | head -n 10 > "$work/first"
  for text in "${expected[@]}"; do
    line=$(grep -nF -m 1 -- "$text" "$work/first" | cut -d: -f1)
    if [[ -n $line ]]; then
      printf '%s: line %s of %s: %s\n' "$name" "$line" "$(wc -l < "$work/all")" "$text"
    else
      complain "the first ten lines of the errors do not say '$text'"
    fi
  done
done
((failures == 0))
