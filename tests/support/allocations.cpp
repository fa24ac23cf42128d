// Counts the calls of the allocator. glibc lets a program put its own malloc in the place of the library's, whose functions stay
// reachable under other names; operator new of the standard library calls malloc. The address sanitizer has its own allocator
// there and calls a hook instead.

#include "tests/support/allocations.h"

#include "tests/support/sanitizer.h"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace {

thread_local long calls = 0;

}  // namespace

namespace springtower {

long allocationsOfThisThread() {
  return calls;
}

}  // namespace springtower

#if defined(SPRINGTOWER_ADDRESS_SANITIZER)

extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*onMalloc)(const volatile void*, size_t),
                                                         void (*onFree)(const volatile void*));

namespace {

const int installed =
    __sanitizer_install_malloc_and_free_hooks([](const volatile void*, size_t) { ++calls; }, [](const volatile void*) {});

}  // namespace

#else

extern "C" {

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  ++calls;
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
  ++calls;
  return __libc_calloc(count, size);
}

void* realloc(void* memory, size_t size) {
  ++calls;
  return __libc_realloc(memory, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
  ++calls;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size) {
  ++calls;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

#endif
