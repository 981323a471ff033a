#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include "gnn/model/bfloat16.h"

namespace cloth {

/// Gives memory that starts on a cache line, so that no vector load straddles two.
template <typename T>
struct CacheLineAllocator {
    using value_type = T;
    CacheLineAllocator() = default;
    template <typename U>
    CacheLineAllocator(const CacheLineAllocator<U>&) {}
    T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(64)));
    }
    void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(64)); }
    bool operator==(const CacheLineAllocator&) const { return true; }
    bool operator!=(const CacheLineAllocator&) const { return false; }
};

using AlignedBuffer = std::vector<float, CacheLineAllocator<float>>;
using AlignedHalves = std::vector<Bfloat16, CacheLineAllocator<Bfloat16>>;

}  // namespace cloth
