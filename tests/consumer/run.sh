#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Uses Vernier as users do: in their tree, through FetchContent and installed; bare, with io, with what runs in parallel,
# and with everything; header-only, with the compiled libraries, and both in one program; from the Debian package, and
# with pkg-config.
# usage: tests/consumer/run.sh [BUILD FOLDER [CONFIGURED BUILD]]
# The package with the compiled libraries comes from a configured build of this tree where one is named, whose libraries
# are brought up to date; else one is made.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
configured=${2:+$(cd "$2" && pwd)}
mkdir -p "${1:-$root/build/consumer}"
build=$(cd "${1:-$root/build/consumer}" && pwd)
rm -rf "${build:?}"/*

fail() {
  printf 'consumer: %s\n' "$*" >&2
  exit 1
}

# quietly LOG COMMAND...: shows the output of what failed, and of nothing else
quietly() {
  local log=$1
  shift
  "$@" >"$log" 2>&1 || {
    cat "$log" >&2
    fail "failed: $*"
  }
}

# Nothing is optimised here, and nothing debugged.
fast=(-DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O0 --param=ggc-min-heapsize=1000000")

# consume PROJECT MODE COMPONENTS [CMAKE ARG...]
consume() {
  local project=$1 mode=$2 components=$3 said
  local folder="$build/$project-$mode-${components//;/-}"
  quietly "$folder.log" cmake -S "$here/$project" -B "$folder" -G Ninja "${fast[@]}" \
    "-DCONSUMER_COMPONENTS=$components" -DCONSUMER_MODE="$mode" "-DCMAKE_PREFIX_PATH=$build/prefix" "${@:4}"
  quietly "$folder.log" cmake --build "$folder"
  [[ ! -e $folder/vernier/examples && ! -e $folder/vernier/tests ]] || fail "$project builds our tests or programs"
  said=$("$folder/consumer") || fail "$folder/consumer computes something else"
  printf '%-14s %-17s %s\n' "$project" "${components:-bare}" "$said"
}

# in_background COMMAND...: two at a time, since most of these projects are one translation unit
running=()
in_background() {
  if [[ ${#running[@]} -ge 2 ]]; then
    wait "${running[0]}"
    running=("${running[@]:1}")
  fi
  "$@" &
  running+=($!)
}

# refuse TEXT CMAKE ARG...: configuring must fail, and say TEXT
refuse() {
  local text=$1
  local folder="$build/refused-${text//[^A-Za-z]/}"
  shift
  if cmake -S "$here/installed" -B "$folder" -G Ninja "-DCMAKE_PREFIX_PATH=$build/prefix" "$@" \
    >"$folder.log" 2>&1; then
    fail "was accepted: $*"
  fi
  tr -s ' \n' ' ' <"$folder.log" | grep -qF -- "$text" || {
    cat "$folder.log" >&2
    fail "was refused without saying '$text': $*"
  }
  rm -rf "$folder"
  printf '%-14s %-17s %s\n' installed refused "$text"
}

# not_aligned: a program whose Eigen types have another alignment than the library's does not link
not_aligned() {
  local folder="$build/aligned"
  quietly "$build/configure.log" cmake -S "$here/installed" -B "$folder" -G Ninja -DCMAKE_CXX_FLAGS=-mavx \
    -DCONSUMER_MODE=compiled "-DCMAKE_PREFIX_PATH=$build/prefix"
  ! cmake --build "$folder" >"$build/aligned.log" 2>&1 || fail "a program with another alignment links"
  grep -q 'undefined reference to .*eigen_align_32' "$build/aligned.log" || {
    cat "$build/aligned.log" >&2
    fail "a program with another alignment fails otherwise than by linking"
  }
  printf '%-14s %-17s %s\n' installed refused "another alignment of Eigen's types"
}

# build_type PROJECT: a project without a build type is told so, in one line, and no other
build_type() {
  local project=$1 folder="$build/build_type-$1" said
  # says TIMES CMAKE ARG...
  says() {
    said=$(env -u CMAKE_BUILD_TYPE cmake --fresh -S "$here/$project" -B "$folder" -G Ninja \
      "-DCMAKE_PREFIX_PATH=$build/bare" $no_ceres $no_json "${no_urdf[@]}" "${no_parallel[@]}" "${@:2}" 2>&1) || {
      printf '%s\n' "$said" >&2
      fail "failed: $project with ${*:2}"
    }
    [[ $(grep -c '^-- vernier: CMAKE_BUILD_TYPE is empty.*-DCMAKE_BUILD_TYPE=Release' <<<"$said") == "$1" ]] || {
      printf '%s\n' "$said" >&2
      fail "$project with '${*:2}' does not say $1 times that the build type is empty"
    }
  }
  says 1
  says 0 -DCMAKE_BUILD_TYPE=Debug
  says 0 -DCMAKE_CXX_FLAGS=-O2
  rm -rf "$folder"
  printf '%-14s %-17s %s\n' "$project" "no build type" "is said"
}

# Where a program does not ask for a library, that library is not looked for.
no_ceres=-DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON
no_json=-DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON
no_urdf=(-DCMAKE_DISABLE_FIND_PACKAGE_tinyxml2=ON -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON)
no_parallel=(-DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON -DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON)

# make FOLDER CMAKE ARG...: the libraries alone
make() {
  quietly "$build/make.log" cmake -S "$root" -B "$1" -G Ninja "${fast[@]}" -DVERNIER_BUILD_TESTS=OFF \
    -DVERNIER_BUILD_EXAMPLES=OFF -DVERNIER_BUILD_BENCHMARKS=OFF "${@:2}"
  quietly "$build/make.log" cmake --build "$1"
}

# install FOLDER PREFIX
install() { quietly "$build/install.log" cmake --install "$1" --prefix "$build/$2"; }

# unpack: the Debian package, as a root of its own. What it says it needs must be what it needs.
unpack() {
  local package field
  package=$(echo "$build"/deb/libvernier-dev_*.deb)
  for field in 'Depends: libeigen3-dev' 'Recommends: nlohmann-json3-dev.*libceres-dev' \
    'Suggests: libsuitesparse-dev, libtbb-dev' "Version: $(cat "$build/version")"; do
    dpkg-deb --field "$package" | grep "^$field" >/dev/null || fail "$(basename "$package"): does not say '$field'"
  done
  dpkg-deb -x "$package" "$build/unpacked"
  printf '%-14s %-17s %s\n' debian unpacked "$(basename "$package")"
}

# compile_with_pc PREFIX: as who has no CMake compiles; header-only a unit, with the library a program
compile_with_pc() {
  local flags libs said
  export PKG_CONFIG_PATH=$1/lib/pkgconfig
  read -r -a flags <<<"$(pkg-config --cflags vernier)"
  quietly "$build/pc.log" g++ -std=c++20 "${flags[@]}" -c "$here/library.cpp" -o "$build/library.o"
  read -r -a flags <<<"$(pkg-config --cflags vernier-compiled)"
  read -r -a libs <<<"$(pkg-config --libs vernier-compiled)"
  quietly "$build/pc.log" g++ -std=c++20 "${flags[@]}" "$here/main.cpp" -o "$build/with_pc" "${libs[@]}"
  [[ $(pkg-config --modversion vernier) == $(cat "$build/version") ]] || fail "vernier.pc has another version"
  said=$("$build/with_pc") || fail "$build/with_pc computes something else"
  printf '%-14s %-17s %s\n' pkg-config bare "$said"
}

# The longest, which needs no package, beside all others.
consume in_tree compiled "" $no_ceres $no_json "${no_urdf[@]}" "${no_parallel[@]}" &
longest=$!

# The headers are installed by a build that knows none of the libraries: the package is the same, but for what is
# compiled.
make "$build/package" -DVERNIER_COMPILED=OFF $no_ceres $no_json "${no_urdf[@]}" "${no_parallel[@]}"
install "$build/package" bare
rm -rf "$build/package"
if [[ -n $configured ]]; then
  targets=(vernier_compiled{,_io,_urdf,_ceres,_cholmod})
  ! grep -q '^build vernier_python:' "$configured/build.ninja" || targets+=(vernier_python)
  quietly "$build/make.log" cmake --build "$configured" --target "${targets[@]}"
else
  configured=$build/package
  make "$configured"
fi
install "$configured" prefix
if command -v dpkg-deb >/dev/null; then
  quietly "$build/deb.log" cpack -G DEB -B "$build/deb" --config "$configured/CPackConfig.cmake"
fi
rm -rf "$build/package"

sed -n 's/^#define VERNIER_VERSION_[A-Z]* *//p' "$root/include/vernier/core/version.hpp" | paste -sd. >"$build/version"
whole=$build/prefix
if [[ -d $build/deb ]]; then
  unpack
  whole=$build/unpacked/usr
