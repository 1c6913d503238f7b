// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Counts what the calling thread allocates, whether through operator new, malloc or Eigen: allocation_counter.cpp, part
// of every test program, defines the allocation functions.

namespace vernier_test {

/// How often this thread has allocated. (A function elsewhere: compilers take for granted that malloc changes no
/// variable they can see.)
long allocation_count();

/// Number of allocations that this thread makes while `work` runs.
template <class Work>
long allocations(Work&& work) {
  const long before = allocation_count();
  work();
  return allocation_count() - before;
}

/// Keeps a result, so that the work that made it is not optimised away.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

}  // namespace vernier_test
