#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

// The Eigen of FastCloth's files, and of files that include them, has a memory layout of its own,
// so it has a name of its own, too: the linker would take one function for both where another file
// has Eigen's defaults, and memory of the one allocator would be freed by the other. Here are
// refused files that are compiled otherwise. They would link, and crash.

#ifndef Eigen
#error \
    "FastCloth needs -DEigen=FastClothEigen in every file that includes it. Remedy: link its \
CMake targets, or add the flags of `pkg-config --cflags fastcloth`"
#endif

#if EIGEN_WORLD_VERSION != 3 || EIGEN_MAJOR_VERSION != 4
#error "FastCloth needs Eigen 3.4. Remedy: put its folder before that of the other one (-I)"
#endif

static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 64 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16 &&
                  EIGEN_MALLOC_ALREADY_ALIGNED == 0,
              "FastCloth needs -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 in "
              "every file that includes it. Remedy: link its CMake targets, or add the flags of "
              "`pkg-config --cflags fastcloth`");

static_assert(std::is_same_v<Eigen::Index, std::ptrdiff_t>,
              "FastCloth needs Eigen's own index type. Remedy: leave "
              "-DEIGEN_DEFAULT_DENSE_INDEX_TYPE out");

#ifdef EIGEN_DEFAULT_TO_ROW_MAJOR
#error "FastCloth's matrices are stored by columns. Remedy: leave -DEIGEN_DEFAULT_TO_ROW_MAJOR out"
#endif

#ifdef _GLIBCXX_DEBUG
#error \
    "FastCloth's containers have no debug mode. Remedy: leave -D_GLIBCXX_DEBUG out; \
-D_GLIBCXX_ASSERTIONS checks indices, too"
#endif