fi
if command -v pkg-config >/dev/null; then
  in_background compile_with_pc "$whole"
fi

bare=("-DCMAKE_PREFIX_PATH=$build/bare" $no_ceres $no_json "${no_urdf[@]}" "${no_parallel[@]}")
for project in in_tree fetch_content installed; do
  in_background consume $project header_only "" "${bare[@]}"
done
in_background consume installed header_only io "-DCMAKE_PREFIX_PATH=$build/bare" $no_ceres "${no_urdf[@]}" "${no_parallel[@]}"
in_background consume installed header_only urdf "-DCMAKE_PREFIX_PATH=$build/bare" $no_ceres "${no_parallel[@]}"
in_background consume installed header_only "tbb;mpi" "-DCMAKE_PREFIX_PATH=$build/bare" $no_ceres $no_json "${no_urdf[@]}"
in_background consume installed header_only "io;urdf;ceres;cholmod;tbb;mpi"
in_background consume installed compiled "io;urdf;ceres;cholmod;tbb;mpi" "-DCMAKE_PREFIX_PATH=$whole"
in_background consume installed mixed ""
in_background not_aligned
for project in in_tree fetch_content installed; do
  in_background build_type $project
done
in_background refuse "vernier has no component 'warp'" -DCONSUMER_COMPONENTS=warp
in_background refuse "find_package for module Ceres called with REQUIRED" -DCONSUMER_COMPONENTS=ceres $no_ceres
in_background refuse "find_package for module yaml-cpp called with REQUIRED" -DCONSUMER_COMPONENTS=urdf \
  -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON
in_background refuse "find_package for module TBB called with REQUIRED" -DCONSUMER_COMPONENTS=tbb "${no_parallel[@]}"
in_background refuse "find_package for module MPI called with REQUIRED" -DCONSUMER_COMPONENTS=mpi "${no_parallel[@]}"
for process in "${running[@]}" "$longest"; do
  wait "$process"
done
