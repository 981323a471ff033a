#include "tests/fuzz/memory_meter.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>

#include "tests/address_sanitizer.h"

namespace {

std::atomic<long long> held{0}, highest{0};

void add(long long bytes) {
    const long long now = held += bytes;
    long long before = highest;
    while (now > before && !highest.compare_exchange_weak(before, now)) {
    }
}

}  // namespace

#if CLOTH_ADDRESS_SANITIZER

// The sanitizer owns malloc, and tells what it does.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, size_t),
                                              void (*)(const volatile void*));
size_t __sanitizer_get_allocated_size(const volatile void*);
const char* __asan_default_options() {
    return "allocator_may_return_null=1:max_allocation_size_mb=1024";
}
}

static const int hooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, size_t bytes) { add(static_cast<long long>(bytes)); },
    [](const volatile void* memory) {
        if (memory) add(-static_cast<long long>(__sanitizer_get_allocated_size(memory)));
    });

#else

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);
}

namespace {

constexpr size_t refused_above = size_t{1} << 30;

long long size_of(void* memory) {
    return memory ? static_cast<long long>(malloc_usable_size(memory)) : 0;
}

bool is_refused(size_t bytes) {
    if (bytes <= refused_above) return false;
    errno = ENOMEM;
    return true;
}

void* counted(void* memory) {
    add(size_of(memory));
    return memory;
}

}  // namespace

extern "C" {

void* malloc(size_t bytes) {
    return is_refused(bytes) ? nullptr : counted(__libc_malloc(bytes));
}

void* calloc(size_t count, size_t bytes) {
    if (bytes > 0 && is_refused(count > refused_above ? count : count * bytes)) return nullptr;
    return counted(__libc_calloc(count, bytes));
}

void* realloc(void* memory, size_t bytes) {
    if (is_refused(bytes)) return nullptr;
    const long long before = size_of(memory);
    void* moved = __libc_realloc(memory, bytes);
    if (moved || bytes == 0) add(size_of(moved) - before);
    return moved;
}

void* memalign(size_t alignment, size_t bytes) {
    return is_refused(bytes) ? nullptr : counted(__libc_memalign(alignment, bytes));
}

void* aligned_alloc(size_t alignment, size_t bytes) {
    return memalign(alignment, bytes);
}

int posix_memalign(void** memory, size_t alignment, size_t bytes) {
    *memory = memalign(alignment, bytes);
    return *memory ? 0 : ENOMEM;
}

void free(void* memory) {
    add(-size_of(memory));
    __libc_free(memory);
}

}  // extern "C"

#endif

namespace cloth::test {

MemoryMeter::MemoryMeter() : m_start(held) {
    highest = m_start;
}

std::size_t MemoryMeter::peak() const {
    return static_cast<std::size_t>(highest - m_start);
}

}  // namespace cloth::test
